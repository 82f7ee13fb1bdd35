"""Kernels: the smallest displacement of a target at which its task becomes feasible.

Minimises |delta|^2 / 2 over the displacement delta and the approach angle phi, on one branch, with
the joint limits and the reach at some rows of the cut-in as constraints: a sequential quadratic
programme with an exact penalty (S l1 QP), BFGS and derivatives in closed form. Joint constraints
are multiplied by half the arm's length, so that all are lengths [m].
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.approach.refusal.penalty_programme import penalty_programme, reset, update
from solver.approach.refusal.tolerances import (
    NEAREST_ANGLE_SCALE_M,
    NEAREST_CONVERGED_M,
    NEAREST_CUT,
    NEAREST_CUTS,
    NEAREST_FLAT_REACH,
    NEAREST_FLATTEST,
    NEAREST_HOPELESS,
    NEAREST_INSIDE_M,
    NEAREST_INSIDE_RAD,
    NEAREST_JUMP_SHARE,
    NEAREST_LARGEST_TURN_RAD,
    NEAREST_PENALTY,
    NEAREST_PENALTY_LEAST_M,
    NEAREST_PRUNED,
    NEAREST_REACH_STEPS,
    NEAREST_RESTORATIONS,
    NEAREST_ROUNDS,
    NEAREST_START_INSIDE_M,
    NEAREST_STARTS,
    NEAREST_STEEPEST,
    NEAREST_STEPS,
    NEAREST_TRIAL_STEPS,
    NEAREST_WIDENING,
)
from solver.approach.task.constraints import LIMITS, REACH
from solver.approach.task.feasibility import CutInTask, limit_margin, posture, tool_axes, trace
from solver.approach.uncertainty.displacement import rows_displacement_margin
from solver.approach.uncertainty.sensitivity import joint_rates
from solver.compiled import kernel
from solver.kinematics.spherical_wrist import wrap
from solver.robots.model import Array
from solver.tolerances import JOINT_RATE_RAD_M, LEAST_DIVISOR


class Watched(NamedTuple):
    """What a displacement has to meet.

    Attributes:
        rows: rows of the cut-in whose limits count, the first `rows_count`, thinning first.
        jumps: row and joint of each jump that counts, between that row and the next one, the first
            `jumps_count`, shape (n, 2).
        spread: displacement that every limit has to bear [m].
    """

    rows: NDArray[np.int64]
    rows_count: int
    jumps: NDArray[np.int64]
    jumps_count: int
    spread: float


class Scratch(NamedTuple):
    """Arrays that the inner loops write to and forget."""

    axes: Array
    near: Array
    q: Array
    next_q: Array
    rates: Array
    next_rates: Array
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
def row_constraints(task, turn, retreat, branch, spread, scratch, values, gradients):
    """One row's constraints as distances [m], >= 0 where met, and their gradients.

    Args:
        task: the task, its target where it is displaced to.
        turn: the branch direction, about which the approach angle turns.
        retreat: distance of the row behind the target [m].
        branch: inverse kinematics branch.
        spread: displacement that every limit has to bear [m]. Where it is above 0 the straight
            wrist is a limit too.
        scratch: holds the tool's axes, and as `near` the posture on whose turns the row is.
        values: written, shape (13,); the joints of a row out of reach are those at its edge.
        gradients: written, shape (13, 4): by displacement [m/m] and approach angle [m/rad].
    """
    q, near, rates, reach_rates = scratch.q, scratch.near, scratch.rates, scratch.reach_rates
    reach = posture(task, scratch.axes, retreat, branch, q)
    lever = retreat + task.geometry.tool_length
    joint_rates(task.geometry, q, scratch.axes, lever, turn, rates, reach_rates)
    scale = (task.geometry.a2 + task.geometry.l3) / 2
    steepest = NEAREST_STEEPEST if reach < 0 else math.inf
    for i in range(6):
        q[i] = near[i] + wrap(q[i] - near[i])
        slope = math.sqrt(rates[i, 0] ** 2 + rates[i, 1] ** 2 + rates[i, 2] ** 2)
        flat = scale * min(1.0, steepest / max(slope * scale, LEAST_DIVISOR))
        low, high = task.lower[i], task.upper[i]
        if i == 4 and spread > 0:
            offset = task.geometry.offsets[4]
            below = math.pi * math.floor((q[4] + offset) / math.pi) - offset
            low, high = max(low, below), min(high, below + math.pi)
        values[2 * i] = scale * (q[i] - low - NEAREST_INSIDE_RAD - spread * slope)
        values[2 * i + 1] = scale * (high - q[i] - NEAREST_INSIDE_RAD - spread * slope)
        for k in range(4):
            gradients[2 * i, k] = flat * rates[i, k]
            gradients[2 * i + 1, k] = -flat * rates[i, k]
    values[2 * REACH] = reach - NEAREST_INSIDE_M - spread
    for k in range(4):
        gradients[2 * REACH, k] = reach_rates[k]


@kernel
def jump_constraint(task, turn, row, joint, branch, scratch, gradient):
    """What is left of the travel that one joint may make from a row to the next one, as a length.

    Writes the gradient, shape (4,); returns the length [m].
    """
    q, next_q, rates, next_rates = scratch.q, scratch.next_q, scratch.rates, scratch.next_rates
    retreat, after = task.retreats[row], task.retreats[row + 1]
    length = task.geometry.tool_length
    scale = (task.geometry.a2 + task.geometry.l3) / 2
    posture(task, scratch.axes, retreat, branch, q)
    joint_rates(task.geometry, q, scratch.axes, retreat + length, turn, rates, scratch.reach_rates)
    posture(task, scratch.axes, after, branch, next_q)
    joint_rates(
        task.geometry, next_q, scratch.axes, after + length, turn, next_rates, scratch.reach_rates
    )
    travel = wrap(q[joint] - next_q[joint])
    sign = 1.0 if travel >= 0 else -1.0
    for k in range(4):
        gradient[k] = -scale * sign * (rates[joint, k] - next_rates[joint, k])
    allowed = (1.0 - NEAREST_JUMP_SHARE) * JOINT_RATE_RAD_M * (retreat - after)
    return scale * (allowed - abs(travel))


@kernel
def thinning_turns(task, axes, branch, near):
    """Writes to `near` the posture at the target on the turns that `thinning` chooses."""
    reach = posture(task, axes, 0.0, branch, near)
    for i in range(6):
        for turn in (-2 * math.pi, 2 * math.pi):
            other = near[i] + turn
            inside = task.lower[i] <= other <= task.upper[i]
            if inside and abs(other - task.reference[i]) < abs(near[i] - task.reference[i]):
                near[i] = other
    return reach


@kernel
def constraints(task, origin, x, turn, branch, watched, scratch, values, gradients):
    """All watched constraints at x = (delta, angle); moves the task's target there."""
    for i in range(3):
        task.position[i] = origin[i] + x[i]
    tool_axes(task, x[3], scratch.axes)
    thinning_turns(task, scratch.axes, branch, scratch.near)
    count = watched.rows_count
    for w in range(count):
        row_constraints(
            task,
            turn,
            task.retreats[watched.rows[w]],
            branch,
            watched.spread,
            scratch,
            values[LIMITS * w : LIMITS * (w + 1)],
            gradients[LIMITS * w : LIMITS * (w + 1)],
        )
    for w in range(watched.jumps_count):
        row, joint = watched.jumps[w]
        j = LIMITS * count + w
        values[j] = jump_constraint(task, turn, row, joint, branch, scratch, gradients[j])


