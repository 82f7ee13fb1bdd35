"""Every other arm: `solver.kinematics.numerical` has an inverse for any."""

from typing import Final

from solver.kinematics.families.family import Family

GENERAL: Final = Family(
    "general", "no closed form: ncos from a numerical start", lambda robot, tool: True
)
