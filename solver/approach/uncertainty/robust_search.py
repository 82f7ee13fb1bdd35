"""Kernels: the parts of a feasible arc that bear a displacement of the target."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.tolerances import ARC_SAMPLES, LEAST_EFFORT_CELLS
from solver.approach.uncertainty.displacement import displacement_margin
from solver.approach.uncertainty.tolerances import ROBUST_ANGLE_RAD
from solver.compiled import kernel

_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


@kernel
def margin_less(task, angle, branch, needed, rows):
    """Displacement margin less what is needed [m]."""
    return displacement_margin(task, angle, branch, rows)[0] - needed


@kernel
def extreme_displacement_margin(task, branch, low, high, sign, needed, rows):
    """Golden section for the largest (sign 1) or smallest (-1) margin; stops where it crosses 0."""
    x1, x2 = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    f1 = sign * margin_less(task, x1, branch, needed, rows)
    f2 = sign * margin_less(task, x2, branch, needed, rows)
    while high - low > ROBUST_ANGLE_RAD and not max(f1, f2) > 0:
        if f1 >= f2:
            high, x2, f2 = x2, x1, f1
            x1 = high - _GOLDEN * (high - low)
            f1 = sign * margin_less(task, x1, branch, needed, rows)
        else:
            low, x1, f1 = x1, x2, f2
            x2 = low + _GOLDEN * (high - low)
            f2 = sign * margin_less(task, x2, branch, needed, rows)
    return (x1, sign * f1) if f1 >= f2 else (x2, sign * f2)


@kernel
def robust_pieces(task, branch, lower, upper, needed):
    """The parts of a feasible arc whose displacement margin is at least `needed` [m].

    Sampled every half degree; narrow maxima below and narrow minima above what is needed are looked
    for between samples, and every change is bisected, the robust side kept.

    Returns:
        Lower and upper angles, shape (parts, 2), the largest margin met [m] and its angle.
    """
    rows = np.empty((len(task.retreats), 6))
    n = max(LEAST_EFFORT_CELLS, math.ceil((upper - lower) / (2 * math.pi) * ARC_SAMPLES)) + 1
    angles, values = np.linspace(lower, upper, n), np.empty(n)
    for k in range(n):
        values[k] = margin_less(task, angles[k], branch, needed, rows)
    best = int(np.argmax(values))
    largest, where = values[best] + needed, angles[best]
    marks, robust, count = np.empty(2 * n), np.empty(2 * n, dtype=np.bool_), 0
    for k in range(n):
        here = values[k]
        before, after = values[max(k - 1, 0)], values[min(k + 1, n - 1)]
        sign = -1.0 if here >= 0 else 1.0
        found, value = angles[k], here
        if sign * here >= sign * before and sign * here >= sign * after:
            found, value = extreme_displacement_margin(
                task, branch, angles[max(k - 1, 0)], angles[min(k + 1, n - 1)], sign, needed, rows
            )
            if value + needed > largest:
                largest, where = value + needed, found
        crossed = (value >= 0) != (here >= 0)
        if crossed and found < angles[k]:
            marks[count], robust[count] = found, value >= 0
            count += 1
        marks[count], robust[count] = angles[k], here >= 0
        count += 1
        if crossed and found > angles[k]:
            marks[count], robust[count] = found, value >= 0
            count += 1
    parts, first = np.empty((0, 2)), 0.0
    for k in range(count):
        if not robust[k]:
            continue
        if k == 0 or not robust[k - 1]:
            first = marks[k]
            if k > 0:
                first = robust_end(task, branch, marks[k], marks[k - 1], needed, rows)
        if k == count - 1 or not robust[k + 1]:
            end = marks[k]
            if k < count - 1:
                end = robust_end(task, branch, marks[k], marks[k + 1], needed, rows)
            parts = np.concatenate((parts, np.array([[first, end]])))
    return parts, largest, where


@kernel
def robust_end(task, branch, robust, not_robust, needed, rows):
    """The last robust angle between a robust one and one that is not."""
    while abs(robust - not_robust) > ROBUST_ANGLE_RAD:
        middle = (robust + not_robust) / 2
        if margin_less(task, middle, branch, needed, rows) >= 0:
            robust = middle
        else:
            not_robust = middle
    return robust