@kernel
def violation(values, count):
    """Sum of what is missing in broken constraints [m]."""
    total = 0.0
    for j in range(count):
        if values[j] < 0:
            total -= values[j]
    return total


@kernel
def lagrangian_slope(x, gradients, multipliers, count, slope):
    """Writes the Lagrangian's gradient, shape (4,)."""
    slope[0], slope[1], slope[2], slope[3] = x[0], x[1], x[2], 0.0
    for j in range(count):
        if multipliers[j] > 0:
            for i in range(4):
                slope[i] -= multipliers[j] * gradients[j, i]


@kernel
def minimise(task, origin, x, turn, branch, watched, best, scratch):
    """Local minimum of |delta| from x, written to x; returns what is missing in constraints [m].

    Infinite where it was left because it leads to a displacement longer than `best` [m].
    """
    rows = LIMITS * watched.rows_count + watched.jumps_count
    values, gradients = np.empty(rows), np.empty((rows, 4))
    new_values, new_gradients = np.empty(rows), np.empty((rows, 4))
    towards, curvature = np.empty((rows, 4)), np.empty(rows)
    hessian, inverse = np.empty((4, 4)), np.empty((4, 4))
    multipliers, step, slope = np.zeros(rows), np.empty(4), np.zeros(4)
    before, after, new = np.empty(4), np.empty(4), np.empty(4)
    reset(hessian, inverse)
    fresh = True
    constraints(task, origin, x, turn, branch, watched, scratch, values, gradients)
    most = NEAREST_PENALTY * (
        math.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2) + NEAREST_PENALTY_LEAST_M
    )
    for n in range(NEAREST_STEPS):
        slope[:3] = x[:3]
        penalty_programme(
            inverse, slope, values, gradients, most, multipliers, step, towards, curvature
        )
        length = math.sqrt(step[0] ** 2 + step[1] ** 2 + step[2] ** 2)
        if length + NEAREST_ANGLE_SCALE_M * abs(step[3]) < NEAREST_CONVERGED_M:
            break
        scale = min(1.0, NEAREST_LARGEST_TURN_RAD / max(abs(step[3]), LEAST_DIVISOR))
        if n >= NEAREST_TRIAL_STEPS and scale == 1.0:
            ahead = 0.0
            for i in range(3):
                ahead += (x[i] + step[i]) ** 2
            if math.sqrt(ahead) > NEAREST_HOPELESS * best:
                return math.inf
        here = violation(values, rows)
        merit = (x[0] ** 2 + x[1] ** 2 + x[2] ** 2) / 2 + most * here
        lagrangian_slope(x, gradients, multipliers, rows, before)
        accepted = False
        for _ in range(NEAREST_CUTS):
            for i in range(4):
                new[i] = x[i] + scale * step[i]
            constraints(
                task, origin, new, turn, branch, watched, scratch, new_values, new_gradients
            )
            there = (new[0] ** 2 + new[1] ** 2 + new[2] ** 2) / 2
            there += most * violation(new_values, rows)
            if there < merit:
                accepted = True
                break
            scale /= NEAREST_CUT
        if not accepted:
            if fresh:
                break
            reset(hessian, inverse)
            fresh = True
            continue
        lagrangian_slope(new, new_gradients, multipliers, rows, after)
        for i in range(4):
            step[i] *= scale
            after[i] -= before[i]
        update(hessian, inverse, step, after)
        fresh = False
        x[:] = new
        values[:] = new_values
        gradients[:, :] = new_gradients
    slope[:] = 0.0
    reset(hessian, inverse)
    for _ in range(NEAREST_RESTORATIONS):
        if violation(values, rows) <= 0.0:
            break
        penalty_programme(
            inverse, slope, values, gradients, most, multipliers, step, towards, curvature
        )
        x += step
        constraints(task, origin, x, turn, branch, watched, scratch, values, gradients)
    return violation(values, rows)


