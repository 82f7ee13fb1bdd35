"""How fast joints turn in a cut-in, by means of the verifier's own: no closed form, no branches.

Postures come from Newton's method on the forward kinematics, one from the other, beginning at the
thinning posture; rates from the Jacobian there.
"""

import math
from typing import Final

import numpy as np

from solver.kinematics.families import rail_of
from solver.kinematics.forward import jacobian, many_poses
from solver.kinematics.numerical import postures_behind, rates_behind
from solver.problem.problem import Problem
from solver.robots.model import Array, Robot, Tool
from solver.tolerances import JOINT_RATE_RAD_M
from solver.verification.tolerances import RATE_SCREENED, RATE_SPACING_M, RATE_ZOOMS

SQUARE: Final = 6
"""Joints with which the Jacobian is square."""


def fastest_rates(problem: Problem, paths: Array) -> Array:
    """The largest rate of a joint that turns anywhere on n cut-ins, shape (n,) [rad/m].

    Where joints turn little from row to row, that travel over the distance is returned: no joint is
    too fast there between two rows.

    Args:
        problem: what was asked.
        paths: evenly spaced rows, standby first, shape (n, path_points, joints) [rad or m].
    """
    robot, tool, standoff_m = problem.robot, problem.mounted_tool, problem.options.standoff_m
    rail, close = rail_of(robot, tool), math.ceil(standoff_m / RATE_SPACING_M) + 1
    rates = np.maximum(_travel(robot, paths, standoff_m), _at_ends(problem, paths))
    for k, rate in enumerate(rates.tolist()):
        if paths.shape[1] >= close and rate <= RATE_SCREENED * JOINT_RATE_RAD_M:
            continue
        thinning, arm = paths[k, -1], robot
        if rail is not None:
            thinning, arm = thinning[1:], rail.arm_at(float(thinning[0]))
        rows = postures_behind(arm, tool, thinning, np.linspace(standoff_m, 0.0, close))
        rates[k] = max(rate, _travel(arm, rows[None], standoff_m)[0])
        if rates[k] > RATE_SCREENED * JOINT_RATE_RAD_M:
            rates[k] = max(rate, _fastest(arm, tool, thinning, standoff_m))
    return rates


def _at_ends(problem: Problem, paths: Array) -> Array:
    """The largest rate of a joint that turns at standby and at thinning, shape (n,) [rad/m].

    There a joint may be fast and yet turn little, where the cut-in ends on its way into a swing.
    """
    robot, tool, ends = problem.robot, problem.mounted_tool, paths[:, [0, -1]]
    if len(robot.joints) != SQUARE:
        if (rail := rail_of(robot, tool)) is not None:
            robot, ends = rail.arm, ends[..., 1:]
        return np.array([(rates_behind(robot, tool, two) * robot.turning).max() for two in ends])
    columns = jacobian(robot, tool, ends)
    along = np.zeros((*ends.shape[:2], SQUARE, 1))
    along[..., :3, 0] = many_poses(robot, tool, ends)[..., :3, 2]
    singular = np.linalg.det(columns) == 0.0
    columns[singular] = np.eye(SQUARE)
    rates = np.abs(np.linalg.solve(columns, along)[..., 0]) * robot.turning
    rates[singular] = np.inf
    return np.asarray(rates.max(axis=(1, 2)))


def _travel(robot: Robot, paths: Array, standoff_m: float) -> Array:
    """The largest travel of a joint that turns from row to row over the distance, shape (n,)."""
    steps = np.abs(np.diff(paths[..., robot.turning > 0], axis=1)).max(axis=(1, 2))
    return np.asarray(steps * (paths.shape[1] - 1) / standoff_m)


def _fastest(robot: Robot, tool: Tool, thinning: Array, standoff_m: float) -> float:
    """The largest rate behind a thinning posture, closed in on around the row where it is found."""
    retreats = np.linspace(standoff_m, 0.0, max(2, round(8 * standoff_m / RATE_SPACING_M)))
    fastest = 0.0
    for _ in range(RATE_ZOOMS + 1):
        rows = postures_behind(robot, tool, thinning, retreats)
        rates = np.max(rates_behind(robot, tool, rows) * robot.turning, axis=1)
        k = int(rates.argmax())
        fastest = max(fastest, float(rates[k]))
        before, after = max(k - 1, 0), min(k + 1, len(retreats) - 1)
        thinning = rows[after]
        retreats = np.linspace(retreats[before] - retreats[after], 0.0, len(retreats))
    return fastest
