"""Kernels: the smallest displacement of a target at which its task becomes feasible.

Minimises |delta|^2 / 2 over the displacement delta and the approach angle phi, on one branch, with
the joint limits and the reach at some rows of the cut-in as constraints: a sequential quadratic
programme with an exact penalty (S l1 QP), BFGS and derivatives in closed form. Joint constraints
are multiplied by half the arm's length, so that all are lengths [m].
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.refusal.displacement_constraints import (
    Watched,
    constraints,
    copy_at,
    scratch_arrays,
)
from solver.approach.refusal.displacement_minimum import minimise
from solver.approach.refusal.tolerances import (
    NEAREST_FLAT_REACH,
    NEAREST_FLATTEST,
    NEAREST_INSIDE_M,
    NEAREST_PRUNED,
    NEAREST_REACH_STEPS,
    NEAREST_ROUNDS,
    NEAREST_START_INSIDE_M,
    NEAREST_STARTS,
    NEAREST_TURNS_RAD,
    NEAREST_WIDENING,
)
from solver.approach.task.constraints import LIMITS
from solver.approach.task.feasibility import (
    fastest_joint,
    limit_margin,
    posture,
    tool_axes,
    trace,
)
from solver.approach.uncertainty.displacement import rows_displacement_margin
from solver.approach.uncertainty.sensitivity import joint_rates
from solver.compiled import kernel


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
    ends = Watched(np.array([len(task.retreats) - 1, 0]), 2, np.empty(0, dtype=np.int64), 0, spread)
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
def nearest_displacement(task, branch, start, spread, best, rows):
    """The smallest displacement found on one branch from one start; `rows` is scratch.

    Left early where it leads to one longer than `best` [m].

    Returns:
        Whether the whole cut-in is feasible at the displaced target, and x = (delta [m], angle).
    """
    origin, moved = task.position, copy_at(task, task.position.copy())
    turn, scratch, x = np.cross(task.outward, task.sideways), scratch_arrays(), start.copy()
    listed = np.zeros(NEAREST_ROUNDS + 3, dtype=np.int64)
    jumps = np.zeros(NEAREST_ROUNDS, dtype=np.int64)
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
                _, _, jumps[jumped] = fastest_joint(task.geometry, task.retreats, rows)
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
    if any_found:
        # Minima are local: what is found is tried again from angles beside it.
        start, middle = best_x.copy(), best_x[3]
        for turn in NEAREST_TURNS_RAD:
            start[:] = best_x
            start[3] = middle + turn
            feasible, x = nearest_displacement(task, best_branch, start, spread, best, rows)
            length = math.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2)
            if feasible and length < best:
                best = length
                best_x[:] = x
    return any_found, best_branch, best_x