@kernel
def into_reach(task, origin, x, turn, branch, farthest, scratch):
    """Moves delta straight into the reach of the thinning posture, where it is outside.

    Leaves it, and returns False, where that is farther than `farthest` [m].
    """
    q = scratch.q
    tool_axes(task, x[3], scratch.axes)
    for n in range(NEAREST_REACH_STEPS):
        for i in range(3):
            task.position[i] = origin[i] + x[i]
        reach = posture(task, scratch.axes, 0.0, branch, q)
        if reach >= 0:
            break
        # No shift changes the reach by more than its length.
        if n == 0 and -reach > farthest:
            return False
        joint_rates(task.geometry, q, scratch.axes, 0.0, turn, scratch.rates, scratch.reach_rates)
        rates = scratch.reach_rates
        square = max(rates[0] ** 2 + rates[1] ** 2 + rates[2] ** 2, NEAREST_FLAT_REACH)
        for i in range(3):
            x[i] += rates[i] / square * (NEAREST_START_INSIDE_M - reach)
    return True


@kernel
def estimates(task, angles, spread, found, starts):
    """Estimates of the displacement that each branch and angle needs, and where to start.

    Args:
        task: the task.
        angles: approach angles, shape (n,).
        spread: displacement that every limit has to bear [m].
        found: written, shape (8, n): the way into reach and then to the worst limit of thinning and
            standby, to first order [m]; infinite where the way into reach alone is
            `NEAREST_PRUNED` times another's whole.
        starts: written, shape (8, n, 4): displacement and angle inside the reach.
    """
    origin, moved = task.position, copy_at(task, task.position.copy())
    turn, scratch = np.cross(task.outward, task.sideways), scratch_arrays()
    values, gradients = np.empty(2 * LIMITS), np.empty((2 * LIMITS, 4))
    ends = Watched(
        np.array([len(task.retreats) - 1, 0]), 2, np.empty((0, 2), dtype=np.int64), 0, spread
    )
    least = math.inf
    for branch in range(8):
        for k in range(len(angles)):
            x = starts[branch, k]
            found[branch, k] = math.inf
            if branch % 2 == 1:
                # The two wrists of an arm have the same wrist centre.
                x[:] = starts[branch - 1, k]
                if math.isinf(found[branch - 1, k]):
                    continue
            else:
                x[:] = 0.0
                x[3] = angles[k]
                if not into_reach(moved, origin, x, turn, branch, NEAREST_PRUNED * least, scratch):
                    continue
            constraints(moved, origin, x, turn, branch, ends, scratch, values, gradients)
            worst = 0.0
            for j in range(2 * LIMITS):
                if values[j] < 0:
                    slope = math.sqrt(
                        gradients[j, 0] ** 2 + gradients[j, 1] ** 2 + gradients[j, 2] ** 2
                    )
                    worst = max(worst, -values[j] / max(slope, NEAREST_FLATTEST))
            found[branch, k] = math.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2) + worst
            least = min(least, found[branch, k])


