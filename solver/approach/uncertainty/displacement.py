"""Kernels: how far a target may be moved until the posture planned for it is infeasible.

The nearest limit of all rows of its cut-in; limits that are far to first order are left out.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.task.constraints import JOINTS, LIMITS, REACH
from solver.approach.task.feasibility import tool_axes, trace
from solver.approach.uncertainty.nearest_limit import (
    LOWER_5,
    UPPER_5,
    behind,
    first_order,
    limit_distance,
    straight_wrist_distance,
    straight_wrists,
)
from solver.approach.uncertainty.sensitivity import joint_rates, shifted
from solver.approach.uncertainty.tolerances import (
    DISPLACEMENT_ROUNDS,
    PROBE_ENDS_RAD,
    PROBE_HALVINGS,
    SCREENED_DISTANCES,
    STRAIGHT_WRIST_PROBES,
)
from solver.compiled import NONE_YET, kernel
from solver.tolerances import LEAST_DIVISOR


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
    rates, reach_rates, distances = np.empty((6, 4)), np.empty(4), np.empty(LIMITS)
    nearest, nearest_row = np.full(LIMITS, np.inf), np.zeros(LIMITS, dtype=np.int64)
    for n in range(len(retreats)):
        first_order(g, lower, upper, rows[n], axes, rates, reach_rates, distances)
        for kind in range(LIMITS):
            if distances[kind] < nearest[kind]:
                nearest[kind], nearest_row[kind] = distances[kind], n
    straight = min(nearest[LOWER_5], nearest[UPPER_5])
    straight_row = (
        nearest_row[LOWER_5] if nearest[LOWER_5] < nearest[UPPER_5] else nearest_row[UPPER_5]
    )
    position, delta, best_delta = np.empty(3), np.empty(3), np.zeros(3)
    best, best_row, best_joint = math.inf, NONE_YET, NONE_YET
    for _ in range(LIMITS):
        kind = int(np.argmin(nearest))
        if nearest[kind] > SCREENED_DISTANCES * best:
            break
        n = nearest_row[kind]
        if nearest[kind] <= 0.0:
            return 0.0, n, kind // 2
        nearest[kind] = math.inf
        behind(pose, retreats[n], position)
        limit = 0.0
        if kind < 2 * JOINTS:
            limit = upper[kind // 2] if kind % 2 else lower[kind // 2]
        delta[:] = 0.0
        below, above = straight_wrists(g, rows[n])
        if (kind == LOWER_5 and below > lower[4]) or (kind == UPPER_5 and above < upper[4]):
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
            # Beyond the straight wrist the search may end where no limit is.
            shifted(g, position, delta, axes, branch, rows[n], at)
            if length < best and abs(at[joint] - limit) <= PROBE_ENDS_RAD:
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
