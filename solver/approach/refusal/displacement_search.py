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
    calm_reach,
    copy_at,
    scratch_arrays,
)
from solver.approach.refusal.displacement_minimum import minimise
from solver.approach.refusal.displacement_seeds import seeds
from solver.approach.refusal.tolerances import (
    NEAREST_BENT_RAD,
    NEAREST_CALMER,
    NEAREST_CONVERGED_SHARE,
    NEAREST_FOUND_SHARE,
    NEAREST_INSIDE_M,
    NEAREST_ROUNDS,
    NEAREST_SHORT_M,
    NEAREST_STARTS,
    NEAREST_WIDENING,
    SEED_BINS,
    SEED_SPREAD,
    SEED_SPREAD_M,
)
from solver.approach.task.feasibility import limit_margin, tool_axes, trace
from solver.approach.uncertainty.displacement import rows_displacement_margin
from solver.compiled import NONE_YET, kernel
from solver.kinematics.straight_rates import between_rate_room, posture_rate_room


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
def fastest_row(task, rows):
    """The row in which joints are shortest of room below the highest rate, or behind which.

    As `trace` measures it: what is watched has to be what breaks.
    """
    least, where = math.inf, 0
    for n in range(len(rows)):
        room = posture_rate_room(task.geometry, rows[n])
        if n + 1 < len(rows):
            spacing = task.retreats[n] - task.retreats[n + 1]
            swing = between_rate_room(task.geometry, rows[n], rows[n + 1], spacing)
            room = min(room, swing)
        if room < least:
            least, where = room, n
    return where


@kernel
def nearest_displacement(task, branch, start, spread, inside, known, best, share, rows):
    """The smallest displacement found on one branch from one start.

    Args:
        task: the task.
        branch: inverse kinematics branch.
        start: displacement [m] and angle, shape (4,).
        spread: displacement that every limit has to bear [m].
        inside: how far inside the reach the wrist centre has to be [m].
        known: a displacement that is not looked for again, shape (3,) [m].
        best: length from which on displacements are of no use [m].
        share: step below which the minimum is found, as a share of the displacement.
        rows: scratch, shape (rows, 6).

    Returns:
        Whether the whole cut-in is feasible at the displaced target, and x = (delta [m], angle).
    """
    origin, moved = task.position, copy_at(task, task.position.copy())
    turn, scratch, x = np.cross(task.outward, task.sideways), scratch_arrays(), start.copy()
    listed = np.zeros(NEAREST_ROUNDS + 2, dtype=np.int64)
    jumps = np.zeros(NEAREST_ROUNDS, dtype=np.int64)
    last = len(task.retreats) - 1
    listed[0], listed[1], count, jumped = last, 0, 2, 0
    widened = spread
    for _ in range(NEAREST_ROUNDS):
        watched = Watched(listed, count, jumps, jumped, widened, inside, 0.0)
        missing = minimise(moved, origin, x, turn, branch, watched, known, best, share, scratch)
        if missing > NEAREST_INSIDE_M or math.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2) >= best:
            return False, x
        for i in range(3):
            moved.position[i] = origin[i] + x[i]
        if trace(moved, x[3], branch, task.retreats, rows) < 0:
            where = broken_row(task, rows)
            if where < 0:
                if jumped == 0:
                    # Beside a stretched elbow or a straight wrist rates are far from linear.
                    calm = NEAREST_CALMER * calm_reach(task.geometry)
                    away = Watched(listed, count, jumps, 0, widened, calm, NEAREST_BENT_RAD)
                    minimise(moved, origin, x, turn, branch, away, known, math.inf, share, scratch)
                jumps[jumped] = fastest_row(task, rows)
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
def nearest_of_all(task, spread, best):
    """The smallest displacement found from the best starts over all branches and angles.

    Args:
        task: the task.
        spread: displacement that every limit has to bear [m].
        best: length of a displacement that is known already [m]; infinity if none is.

    Returns:
        Whether a shorter one was found, its branch, and x = (delta [m], angle), shape (4,).
    """
    needed, starts = np.empty((8, SEED_BINS)), np.empty((8, SEED_BINS, 4))
    seeds(task, needed, starts)
    rows = np.empty((len(task.retreats), 6))
    calm = calm_reach(task.geometry)
    found, best_branch, best_x, known = False, NONE_YET, np.zeros(4), np.full(4, np.inf)
    for _ in range(NEAREST_STARTS):
        branch, part = divmod(int(np.argmin(needed)), SEED_BINS)
        if needed[branch, part] >= SEED_SPREAD * best + SEED_SPREAD_M:
            break
        needed[branch, part] = math.inf
        feasible, x = nearest_displacement(
            task, branch, starts[branch, part], spread, calm, known, best,
            NEAREST_CONVERGED_SHARE, rows,
        )  # fmt: skip
        length = math.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2)
        if feasible and length < best:
            found, best, best_branch = True, length, branch
            best_x[:], known[:] = x, x
    if found:
        known[:] = math.inf
        inside = NEAREST_INSIDE_M if best < NEAREST_SHORT_M else calm
        feasible, x = nearest_displacement(
            task, best_branch, best_x, spread, inside, known, math.inf, NEAREST_FOUND_SHARE, rows
        )
        if feasible and math.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2) < best:
            best_x[:] = x
    return found, best_branch, best_x
