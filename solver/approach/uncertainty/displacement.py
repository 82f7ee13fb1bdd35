"""Kernels: how far a target may be moved until the posture planned for it is infeasible.

The distance, in the space of the target's displacements at fixed orientation, to the nearest limit:
a nearest-point problem for each limit, solved by successive linearisation (the iteration of
Hasofer, Lind, Rackwitz and Fiessler, known from structural reliability).
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.task.constraints import JOINTS, LIMITS, REACH
from solver.approach.task.feasibility import tool_axes, trace
from solver.approach.uncertainty.sensitivity import joint_rates, shifted
from solver.approach.uncertainty.tolerances import (
    DISPLACEMENT_ROUNDS,
    DISPLACEMENT_STEP_M,
    DISPLACEMENT_STEP_RELATIVE,
    PROBE_HALVINGS,
    SCREENED_DISTANCES,
    STRAIGHT_WRIST_PROBES,
    STRAIGHT_WRIST_SINE,
)
from solver.compiled import kernel
from solver.tolerances import LEAST_DIVISOR

_LOWER_5, _UPPER_5 = 2 * 4, 2 * 4 + 1
"""The limits of joint 5, in whose place a straight wrist may stand."""


@kernel
def limit_distance(g, position, axes, branch, q, kind, limit, delta):
    """Length of the smallest shift of the tool at which a joint, or the reach, meets its limit [m].

    Args:
        g: the arm.
        position: of the tool, shape (3,) [m].
        axes: its orientation, shape (3, 3).
        branch: inverse kinematics branch.
        q: the posture there, shape (6,) [rad].
        kind: index of the joint; REACH for the reach margin.
        limit: the joint's limit [rad]; 0 for the reach.
        delta: where the search starts, a shift inside the reach; written, the shift found, shape
            (3,) [m].
    """
    rates, reach_rates, turn = np.empty((6, 4)), np.empty(4), np.zeros(3)
    at, new = np.empty(6), np.zeros(3)
    shifted(g, position, delta, axes, branch, q, at)
    for _ in range(DISPLACEMENT_ROUNDS):
        reach = joint_rates(g, at, axes, 0.0, turn, rates, reach_rates)
        gradient = reach_rates if kind == REACH else rates[kind]
        missing = limit - (reach if kind == REACH else at[kind])
        square = 0.0
        for i in range(3):
            square += gradient[i] * gradient[i]
            missing += gradient[i] * delta[i]
        change, length = 0.0, 0.0
        for i in range(3):
            new[i] = gradient[i] * missing / square
            change += (new[i] - delta[i]) ** 2
            length += new[i] * new[i]
        while (
            shifted(g, position, new, axes, branch, q, at) < 0.0 and change > DISPLACEMENT_STEP_M**2
        ):
            change, length = change / 4, 0.0
            for i in range(3):
                new[i] = (new[i] + delta[i]) / 2
                length += new[i] * new[i]
        delta[:] = new
        if change <= DISPLACEMENT_STEP_RELATIVE**2 * length:
            break
    return math.sqrt(delta[0] ** 2 + delta[1] ** 2 + delta[2] ** 2)


@kernel
def straight_wrist_distance(g, position, axes, branch, q, delta):
    """Length of the smallest shift of the tool at which the wrist is straight [m].

    Two equations, sin q5 cos q4 = sin q5 sin q4 = 0: q5 itself is a cone with its tip there, which
    no linearisation meets. Arguments as for `limit_distance`; delta starts at zero.
    """
    rates, reach_rates, at = np.empty((6, 4)), np.empty(4), q.copy()
    first, second = np.empty(3), np.empty(3)
    for _ in range(DISPLACEMENT_ROUNDS):
        joint_rates(g, at, axes, 0.0, axes[:, 1], rates, reach_rates)
        turn4, turn5 = at[3] + g.offsets[3], at[4] + g.offsets[4]
        c4, s4, c5, s5 = math.cos(turn4), math.sin(turn4), math.cos(turn5), math.sin(turn5)
        value1, value2 = -s5 * c4, -s5 * s4
        m11, m12, m22 = 0.0, 0.0, 0.0
        for i in range(3):
            first[i] = c5 * c4 * rates[4, i] - s5 * s4 * rates[3, i]
            second[i] = c5 * s4 * rates[4, i] + s5 * c4 * rates[3, i]
            value1 += first[i] * delta[i]
            value2 += second[i] * delta[i]
            m11 += first[i] * first[i]
            m12 += first[i] * second[i]
            m22 += second[i] * second[i]
        determinant = max(m11 * m22 - m12 * m12, LEAST_DIVISOR)
        along = (m22 * value1 - m12 * value2) / determinant
        across = (m11 * value2 - m12 * value1) / determinant
        change, length = 0.0, 0.0
        for i in range(3):
            new = along * first[i] + across * second[i]
            change += (new - delta[i]) ** 2
            length += new * new
            delta[i] = new
        reach = shifted(g, position, delta, axes, branch, q, at)
        near_tip = abs(math.sin(at[4] + g.offsets[4])) < STRAIGHT_WRIST_SINE
        if reach < 0 or near_tip or change <= DISPLACEMENT_STEP_RELATIVE**2 * length:
            break
    return math.sqrt(delta[0] ** 2 + delta[1] ** 2 + delta[2] ** 2)


@kernel
def first_order(g, lower, upper, q, axes, rates, reach_rates, distances):
    """Fills the distances at which each limit is met to first order, shape (LIMITS,) [m].

    `lower` and `upper` are those of `branch_limits`. Negative where a limit is broken.
    """
    reach = joint_rates(g, q, axes, 0.0, axes[:, 1], rates, reach_rates)
    for i in range(6):
        slope = math.sqrt(rates[i, 0] ** 2 + rates[i, 1] ** 2 + rates[i, 2] ** 2)
        distances[2 * i] = (q[i] - lower[i]) / max(slope, LEAST_DIVISOR)
        distances[2 * i + 1] = (upper[i] - q[i]) / max(slope, LEAST_DIVISOR)
    slope = math.sqrt(reach_rates[0] ** 2 + reach_rates[1] ** 2 + reach_rates[2] ** 2)
    distances[2 * REACH] = reach / max(slope, LEAST_DIVISOR)


@kernel
def branch_limits(g, lower, upper, q, low, high):
    """Writes the limits with joint 5 kept between the straight wrists around it, shapes (6,).

    On one branch sin q5 keeps its sign: the tool cannot pass a straight wrist without a jump.
    """
    low[:], high[:] = lower, upper
    turned = q[4] + g.offsets[4]
    below = math.pi * math.floor(turned / math.pi) - g.offsets[4]
    low[4], high[4] = max(low[4], below), min(high[4], below + math.pi)


@kernel
def rows_displacement_margin(g, lower, upper, pose, retreats, branch, rows):
    """How far the target may move until a row of the cut-in meets a limit, orientation kept.

    Args:
        g: the arm.
        lower: lower limits less the margin asked for, shape (6,) [rad].
        upper: upper limits less the margin asked for, shape (6,) [rad].
        pose: tool frame at the target, shape (4, 4).
        retreats: distances behind it, shape (rows,) [m].
        branch: inverse kinematics branch.
        rows: the postures there, shape (rows, 6) [rad].

    Returns:
        The length of the smallest displacement [m], 0 where a limit is met or broken already; the
        row; and the joint that is met there, REACH for the reach.
    """
    axes = np.ascontiguousarray(pose[:3, :3])
    low, high = np.empty(6), np.empty(6)
    rates, reach_rates, distances = np.empty((6, 4)), np.empty(4), np.empty(LIMITS)
    nearest, nearest_row = np.full(LIMITS, np.inf), np.zeros(LIMITS, dtype=np.int64)
    for n in range(len(retreats)):
        branch_limits(g, lower, upper, rows[n], low, high)
        first_order(g, low, high, rows[n], axes, rates, reach_rates, distances)
        for kind in range(LIMITS):
            if distances[kind] < nearest[kind]:
                nearest[kind], nearest_row[kind] = distances[kind], n
    straight = min(nearest[_LOWER_5], nearest[_UPPER_5])
    straight_row = (
        nearest_row[_LOWER_5] if nearest[_LOWER_5] < nearest[_UPPER_5] else nearest_row[_UPPER_5]
    )
    position, delta, best_delta = np.empty(3), np.empty(3), np.zeros(3)
    best, best_row, best_joint = math.inf, 0, 0
    for _ in range(LIMITS):
        kind = int(np.argmin(nearest))
        if nearest[kind] > SCREENED_DISTANCES * best:
            break
        n = nearest_row[kind]
        if nearest[kind] <= 0.0:
            return 0.0, n, kind // 2
        nearest[kind] = math.inf
        behind(pose, retreats[n], position)
        branch_limits(g, lower, upper, rows[n], low, high)
        limit = 0.0
        if kind < 2 * JOINTS:
            limit = high[kind // 2] if kind % 2 else low[kind // 2]
        delta[:] = 0.0
        if (kind == _LOWER_5 and low[4] > lower[4]) or (kind == _UPPER_5 and high[4] < upper[4]):
            length = straight_wrist_distance(g, position, axes, branch, rows[n], delta)
        else:
            length = limit_distance(g, position, axes, branch, rows[n], kind // 2, limit, delta)
        if length < best:
            best, best_row, best_joint = length, n, kind // 2
            best_delta[:] = delta
    if straight < SCREENED_DISTANCES * best:
        best, best_row, best_joint = beside_straight_wrist(
            g,
            lower,
            upper,
            pose,
            retreats,
            branch,
            rows,
            straight_row,
            best,
            best_row,
            best_joint,
            best_delta,
        )
    return other_rows(
        g, lower, upper, pose, retreats, branch, rows, best, best_row, best_joint, best_delta
    )


@kernel
def rows_displacement_margins(g, lower, upper, poses, retreats, branches, paths, margins):
    """Writes the margins of n cut-ins, shape (n,) [m]; see `rows_displacement_margin`."""
    for k in range(len(paths)):
        margins[k], _, _ = rows_displacement_margin(
            g, lower, upper, poses[k], retreats, branches[k], paths[k]
        )


@kernel
def behind(pose, retreat, position):
    """Writes the tool's place at a retreat behind a pose, shape (3,) [m]."""
    for i in range(3):
        position[i] = pose[i, 3] - retreat * pose[i, 2]


