"""Arms with a spherical wrist: `solver.kinematics.spherical_wrist` has their closed form."""

from functools import lru_cache
from typing import Final

from solver.exceptions import UnsupportedKinematics
from solver.kinematics.families.family import Family
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.robots.model import Robot, Tool


@lru_cache(maxsize=64)
def has_spherical_wrist(robot: Robot, tool: Tool) -> bool:
    """Whether the arm itself, without a rail, has the closed form."""
    return why_not(robot, tool) is None


def why_not(robot: Robot, tool: Tool) -> str | None:
    """What keeps an arm from having the closed form; None where nothing does."""
    try:
        wrist_geometry(robot, tool)
    except UnsupportedKinematics as error:
        return str(error)
    return None


SPHERICAL_WRIST: Final = Family(
    "spherical_wrist", "closed form: every method", has_spherical_wrist, has_closed_form=True
)
