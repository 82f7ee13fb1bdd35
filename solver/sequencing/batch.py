"""A batch for the kernels: every target's feasible arcs, and postures at angles on them."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.approach.arcs.turns import (
    TURN_ROWS,
    joints_of_turns,
    path_columns,
    turns_along_path,
    write_turns,
)
from solver.approach.optimum.effort_samples import path_joints
from solver.approach.task.packed import PackedTask
from solver.compiled import kernel
from solver.robots.model import Array

Indices = NDArray[np.int64]


class Batch(NamedTuple):
    """Targets with their arcs, sorted by target; arcs of one target lie side by side.

    Attributes:
        numbers: one target with the tool on one side, packed, shape (frames, NUMBERS).
        retreats: of the cut-in's rows, shape (rows,) [m].
        cos_steps: of a `PackedTask`, shape (rows - 1,).
        arc_frames: row of `numbers` that each arc belongs to, shape (arcs,).
        arc_branches: inverse kinematics branch of each arc, shape (arcs,).
        arc_lower: lower angle of each arc, shape (arcs,) [rad].
        arc_upper: upper angle of each arc, shape (arcs,) [rad].
        first_arc: target k has the arcs first_arc[k] up to first_arc[k + 1], shape (targets + 1,).
        scale: what joint travel is multiplied with before it is summed (l1) or squared and
            summed (l2), shape (6,): the weights, or their roots.
        start: the start posture, scaled, shape (6,).
        squared: the norm is l2.
        turning: some joint may turn by a whole turn or more.
    """

    numbers: Array
    retreats: Array
    cos_steps: Array
    arc_frames: Indices
    arc_branches: Indices
    arc_lower: Array
    arc_upper: Array
    first_arc: Indices
    scale: Array
    start: Array
    squared: bool
    turning: bool


@kernel
def arc_postures(batch, arcs, angles, thinning_out, standby_out):
    """Scaled postures at angles of arcs, shape (6, len(angles)) each: joints are rows.

    A joint of a turn or more takes at thinning the turn nearest to the start posture, and runs on
    from there without a jump. Otherwise a joint has one place inside its limits, and both postures
    follow from their ends alone.
    """
    first = 0
    for n in range(1, len(arcs) + 1):
        if n < len(arcs) and arcs[n] == arcs[first]:
            continue
        own = slice(first, n)
        if batch.turning:
            turning_postures(
                batch, arcs[first], angles[own], thinning_out[:, own], standby_out[:, own]
            )
        else:
            end_postures(batch, arcs[first], angles[own], thinning_out[:, own], standby_out[:, own])
        first = n


@kernel
def end_postures(batch, arc, angles, thinning_out, standby_out):
    """Scaled postures at both ends of the cut-in, at angles of one arc."""
    task = PackedTask(batch.numbers[batch.arc_frames[arc]], batch.retreats, batch.cos_steps)
    branch, count = batch.arc_branches[arc], len(angles)
    turns, joints = np.empty((TURN_ROWS, 2 * count)), np.empty((6, 2 * count))
    for n in range(count):
        cos, sin = math.cos(angles[n]), math.sin(angles[n])
        turns[0, n], turns[1, n], turns[2, n] = cos, sin, 0.0
        turns[0, count + n], turns[1, count + n] = cos, sin
        turns[2, count + n] = batch.retreats[0]
    write_turns(task, 2 * count, branch // 2, turns)
    joints_of_turns(task, turns, 2 * count, branch % 2, joints)
    for i in range(6):
        for n in range(count):
            thinning_out[i, n] = batch.scale[i] * joints[i, n]
            standby_out[i, n] = batch.scale[i] * joints[i, count + n]


@kernel
def turning_postures(batch, arc, angles, thinning_out, standby_out):
    """The same where a joint may turn by a whole turn, which its whole cut-in decides."""
    task = PackedTask(batch.numbers[batch.arc_frames[arc]], batch.retreats, batch.cos_steps)
    branch, rows = batch.arc_branches[arc], len(batch.retreats)
    turns, joints = np.empty((TURN_ROWS, path_columns(rows))), np.empty((6, rows))
    path = np.empty((rows, 6))
    for n in range(len(angles)):
        turns_along_path(task, angles[n], branch // 2, turns)
        path_joints(task, turns, branch % 2, joints, path)
        for i in range(6):
            thinning_out[i, n] = batch.scale[i] * path[-1, i]
            standby_out[i, n] = batch.scale[i] * path[0, i]
