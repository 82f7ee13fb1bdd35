"""The closed form's optimum for many targets at once."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.approach.batch_search import NO_BRANCH, optimise
from solver.approach.frame import approach_frames
from solver.approach.packed import jump_cosines, pack
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.problem import Problem
from solver.robots.model import Array
from solver.robots.rigid import inverse

__all__ = ["NO_BRANCH", "Optima", "closed_form_optima"]


@dataclass(frozen=True)
class Optima:
    """The approach of least effort for n targets; rows of targets without one are not a number.

    Attributes:
        angles_rad: approach angles, not wrapped, shape (n,) [rad].
        tool_sides: 1 or -1, shape (n,).
        branches: 0 to 7, NO_BRANCH where a target has no feasible arc, shape (n,).
        efforts: shape (n,).
        paths: the cut-ins, standby first, shape (n, rows, 6) [rad].
        refined: cells of the effort that were looked at closely, shape (n,).
    """

    angles_rad: Array
    tool_sides: NDArray[np.int64]
    branches: NDArray[np.int64]
    efforts: Array
    paths: Array
    refined: NDArray[np.int64]


def closed_form_optima(
    problem: Problem, positions: Array, directions: Array, references: Array
) -> Optima:
    """The global optimum over every feasible arc of every branch, for n targets of a problem.

    Args:
        problem: robot, tool and options; its own targets play no part.
        positions: shape (n, 3) [m].
        directions: branch directions of any length, shape (n, 3).
        references: postures from which effort counts, shape (n, 6) or (6,) [rad].
    """
    options, robot = problem.options, problem.robot
    geometry = wrist_geometry(robot, problem.mounted_tool)
    limits = (
        robot.lower + options.limit_margin_rad,
        robot.upper - options.limit_margin_rad,
    )
    branch, outward, sideways = approach_frames(positions, directions)
    mount = inverse(robot.mount)
    turn = mount[:3, :3].T
    placed = positions @ turn + mount[:3, 3]
    sides = (1, -1) if options.symmetric_tool else (1,)
    numbers = np.stack(
        [
            pack(
                geometry,
                limits,
                (placed, side * branch @ turn, outward @ turn, sideways @ turn),
                references,
                np.asarray(problem.joint_weights),
                options.norm == "l2",
            )
            for side in sides
        ]
    )
    retreats = np.linspace(options.standoff_m, 0.0, options.path_points)
    n = len(positions)
    found = (
        np.empty(n),
        np.ones(n, dtype=np.int64),
        np.empty(n, dtype=np.int64),
        np.empty(n),
        np.empty((n, len(retreats), 6)),
        np.empty(n, dtype=np.int64),
    )
    optimise(numbers, retreats, jump_cosines(retreats), *found)
    return Optima(*found)
