"""Arms with a spherical wrist on a slide: the closed form wherever the slide stands."""

from dataclasses import replace
from functools import lru_cache
from typing import Final

import numpy as np

from solver.kinematics.families.family import Family, Rail
from solver.kinematics.families.spherical_wrist import has_spherical_wrist
from solver.robots.model import PRISMATIC, Robot, Tool
from solver.robots.rigid import link_transform, roll_pitch_yaw


@lru_cache(maxsize=64)
def split_rail(robot: Robot) -> Rail | None:
    """The rail and the arm on it; None where the first joint does not slide."""
    first, *others = robot.joints
    if first.kind != PRISMATIC or not others:
        return None
    step = link_transform(first.a_m, first.alpha_rad, first.d_m, first.offset_rad)
    pose = robot.mount @ step
    x, y, z = (float(value) for value in pose[:3, 3])
    along_x, along_y, along_z = (float(value) for value in robot.mount[:3, 2])
    arm = replace(
        robot,
        joints=tuple(others),
        home_joints=robot.home_joints[1:],
        mount_position_m=(x, y, z),
        mount_rpy_rad=roll_pitch_yaw(np.asarray(pose[:3, :3])),
    )
    return Rail((along_x, along_y, along_z), arm)


def _takes(robot: Robot, tool: Tool) -> bool:
    rail = split_rail(robot)
    return rail is not None and has_spherical_wrist(rail.arm, tool)


ON_RAIL: Final = Family(
    "spherical_wrist_on_rail",
    "closed form on a rail: every method, the rail by a grid",
    _takes,
    rail=split_rail,
)