@kernel
def broken_row(task, rows):
    """The row that breaks its limits most, -1 for none."""
    worst, where = 0.0, -1
    for n in range(len(rows)):
        inside, _ = limit_margin(task, rows[n])
        if inside < worst:
            worst, where = inside, n
    return where


@kernel
def largest_jump(task, rows):
    """Row and joint of the largest travel from row to row, for what is allowed there."""
    most, row, joint = 0.0, 0, 0
    for n in range(len(rows) - 1):
        spacing = task.retreats[n] - task.retreats[n + 1]
        for i in range(6):
            rate = abs(rows[n, i] - rows[n + 1, i]) / spacing
            if rate > most:
                most, row, joint = rate, n, i
    return row, joint


@kernel
def nearest_displacement(task, branch, start, spread, best, rows):
    """The smallest displacement found on one branch from one start; `rows` is scratch.

    Left early where it leads to one longer than `best` [m].

    Returns:
        Whether the whole cut-in is feasible at the displaced target, and x = (delta [m], angle).
    """
    origin, moved = task.position, copy_at(task, task.position.copy())
    turn, scratch, x = np.cross(task.outward, task.sideways), scratch_arrays(), start.copy()
    listed, jumps = (
        np.zeros(NEAREST_ROUNDS + 3, dtype=np.int64),
        np.zeros((NEAREST_ROUNDS, 2), dtype=np.int64),
    )
    last = len(task.retreats) - 1
    listed[0], listed[1], listed[2], count, jumped = last, 0, last // 2, 3, 0
    widened = spread
    for _ in range(NEAREST_ROUNDS):
        watched = Watched(listed, count, jumps, jumped, widened)
        missing = minimise(moved, origin, x, turn, branch, watched, best, scratch)
        if missing > NEAREST_INSIDE_M:
            return False, x
        for i in range(3):
            moved.position[i] = origin[i] + x[i]
        if trace(moved, x[3], branch, task.retreats, rows) < 0:
            where = broken_row(task, rows)
            if where < 0:
                jumps[jumped] = largest_jump(task, rows)
                jumped += 1
                continue
            if where in listed[:count]:
                return False, x
            listed[count] = where
            count += 1
            continue
        if spread == 0.0:
            return True, x
        pose = np.eye(4)
        tool_axes(moved, x[3], scratch.axes)
        pose[:3, :3] = scratch.axes
        pose[:3, 3] = moved.position
        margin, where, _ = rows_displacement_margin(
            task.geometry, task.lower, task.upper, pose, task.retreats, branch, rows
        )
        if margin >= spread:
            return True, x
        widened += NEAREST_WIDENING * (spread - margin) + NEAREST_INSIDE_M
        if where not in listed[:count]:
            listed[count] = where
            count += 1
    return False, x


@kernel
def nearest_of_all(task, angles, spread):
    """The smallest displacement found from the best starts over all branches and angles.

    Args:
        task: the task.
        angles: approach angles over one turn at which starts are looked for, shape (n,) [rad].
        spread: displacement that every limit has to bear [m].

    Returns:
        Whether one was found, its branch, and x = (delta [m], angle), shape (4,).
    """
    n = len(angles)
    found, starts = np.empty((8, n)), np.empty((8, n, 4))
    estimates(task, angles, spread, found, starts)
    promising = np.full((8, n), np.inf)
    for branch in range(8):
        for k in range(n):
            here = found[branch, k]
            if here <= found[branch, k - 1] and here <= found[branch, (k + 1) % n]:
                promising[branch, k] = here
    rows = np.empty((len(task.retreats), 6))
    best, best_branch, best_x, any_found = math.inf, 0, np.zeros(4), False
    for _ in range(NEAREST_STARTS):
        branch, k = divmod(int(np.argmin(promising)), n)
        if promising[branch, k] >= NEAREST_PRUNED * best or promising[branch, k] == math.inf:
            break
        promising[branch, k] = math.inf
        feasible, x = nearest_displacement(task, branch, starts[branch, k], spread, best, rows)
        length = math.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2)
        if feasible and length < best:
            best, best_branch, any_found = length, branch, True
            best_x[:] = x
    return any_found, best_branch, best_x
