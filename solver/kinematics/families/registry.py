"""The families, a row each: an arm is of the first that takes it."""

from functools import lru_cache
from typing import Final

from solver.kinematics.families.family import Family
from solver.kinematics.families.general import GENERAL
from solver.kinematics.families.on_rail import ON_RAIL
from solver.kinematics.families.spherical_wrist import SPHERICAL_WRIST, why_not
from solver.robots.model import Robot, Tool

FAMILIES: Final[tuple[Family, ...]] = (SPHERICAL_WRIST, ON_RAIL, GENERAL)


@lru_cache(maxsize=64)
def family_of(robot: Robot, tool: Tool) -> Family:
    """The family of an arm with a tool."""
    return next(family for family in FAMILIES if family.takes(robot, tool))


def why_no_closed_form(robot: Robot, tool: Tool) -> str | None:
    """Why an arm has no closed form, a sentence; None where it has one."""
    family = family_of(robot, tool)
    if family.has_closed_form:
        return None
    return why_not(robot, tool) or f"{robot.name}: {family.summary}"
