"""Which inverse an arm has: closed form, closed form on a rail, or none but a numerical one."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from solver.exceptions import UnsupportedKinematics
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.robots.model import PRISMATIC, Robot, Tool
from solver.robots.rigid import link_transform, roll_pitch_yaw


@dataclass(frozen=True)
class Rail:
    """An arm on a slide: the first joint, and the robot that the others make.

    Attributes:
        axis: unit direction in which the first joint slides, in the base frame, three numbers.
        arm: the others, mounted where the slide stands at 0.
    """

    axis: tuple[float, float, float]
    arm: Robot

    def arm_at(self, position_m: float) -> Robot:
        """The arm with the slide at a position [m]."""
        x, y, z = (
            place + position_m * along
            for place, along in zip(self.arm.mount_position_m, self.axis, strict=True)
        )
        return replace(self.arm, mount_position_m=(x, y, z))


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


@lru_cache(maxsize=64)
def has_closed_form(robot: Robot, tool: Tool) -> bool:
    """Whether the arm itself, without a rail, is one of `solver.kinematics.spherical_wrist`."""
    try:
        wrist_geometry(robot, tool)
    except UnsupportedKinematics:
        return False
    return True


def rail_of(robot: Robot, tool: Tool) -> Rail | None:
    """The rail under an arm that has a closed form; None for every other robot."""
    rail = split_rail(robot)
    return rail if rail is not None and has_closed_form(rail.arm, tool) else None


def has_branches(robot: Robot, tool: Tool) -> bool:
    """Whether the robot's postures have branch numbers: with a closed form, on a rail or not."""
    return has_closed_form(robot, tool) or rail_of(robot, tool) is not None
