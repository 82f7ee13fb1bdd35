"""A batch for the kernels: every target's feasible arcs, and postures at angles on them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.approach.feasibility import CutInTask, posture, tool_axes, trace
from solver.compiled import kernel
from solver.robots.model import Array

Indices = NDArray[np.int64]


class Batch(NamedTuple):
    """Targets with their arcs, sorted by target; arcs of one target lie side by side.

    Attributes:
        task: what the targets share: arm, limits, retreats, start posture, weights, norm. Its
            position and axes are nobody's.
        frames: position, y axis, outward and sideways of one target with the tool on one side,
            shape (frames, 12) [m and unit vectors].
        arc_frames: row of `frames` that each arc belongs to, shape (arcs,).
        arc_branches: inverse kinematics branch of each arc, shape (arcs,).
        arc_lower: lower angle of each arc, shape (arcs,) [rad].
        arc_upper: upper angle of each arc, shape (arcs,) [rad].
        first_arc: target k has the arcs first_arc[k] up to first_arc[k + 1], shape (targets + 1,).
        scale: what joint travel is multiplied with before it is summed (l1) or squared and
            summed (l2), shape (6,): the weights, or their roots.
        turning: some joint may turn by a whole turn or more.
    """

    task: CutInTask
    frames: Array
    arc_frames: Indices
    arc_branches: Indices
    arc_lower: Array
    arc_upper: Array
    first_arc: Indices
    scale: Array
    turning: bool


@kernel
def with_frame(task, frame):
    """The task of one row of frames."""
    return CutInTask(
        task.geometry,
        task.lower,
        task.upper,
        frame[0:3],
        frame[3:6],
        frame[6:9],
        frame[9:12],
        task.retreats,
        task.reference,
        task.weights,
        task.squared,
    )


@kernel
def one_approach(batch, arc, angle, rows, thinning_out, standby_out):
    """Scaled thinning and standby posture at an angle of an arc, each shape (6,).

    A joint of a turn or more takes at thinning the turn nearest to the start posture, and runs on
    from there without a jump. Otherwise a joint has one place inside its limits, and both postures
    follow from their ends alone. `rows` is scratch, shape (len(retreats), 6).
    """
    task = with_frame(batch.task, batch.frames[batch.arc_frames[arc]])
    branch = batch.arc_branches[arc]
    if batch.turning:
        trace(task, angle, branch, task.retreats, rows)
    else:
        axes = np.empty((3, 3))
        tool_axes(task, angle, axes)
        posture(task, axes, 0.0, branch, rows[-1])
        posture(task, axes, task.retreats[0], branch, rows[0])
    for i in range(6):
        thinning_out[i] = batch.scale[i] * rows[-1, i]
        standby_out[i] = batch.scale[i] * rows[0, i]


@kernel
def arc_postures(batch, arcs, angles, thinning_out, standby_out):
    """Scaled postures at angles of arcs, shape (6, len(angles)) each: joints are rows."""
    rows = np.empty((len(batch.task.retreats), 6))
    at_target, behind = np.empty(6), np.empty(6)
    for n in range(len(angles)):
        one_approach(batch, arcs[n], angles[n], rows, at_target, behind)
        for i in range(6):
            thinning_out[i, n] = at_target[i]
            standby_out[i, n] = behind[i]
