"""How fast joints turn in a cut-in, by means of the verifier's own: no closed form, no branches.

Postures come from Newton's method on the forward kinematics, one from the other, beginning at the
thinning posture; rates from the Jacobian there.
"""

import math

import numpy as np

from solver.kinematics.chain_rates import fastest_on_paths
from solver.kinematics.families.registry import family_of
from solver.kinematics.numerical import chain_of
from solver.problem.problem import Problem
from solver.robots.model import Array
from solver.tolerances import JOINT_RATE_RAD_M
from solver.verification.tolerances import RATE_SCREENED, RATE_SPACING_M


def fastest_rates(problem: Problem, paths: Array) -> Array:
    """The largest rate of a joint that turns anywhere on n cut-ins, shape (n,) [rad/m].

    Where joints turn little from row to row, that travel over the distance is returned: no joint is
    too fast there between two rows.

    Args:
        problem: what was asked.
        paths: evenly spaced rows, standby first, shape (n, path_points, joints) [rad or m].
    """
    robot, standoff_m = problem.robot, problem.options.standoff_m
    family = family_of(robot, problem.mounted_tool)
    if (standing := family.standing(robot, paths[0, -1])) is not None:
        # What the arm stands on stands still, and how fast joints turn does not depend on where.
        robot, paths = standing.arm, paths[..., standing.first :]
    return np.asarray(
        fastest_on_paths(
            chain_of(robot, problem.mounted_tool),
            np.ascontiguousarray(paths),
            standoff_m,
            math.ceil(standoff_m / RATE_SPACING_M) + 1,
            RATE_SCREENED * JOINT_RATE_RAD_M,
        )
    )
