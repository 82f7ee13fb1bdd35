"""Many targets of a problem as the inner loops take them."""

import numpy as np

from solver.approach.task.frame import approach_frames
from solver.approach.task.packed import pack
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.problem.problem import Problem
from solver.robots.model import Array
from solver.robots.rigid import inverse


def packed_problem(problem: Problem) -> Array:
    """A problem's own targets seen from its start posture, shape (sides, n, NUMBERS)."""
    positions = np.array([target.position_m for target in problem.targets], dtype=np.float64)
    directions = np.array([target.branch_direction for target in problem.targets], dtype=np.float64)
    return packed_targets(problem, positions, directions, np.asarray(problem.start))


def packed_targets(
    problem: Problem, positions: Array, directions: Array, references: Array
) -> Array:
    """Targets for the inner loops by tool side and target, shape (sides, n, NUMBERS)."""
    options, robot = problem.options, problem.robot
    geometry = wrist_geometry(robot, problem.mounted_tool)
    limits = robot.limits_within(options.limit_margin_rad)
    branch, outward, sideways = approach_frames(positions, directions)
    mount = inverse(robot.mount)
    turn = mount[:3, :3].T
    placed = positions @ turn + mount[:3, 3]
    sides = (1, -1) if options.symmetric_tool else (1,)
    return np.stack(
        [
            pack(
                geometry,
                limits,
                (placed, side * branch @ turn, outward @ turn, sideways @ turn),
                references,
                np.asarray(problem.joint_weights),
                options.squared,
            )
            for side in sides
        ]
    )
