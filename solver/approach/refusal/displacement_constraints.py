"""Kernels: what a displaced target has to meet, as lengths with their gradients.

The joint limits and the reach at some rows of the cut-in, and how fast joints turn in some. Joint
constraints are multiplied by half the arm's length, so that all are lengths [m].
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.approach.refusal.tolerances import (
    NEAREST_DIFFERENCE,
    NEAREST_INSIDE_RAD,
    NEAREST_RATE_ROOM,
    NEAREST_STEEPEST,
)
from solver.approach.task.constraints import LIMITS, REACH
from solver.approach.task.feasibility import CutInTask, nearest_turns, posture, tool_axes
from solver.approach.uncertainty.sensitivity import turned_rates
from solver.compiled import NONE_YET, kernel
from solver.kinematics.arctangent import atan2
from solver.kinematics.spherical_wrist import arm_turns, elbow_turns, wrap, wrist_turns
from solver.kinematics.straight_rates import between_rate_room, posture_rate_room
from solver.robots.model import Array
from solver.tolerances import JOINT_RATE_RAD_M, LEAST_DIVISOR


class Watched(NamedTuple):
    """What a displacement has to meet.

    Attributes:
        rows: rows of the cut-in whose limits count, the first `rows_count`, thinning first.
        jumps: rows in which the joints' rates count, the first `jumps_count`.
        spread: displacement that every limit has to bear [m].
        inside: how far inside the reach the wrist centre has to be [m].
        bent: how far from straight the wrist has to be [rad]; 0 where it may be straight.
    """

    rows: NDArray[np.int64]
    rows_count: int
    jumps: NDArray[np.int64]
    jumps_count: int
    spread: float
    inside: float
    bent: float


class Scratch(NamedTuple):
    """Arrays that the inner loops write to and forget."""

    axes: Array
    near: Array
    q: Array
    next_q: Array
    rates: Array
    reach_rates: Array


@kernel
def scratch_arrays():
    """New scratch."""
    return Scratch(
        np.empty((3, 3)),
        np.empty(6),
        np.empty(6),
        np.empty(6),
        np.empty((6, 4)),
        np.empty(4),
    )


@kernel
def copy_at(task, position):
    """The same task with its target at a position of its own, which may be written."""
    return CutInTask(
        task.geometry,
        task.lower,
        task.upper,
        position,
        task.y_axis,
        task.outward,
        task.sideways,
        task.retreats,
        task.reference,
        task.weights,
        task.squared,
    )


@kernel
def calm_reach(g):
    """How far inside the reach the elbow is nowhere too fast, whichever way the tool goes [m].

    A stretched elbow turns by up to (1 / a2 + 1 / l3) / sin g for each metre, and the reach is
    sin^2 g / (1 / a2 + 1 / l3) / 2 further out.
    """
    return (1.0 / abs(g.a2) + 1.0 / g.l3) / JOINT_RATE_RAD_M**2 / 2.0


@kernel
def posture_with_rates(task, axes, retreat, turn, branch, q, rates, reach_rates):
    """`posture` and its `joint_rates` from one closed form; returns the reach margin [m]."""
    g, p = task.geometry, task.position
    x_axis, y_axis = (axes[0, 0], axes[1, 0], axes[2, 0]), (axes[0, 1], axes[1, 1], axes[2, 1])
    z_axis = (axes[0, 2], axes[1, 2], axes[2, 2])
    lever = retreat + g.tool_length
    cos1, sin1, r, s, cos_g, sin_g, inverse2, reach, beside = arm_turns(
        g, p[0] - lever * z_axis[0], p[1] - lever * z_axis[1], p[2] - lever * z_axis[2], branch // 4
    )
    if branch // 2 % 2 == 1:
        sin_g = -sin_g
    cos2, sin2, cos3, sin3, cos23, sin23 = elbow_turns(g, r, s, cos_g, sin_g, inverse2)
    r13, r23, cos5, r31, r32 = wrist_turns(g, cos1, sin1, cos23, sin23, x_axis, y_axis, z_axis)
    sign = 1.0 - 2.0 * (branch % 2)
    sin5 = math.sqrt(r13 * r13 + r23 * r23)
    over = g.sign5 * sign / max(sin5, LEAST_DIVISOR)
    cos4, sin4 = over * r13, over * r23
    q[0], q[1], q[2] = atan2(sin1, cos1), atan2(sin2, cos2), atan2(sin3, cos3)
    q[3], q[4] = atan2(sin4, cos4), atan2(sign * sin5, cos5)
    q[5] = atan2(-sign * g.sign4 * r32, sign * g.sign4 * r31)
    for i in range(6):
        q[i] = g.middles[i] + wrap(q[i] - g.offsets[i] - g.middles[i])
    turned_rates(
        g, (cos1, sin1), (cos2, sin2), (cos23, sin23), (cos4, sin4), sin5,
        axes, lever, turn, rates, reach_rates,
    )  # fmt: skip
    return min(reach, beside)


@kernel
def row_constraints(task, turn, retreat, branch, watched, scratch, values, gradients):
    """One row's constraints as distances [m], >= 0 where met, and their gradients.

    Args:
        task: the task, its target where it is displaced to.
        turn: the branch direction, about which the approach angle turns.
        retreat: distance of the row behind the target [m].
        branch: inverse kinematics branch.
        watched: how far inside the limits it has to be. Where a spread is asked for the straight
            wrist is a limit too.
        scratch: holds the tool's axes, and as `near` the posture on whose turns the row is,
            which that at the target writes.
        values: written, shape (13,); the joints of a row out of reach are those at its edge.
        gradients: written, shape (13, 4): by displacement [m/m] and approach angle [m/rad].
    """
    q, near, rates, reach_rates = scratch.q, scratch.near, scratch.rates, scratch.reach_rates
    spread = watched.spread
    reach = posture_with_rates(task, scratch.axes, retreat, turn, branch, q, rates, reach_rates)
    scale = (task.geometry.a2 + task.geometry.l3) / 2
    if retreat == 0.0:
        nearest_turns(task, q)
        near[:] = q
    steepest = NEAREST_STEEPEST if reach < 0 else math.inf
    for i in range(6):
        q[i] = near[i] + wrap(q[i] - near[i])
        slope, flat = 0.0, scale
        if reach < 0 or spread > 0:
            slope = math.sqrt(rates[i, 0] ** 2 + rates[i, 1] ** 2 + rates[i, 2] ** 2)
            flat = scale * min(1.0, steepest / max(slope * scale, LEAST_DIVISOR))
        low, high = task.lower[i], task.upper[i]
        if i == 4 and (spread > 0 or watched.bent > 0):
            offset = task.geometry.offsets[4]
            below = math.pi * math.floor((q[4] + offset) / math.pi) - offset
            low = max(low, below + watched.bent)
            high = min(high, below + math.pi - watched.bent)
        values[2 * i] = scale * (q[i] - low - NEAREST_INSIDE_RAD - spread * slope)
        values[2 * i + 1] = scale * (high - q[i] - NEAREST_INSIDE_RAD - spread * slope)
        for k in range(4):
            gradients[2 * i, k] = flat * rates[i, k]
            gradients[2 * i + 1, k] = -flat * rates[i, k]
    values[2 * REACH] = reach - watched.inside - spread
    for k in range(4):
        gradients[2 * REACH, k] = reach_rates[k]


@kernel
def rate_constraint(task, origin, x, row, branch, scratch, gradient):
    """What joints are short of the highest rate in one row, as a length, at x = (delta, angle).

    Writes the gradient, shape (4,), from differences; returns the length [m].
    """
    scale = (task.geometry.a2 + task.geometry.l3) / 2
    room = rate_room_at(task, origin, x, NONE_YET, 0.0, row, branch, scratch)
    for k in range(4):
        ahead = rate_room_at(task, origin, x, k, NEAREST_DIFFERENCE, row, branch, scratch)
        gradient[k] = scale * (ahead - room) / NEAREST_DIFFERENCE
    return scale * (room - NEAREST_RATE_ROOM)


@kernel
def rate_room_at(task, origin, x, k, step, row, branch, scratch):
    """What joints are short of the highest rate in a row, and on to the next one.

    With one of x moved by a step; the task's target is there then. Where the row is out of reach,
    less by as much as that is of the arm.
    """
    for i in range(3):
        task.position[i] = origin[i] + x[i] + (step if i == k else 0.0)
    tool_axes(task, x[3] + (step if k == 3 else 0.0), scratch.axes)
    reach = posture(task, scratch.axes, task.retreats[row], branch, scratch.next_q)
    room = posture_rate_room(task.geometry, scratch.next_q)
    if row + 1 < len(task.retreats):
        posture(task, scratch.axes, task.retreats[row + 1], branch, scratch.q)
        spacing = task.retreats[row] - task.retreats[row + 1]
        swing = between_rate_room(task.geometry, scratch.next_q, scratch.q, spacing)
        room = min(room, min(swing, posture_rate_room(task.geometry, scratch.q)))
    return room + min(reach, 0.0) / (task.geometry.a2 + task.geometry.l3)


@kernel
def constraints(task, origin, x, turn, branch, watched, scratch, values, gradients):
    """All watched constraints at x = (delta, angle); moves the task's target there."""
    for i in range(3):
        task.position[i] = origin[i] + x[i]
    tool_axes(task, x[3], scratch.axes)
    count = watched.rows_count
    for w in range(count):
        row_constraints(
            task,
            turn,
            task.retreats[watched.rows[w]],
            branch,
            watched,
            scratch,
            values[LIMITS * w : LIMITS * (w + 1)],
            gradients[LIMITS * w : LIMITS * (w + 1)],
        )
    for w in range(watched.jumps_count):
        j, row = LIMITS * count + w, watched.jumps[w]
        values[j] = rate_constraint(task, origin, x, row, branch, scratch, gradients[j])
