"""Seeded targets where certificates are hard: edges of limits and reach, straight wrists."""

from collections.abc import Callable

import numpy as np

from solver import Robot, Target
from solver.kinematics.forward import forward_kinematics
from solver.robots.model import Array
from tests.solver.problems import random_targets


def _reached_by(robot: Robot, postures: Array) -> list[Target]:
    """Targets that postures of shape (n, 6) thin, each with the tool's y axis along its branch."""
    poses = forward_kinematics(robot, robot.tools[0], postures)
    return [Target(str(k), tuple(pose[:3, 3]), tuple(pose[:3, 1])) for k, pose in enumerate(poses)]


def _postures(robot: Robot, seed: int, count: int) -> tuple[Array, np.random.Generator]:
    rng = np.random.default_rng(seed)
    return rng.uniform(robot.lower, robot.upper, (count, 6)), rng


def near_limits(robot: Robot, count: int) -> list[Target]:
    """One joint of the posture within 0.3 degrees of a limit, on either side of it."""
    q, rng = _postures(robot, 61, count)
    joints, ends = rng.integers(0, 6, count), rng.integers(0, 2, count)
    limits = np.stack((robot.lower, robot.upper))[ends, joints]
    q[np.arange(count), joints] = limits + rng.uniform(-0.005, 0.005, count)
    return _reached_by(robot, q)


def near_straight_wrists(robot: Robot, count: int) -> list[Target]:
    """The wrist off straight by 1e-2 down to 1e-8 rad."""
    q, rng = _postures(robot, 62, count)
    q[:, 4] = 10.0 ** rng.uniform(-8, -2, count) * rng.choice((-1, 1), count)
    return _reached_by(robot, q)


def straight_wrists(robot: Robot, count: int) -> list[Target]:
    """The wrist straight, to rounding."""
    q, _ = _postures(robot, 62, count)
    q[:, 4] = 0.0
    return _reached_by(robot, q)


def near_the_edge_of_reach(robot: Robot, count: int) -> list[Target]:
    """The elbow all but stretched."""
    q, rng = _postures(robot, 63, count)
    q[:, 2] = 10.0 ** rng.uniform(-8, -1, count) * rng.choice((-1, 1), count)
    return _reached_by(robot, q)


def over_the_waist(robot: Robot, count: int) -> list[Target]:
    """Where the wrist centre may cross the waist axis."""
    rng = np.random.default_rng(64)
    positions = rng.normal((0.0, 0.0, 0.45), 0.02, (count, 3))
    directions = rng.normal(size=(count, 3))
    return [
        Target(str(k), tuple(position), tuple(direction))
        for k, (position, direction) in enumerate(zip(positions, directions, strict=True))
    ]


SETS: dict[str, Callable[[Robot, int], list[Target]]] = {
    "box": lambda _, count: random_targets(65, count),
    "limits": near_limits,
    "all but straight wrists": near_straight_wrists,
    "edge of reach": near_the_edge_of_reach,
    "over the waist": over_the_waist,
}
