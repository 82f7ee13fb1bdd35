"""Kernels: one step of a sequential quadratic programme in four variables."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import numpy as np

from solver.approach.refusal.tolerances import (
    NEAREST_ANGLE_SCALE_M,
    NEAREST_DAMPING,
)
from solver.compiled import kernel
from solver.tolerances import LEAST_DIVISOR


@kernel
def lead(inverse, gradients, j, towards, curvature):
    """Where constraint j pushes, and how much it gains by that."""
    curvature[j] = LEAST_DIVISOR
    for i in range(4):
        towards[j, i] = 0.0
        for k in range(4):
            towards[j, i] += inverse[i, k] * gradients[j, k]
        curvature[j] += gradients[j, i] * towards[j, i]


@kernel
def penalty_programme(
    inverse,
    slope,
    values,
    gradients,
    most,
    multipliers,
    step,
    towards,
    curvature,
    converged,
    sweeps,
):
    """Minimises step' H step / 2 + slope' step + most sum max(0, -(values + gradients step)).

    Coordinate ascent in the dual (Hildreth), whose multipliers the penalty keeps below `most`. It
    goes on from those that it is given: from step to step of a search the same constraints push.
    Between sweeps over all constraints those that push already are swept until they agree.

    Args:
        inverse: of H, shape (4, 4).
        slope: shape (4,).
        values: of the constraints, shape (n,).
        gradients: theirs, shape (n, 4).
        most: penalty.
        multipliers: to begin with, and written, shape (n,).
        step: written, shape (4,).
        towards: scratch, shape (n, 4).
        curvature: scratch, shape (n,).
        converged: change of a multiplier, which is a length, below which it is solved [m].
        sweeps: how many there are at most.
    """
    count = len(values)
    for i in range(4):
        step[i] = 0.0
        for k in range(4):
            step[i] -= inverse[i, k] * slope[k]
    for j in range(count):
        curvature[j] = -1.0
        if multipliers[j] > 0.0:
            lead(inverse, gradients, j, towards, curvature)
            for i in range(4):
                step[i] += towards[j, i] * multipliers[j]
    everything = True
    for _ in range(sweeps):
        largest = 0.0
        for j in range(count):
            if not everything and multipliers[j] == 0.0:
                continue
            value = values[j]
            for i in range(4):
                value += gradients[j, i] * step[i]
            if multipliers[j] == 0.0 and value >= 0.0:
                continue
            if curvature[j] < 0.0:
                lead(inverse, gradients, j, towards, curvature)
            changed = min(max(multipliers[j] - value / curvature[j], 0.0), most)
            change = changed - multipliers[j]
            if change != 0.0:
                multipliers[j] = changed
                largest = max(largest, abs(change))
                for i in range(4):
                    step[i] += towards[j, i] * change
        if largest <= converged:
            if everything:
                break
            everything = True
        else:
            everything = False


@kernel
def reset(hessian, inverse):
    """Curvature of the objective, with a weight on the turn."""
    hessian[:, :] = 0.0
    inverse[:, :] = 0.0
    for i in range(3):
        hessian[i, i], inverse[i, i] = 1.0, 1.0
    hessian[3, 3] = NEAREST_ANGLE_SCALE_M**2
    inverse[3, 3] = 1.0 / NEAREST_ANGLE_SCALE_M**2


@kernel
def update(hessian, inverse, step, change):
    """BFGS with Powell's damping, of the Hessian and its inverse."""
    towards = np.zeros(4)
    curved, along = 0.0, 0.0
    for i in range(4):
        for k in range(4):
            towards[i] += hessian[i, k] * step[k]
        curved += step[i] * towards[i]
        along += step[i] * change[i]
    if curved <= LEAST_DIVISOR:
        return
    if along < NEAREST_DAMPING * curved:
        share = (1 - NEAREST_DAMPING) * curved / (curved - along)
        for i in range(4):
            change[i] = share * change[i] + (1 - share) * towards[i]
        along = NEAREST_DAMPING * curved
    back, length = np.zeros(4), 0.0
    for i in range(4):
        for k in range(4):
            back[i] += inverse[i, k] * change[k]
        length += change[i] * back[i]
    for i in range(4):
        for k in range(4):
            hessian[i, k] += change[i] * change[k] / along - towards[i] * towards[k] / curved
            inverse[i, k] += (1 + length / along) * step[i] * step[k] / along - (
                back[i] * step[k] + step[i] * back[k]
            ) / along