@kernel
def other_rows(
    g, lower, upper, pose, retreats, branch, rows, best, best_row, best_joint, best_delta
):
    """The margin, made smaller where another row breaks a limit at the displacement found."""
    axes = np.ascontiguousarray(pose[:3, :3])
    position, delta, at = np.empty(3), np.empty(3), np.empty(6)
    for _ in range(DISPLACEMENT_ROUNDS):
        worst, row, joint = 0.0, -1, 0
        for n in range(len(retreats)):
            behind(pose, retreats[n], position)
            reach = shifted(g, position, best_delta, axes, branch, rows[n], at)
            if reach < worst and not (n == best_row and best_joint == REACH):
                worst, row, joint = reach, n, REACH
            for i in range(6):
                inside = min(at[i] - lower[i], upper[i] - at[i])
                if inside < worst and not (n == best_row and best_joint == i):
                    worst, row, joint = inside, n, i
        if row < 0:
            break
        behind(pose, retreats[row], position)
        reach = shifted(g, position, best_delta, axes, branch, rows[row], at)
        limit = 0.0
        if joint < JOINTS:
            limit = lower[joint] if at[joint] < lower[joint] else upper[joint]
        delta[:] = 0.0
        length = limit_distance(g, position, axes, branch, rows[row], joint, limit, delta)
        if not length < best:
            break
        best, best_row, best_joint = length, row, joint
        best_delta[:] = delta
    return best, best_row, best_joint


