"""The straight line in joint space, whatever stands in its way."""

import numpy as np

from solver.problem.solution import Transfer
from solver.robots.model import Array, Robot

JOINT_LINE = "joint_line"


def joint_line(robot: Robot, start: Array, standby: Array) -> Transfer:
    """The transfer between two postures, shape (joints,) each [rad or m]."""
    length = float(np.linalg.norm((standby - start) * robot.turning))
    return Transfer(JOINT_LINE, np.array([start, standby]), length)
