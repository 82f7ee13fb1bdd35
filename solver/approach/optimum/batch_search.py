"""Kernel: the least effort over all arcs for many targets: one loop, no Python between targets."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.arcs.turns import TURN_ROWS, path_columns, turns_along_path
from solver.approach.cut_in.between_rows import may_leave_between
from solver.approach.optimum.cheapest import cheapest, cheapest_scratch
from solver.approach.optimum.effort_samples import path_joints
from solver.approach.task.packed import LOWER, UPPER, PackedTask
from solver.compiled import kernel

NO_BRANCH = -1


@kernel
def optimise(numbers, retreats, cos_steps, angles, sides, branches, efforts, paths, refined):
    """Writes the optimum of every target; the fields are those of `Optima` in `batch.py`.

    `numbers` are packed rows by tool side and target, shape (sides, n, NUMBERS).
    """
    rows = len(retreats)
    scratch = cheapest_scratch(rows)
    turns, joints = np.empty((TURN_ROWS, path_columns(rows))), np.empty((6, rows))
    for k in range(numbers.shape[1]):
        angle, branch, best, work, chosen = math.nan, NO_BRANCH, math.inf, 0, 0
        for side in range(numbers.shape[0]):
            task = PackedTask(numbers[side, k], retreats, cos_steps)
            where, own, cost, looked = cheapest(task, scratch, best)
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


@kernel
def paths_of_many(numbers, branches, angles, retreats, cos_steps, joints, suspicious):
    """Cut-ins at chosen angles, and whether each may leave its limits between two rows.

    `numbers` are packed rows, shape (n, NUMBERS); the last two are written, shape (n, rows, 6) and
    (n,).
    """
    rows = len(retreats)
    turns, scratch = np.empty((TURN_ROWS, path_columns(rows))), np.empty((6, rows))
    for k in range(len(numbers)):
        task = PackedTask(numbers[k], retreats, cos_steps)
        turns_along_path(task, angles[k], branches[k] // 2, turns)
        path_joints(task, turns, branches[k] % 2, scratch, joints[k])
        lower, upper = numbers[k, LOWER : LOWER + 6], numbers[k, UPPER : UPPER + 6]
        suspicious[k] = may_leave_between(joints[k], lower, upper)
