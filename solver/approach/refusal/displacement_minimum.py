"""Kernels: the smallest displacement under constraints, from one start on one branch."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.refusal.displacement_constraints import constraints
from solver.approach.refusal.penalty_programme import penalty_programme, reset, update
from solver.approach.refusal.tolerances import (
    NEAREST_ABOVE_MULTIPLIERS,
    NEAREST_ANGLE_SCALE_M,
    NEAREST_CONVERGED_M,
    NEAREST_CUT,
    NEAREST_CUTS,
    NEAREST_HOPELESS,
    NEAREST_LARGEST_TURN_RAD,
    NEAREST_MISSING_M,
    NEAREST_PENALTY,
    NEAREST_PENALTY_LEAST_M,
    NEAREST_QP_CONVERGED_M,
    NEAREST_QP_EXACT_M,
    NEAREST_QP_EXACT_SWEEPS,
    NEAREST_QP_SWEEPS,
    NEAREST_RATE_CUTS,
    NEAREST_RATE_STEPS,
    NEAREST_RESTORATIONS,
    NEAREST_RESTORED,
    NEAREST_RESTORED_M,
    NEAREST_SAME,
    NEAREST_STEPS,
    NEAREST_TRIAL_STEPS,
)
from solver.approach.task.constraints import LIMITS
from solver.compiled import kernel
from solver.tolerances import LEAST_DIVISOR


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
def minimise(task, origin, x, turn, branch, watched, known, best, share, scratch):
    """Local minimum of |delta| from x, written to x; returns what is missing in constraints [m].

    Infinite where it was left because it leads to a displacement longer than `best` [m], or to the
    one that is `known`, shape (3,) [m].
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
    weight, steps, cuts = 0.0, NEAREST_STEPS, NEAREST_CUTS
    if watched.jumps_count > 0:
        steps, cuts = NEAREST_RATE_STEPS, NEAREST_RATE_CUTS
    for n in range(steps):
        slope[:3] = x[:3]
        penalty_programme(
            inverse, slope, values, gradients, most, multipliers, step, towards, curvature,
            NEAREST_QP_CONVERGED_M, NEAREST_QP_SWEEPS,
        )  # fmt: skip
        here = violation(values, rows)
        there, length, ahead, apart = 0.0, 0.0, 0.0, 0.0
        for i in range(3):
            there += x[i] ** 2
            length += step[i] ** 2
            ahead += (x[i] + step[i]) ** 2
            apart += (x[i] + step[i] - known[i]) ** 2
        near = NEAREST_CONVERGED_M + share * math.sqrt(there)
        if math.sqrt(length) + NEAREST_ANGLE_SCALE_M * abs(step[3]) < near:
            break
        scale = min(1.0, NEAREST_LARGEST_TURN_RAD / max(abs(step[3]), LEAST_DIVISOR))
        of_no_use = ahead > (NEAREST_HOPELESS * best) ** 2 or apart < (NEAREST_SAME * best) ** 2
        if of_no_use and n >= NEAREST_TRIAL_STEPS and scale == 1.0:
            return math.inf
        # Above the multipliers the penalty is exact; far above it steps along bent limits fail.
        weight = max(weight, NEAREST_ABOVE_MULTIPLIERS * multipliers.max())
        merit = there / 2 + weight * here
        lagrangian_slope(x, gradients, multipliers, rows, before)
        accepted = False
        for _ in range(cuts):
            for i in range(4):
                new[i] = x[i] + scale * step[i]
            constraints(
                task, origin, new, turn, branch, watched, scratch, new_values, new_gradients
            )
            there = (new[0] ** 2 + new[1] ** 2 + new[2] ** 2) / 2
            there += weight * violation(new_values, rows)
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
    if math.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2) > NEAREST_HOPELESS * best:
        return math.inf
    slope[:] = 0.0
    reset(hessian, inverse)
    before_missing = NEAREST_RESTORED_M / NEAREST_RESTORED
    for _ in range(NEAREST_RESTORATIONS):
        missing = violation(values, rows)
        if missing <= NEAREST_MISSING_M or missing > NEAREST_RESTORED * before_missing:
            break
        before_missing = missing
        multipliers[:] = 0.0
        penalty_programme(
            inverse, slope, values, gradients, most, multipliers, step, towards, curvature,
            NEAREST_QP_EXACT_M, NEAREST_QP_EXACT_SWEEPS,
        )  # fmt: skip
        x += step
        constraints(task, origin, x, turn, branch, watched, scratch, values, gradients)
    return violation(values, rows)
