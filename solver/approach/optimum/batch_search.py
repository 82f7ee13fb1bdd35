"""Kernel: the least effort over all arcs for many targets: one loop, no Python between targets."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple

import numpy as np

from solver.approach.arcs.turns import (
    TURN_ROWS,
    joints_of_turns,
    path_columns,
    row_room,
    turns_along_path,
)
from solver.approach.cut_in.between_rows import may_fall_below_zero_between, may_leave_between
from solver.approach.cut_in.tolerances import BESIDE_ROW_M, NEAR_RATE_ROOM, RATE_ROOM_EXCESS
from solver.approach.optimum.cheapest import cheapest, cheapest_scratch
from solver.approach.optimum.effort_samples import path_joints
from solver.approach.task.constraints import BESIDE, REACH
from solver.approach.task.packed import LOWER, UPPER, PackedTask, unpack_geometry
from solver.compiled import kernel
from solver.kinematics.spherical_wrist import wrap
from solver.robots.model import Array

NO_BRANCH = np.int64(-1)


class PathWork(NamedTuple):
    """Working memory for one cut-in: where it is looked at, and at the rows that are sent."""

    turns: Array
    joints: Array
    rows: Array
    room: Array
    sent_turns: Array
    sent_joints: Array


@kernel
def path_work(rows, sent):
    """Working memory for cut-ins that are looked at in some rows, of which others are sent."""
    return PathWork(
        np.empty((TURN_ROWS, path_columns(rows))), np.empty((6, rows)), np.empty((rows, 6)),
        np.empty(rows), np.empty((TURN_ROWS, path_columns(sent))), np.empty((6, sent)),
    )  # fmt: skip


@kernel
def write_path(task, angle, branch, sent, work, path):
    """Writes a cut-in at the retreats `sent`, shape (len(sent), 6).

    Returns whether it may be infeasible between two rows of the task.
    """
    turns, wrist = work.turns, branch % 2
    turns_along_path(task, angle, branch // 2, turns)
    path_joints(task, turns, wrist, work.joints, work.rows)
    g = unpack_geometry(task.numbers)
    for n in range(len(work.room)):
        work.room[n] = row_room(g, turns, n)
    lower, upper = task.numbers[LOWER : LOWER + 6], task.numbers[UPPER : UPPER + 6]
    # Joints of more than one turn are on the turn that the whole cut-in decides.
    last = len(sent) - 1
    other = PackedTask(task.numbers, sent, task.cos_steps)
    turns_along_path(other, angle, branch // 2, work.sent_turns)
    joints_of_turns(other, work.sent_turns, last + 1, wrist, work.sent_joints)
    for i in range(6):
        path[last, i] = work.rows[-1, i]
        for n in range(last - 1, -1, -1):
            path[n, i] = path[n + 1, i] + wrap(work.sent_joints[i, n] - path[n + 1, i])
    for i in (REACH, BESIDE):
        if may_fall_below_zero_between(turns[6 + i, : len(work.room)]):
            return True
    if may_leave_between(work.rows, lower, upper) or may_fall_below_zero_between(work.room):
        return True
    return dips_beside(task, angle, branch // 2, work.room)


@kernel
def dips_beside(task, angle, arm, room):
    """Whether the room of a rate that a row all but uses up goes on falling beside that row.

    See `solver.approach.cut_in.broken_between_rows`, which looks for the same.
    """
    for n in range(len(room)):
        if room[n] >= NEAR_RATE_ROOM:
            continue
        here, beside = task.retreats[n], np.empty(2)
        beside[0] = min(here + BESIDE_ROW_M, task.retreats[0])
        beside[1] = max(here - BESIDE_ROW_M, 0.0)
        turns = np.empty((TURN_ROWS, path_columns(2)))
        turns_along_path(PackedTask(task.numbers, beside, task.cos_steps), angle, arm, turns)
        g = unpack_geometry(task.numbers)
        if min(row_room(g, turns, 0), row_room(g, turns, 1)) < room[n] - RATE_ROOM_EXCESS:
            return True
    return False


@kernel
def optimise(
    numbers, retreats, cos_steps, sent, angles, sides, branches, efforts, paths, suspicious, refined
):
    """Writes the optimum of every target; the fields are those of `Optima` in `batch.py`.

    `numbers` are packed rows by tool side and target, shape (sides, n, NUMBERS); `sent` are the
    retreats of the paths.
    """
    scratch, work = cheapest_scratch(len(retreats)), path_work(len(retreats), len(sent))
    for k in range(numbers.shape[1]):
        angle, branch, best, cells, chosen = math.nan, NO_BRANCH, math.inf, 0, 0
        for side in range(numbers.shape[0]):
            task = PackedTask(numbers[side, k], retreats, cos_steps)
            where, own, cost, looked = cheapest(task, scratch, best)
            cells += looked
            if cost < best:
                angle, branch, best, chosen = where, own, cost, side
        angles[k], branches[k], efforts[k], refined[k] = angle, branch, best, cells
        sides[k] = 1 - 2 * chosen
        suspicious[k] = False
        if branch == NO_BRANCH:
            paths[k] = math.nan
            continue
        task = PackedTask(numbers[chosen, k], retreats, cos_steps)
        suspicious[k] = write_path(task, angle, branch, sent, work, paths[k])


@kernel
def paths_of_many(numbers, branches, angles, retreats, cos_steps, sent, joints, suspicious):
    """Cut-ins at chosen angles, and whether each may be infeasible between what is looked at.

    `numbers` are packed rows, shape (n, NUMBERS), `sent` the retreats of the cut-ins' rows; the
    last two are written, shape (n, len(sent), 6) and (n,).
    """
    work = path_work(len(retreats), len(sent))
    for k in range(len(numbers)):
        task = PackedTask(numbers[k], retreats, cos_steps)
        suspicious[k] = write_path(task, angles[k], branches[k], sent, work, joints[k])