@kernel
def beside_straight_wrist(
    g, lower, upper, pose, retreats, branch, rows, n, best, best_row, best_joint, best_delta
):
    """The margin, made smaller by limits of joints 4 and 6 that bend around a straight wrist.

    There the two turn with the direction from the straight wrist, in the plane of the gradients of
    joints 4 and 5. Points of that plane, `best` away, are tried, and what breaks is brought back.
    """
    axes = np.ascontiguousarray(pose[:3, :3])
    rates, reach_rates = np.empty((6, 4)), np.empty(4)
    position, delta, at = np.empty(3), np.empty(3), np.empty(6)
    behind(pose, retreats[n], position)
    joint_rates(g, rows[n], axes, 0.0, axes[:, 1], rates, reach_rates)
    along, across = rates[4, :3].copy(), rates[3, :3].copy()
    along /= max(math.sqrt(np.dot(along, along)), LEAST_DIVISOR)
    across -= np.dot(across, along) * along
    across /= max(math.sqrt(np.dot(across, across)), LEAST_DIVISOR)
    for k in range(STRAIGHT_WRIST_PROBES):
        turn = 2 * math.pi * k / STRAIGHT_WRIST_PROBES
        direction = math.cos(turn) * along + math.sin(turn) * across
        delta[:] = best * direction
        shifted(g, position, delta, axes, branch, rows[n], at)
        for joint in (3, 5):
            if lower[joint] <= at[joint] <= upper[joint]:
                continue
            limit = lower[joint] if at[joint] < lower[joint] else upper[joint]
            inside, outside = 0.0, best
            for _ in range(PROBE_HALVINGS):
                middle = (inside + outside) / 2
                delta[:] = middle * direction
                reach = shifted(g, position, delta, axes, branch, rows[n], at)
                if reach < 0 or not lower[joint] <= at[joint] <= upper[joint]:
                    outside = middle
                else:
                    inside = middle
            delta[:] = inside * direction
            length = limit_distance(g, position, axes, branch, rows[n], joint, limit, delta)
            if length < best:
                best, best_row, best_joint = length, n, joint
                best_delta[:] = delta
    return best, best_row, best_joint


@kernel
def displacement_margin(task, angle, branch, rows):
    """Displacement margin of an approach [m], its row and joint; `rows` is scratch.

    See `rows_displacement_margin`; 0 where the approach is not feasible at all.
    """
    if trace(task, angle, branch, task.retreats, rows) < 0:
        return 0.0, 0, 0
    pose, axes = np.empty((4, 4)), np.empty((3, 3))
    tool_axes(task, angle, axes)
    for i in range(3):
        for j in range(3):
            pose[i, j] = axes[i, j]
        pose[i, 3] = task.position[i]
    return rows_displacement_margin(
        task.geometry, task.lower, task.upper, pose, task.retreats, branch, rows
    )
