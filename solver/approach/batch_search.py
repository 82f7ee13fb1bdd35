"""Kernel: the least effort over all arcs for many targets: one loop, no Python between targets."""

import math

import numpy as np

from solver.approach.arc_search import ARC_COLUMNS, MOST_ARCS, arc_scratch, find_arcs
from solver.approach.packed import PackedTask
from solver.approach.search import effort_scratch, least_effort, path_joints
from solver.approach.turns import TURN_ROWS, turns_along_path
from solver.compiled import kernel

NO_BRANCH = -1


@kernel
def optimise(numbers, retreats, cos_steps, angles, sides, branches, efforts, paths, refined):
    """Writes the optimum of every target; the fields are those of `solver.approach.batch.Optima`.

    `numbers` are packed rows by tool side and target, shape (sides, n, NUMBERS).
    """
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
