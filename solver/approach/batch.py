"""The closed form's optimum for many targets: one compiled loop, no Python between targets."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.approach.arc_search import ARC_COLUMNS, MOST_ARCS, arc_scratch, find_arcs
from solver.approach.frame import approach_frames
from solver.approach.packed import PackedTask, jump_cosines, pack
from solver.approach.search import effort_scratch, least_effort, path_joints
from solver.approach.turns import TURN_ROWS, turns_along_path
from solver.compiled import kernel
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.problem import Problem
from solver.robots.model import Array
from solver.robots.rigid import inverse

NO_BRANCH = -1


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
    _optimise(numbers, retreats, jump_cosines(retreats), *found)
    return Optima(*found)


@kernel
def _optimise(numbers, retreats, cos_steps, angles, sides, branches, efforts, paths, refined):
    rows = len(retreats)
    scratch, samples, cell = arc_scratch(rows), effort_scratch(rows), effort_scratch(rows)
    arcs = np.empty((MOST_ARCS, ARC_COLUMNS))
    turns, joints = np.empty((TURN_ROWS, rows)), np.empty((6, rows))
    for k in range(numbers.shape[1]):
        angle, branch, best, work, chosen = math.nan, NO_BRANCH, math.inf, 0, 0
        for side in range(numbers.shape[0]):
            task = PackedTask(numbers[side, k], retreats, cos_steps)
            for i in range(find_arcs(task, scratch, arcs)):
                own = int(arcs[i, 0])
                where, cost, looked = least_effort(
                    task, samples, cell, own, arcs[i, 1], arcs[i, 2], best
                )
                work += looked
                if cost < best:
                    angle, branch, best, chosen = where, own, cost, side
        angles[k], branches[k], efforts[k], refined[k] = angle, branch, best, work
        sides[k] = 1 - 2 * chosen
        if branch == NO_BRANCH:
            paths[k] = math.nan
            continue
        task = PackedTask(numbers[chosen, k], retreats, cos_steps)
        turns_along_path(task, angle, branch // 2, turns)
        path_joints(task, turns, branch % 2, joints, paths[k])
