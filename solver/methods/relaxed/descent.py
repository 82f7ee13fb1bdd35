"""Kernels: the closed form's optimum at points of the relaxations, and its descent among them.

At a fixed strike and swing a relaxed task is an unrelaxed one whose global optimum is known; as a
function of strike and swing that optimum has kinks and may jump where an arc ends, so it is
descended without derivatives (Nelder and Mead, 1965), begun anew from where it ended.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.optimum.cheapest import cheapest, cheapest_scratch
from solver.approach.task.packed import COLUMNS, PackedTask
from solver.compiled import inlined, kernel
from solver.methods.relaxed.tolerances import (
    SIMPLEX_GAIN,
    SIMPLEX_SHARE,
    SIMPLEX_SIZE,
)

_TOOL_LENGTH = COLUMNS["tool_length"]
_TURNED = np.array(
    [COLUMNS[name] for name in ("y", "outward", "sideways", "x_outward", "x_sideways")]
)
_OUTWARD, _SIDEWAYS = COLUMNS["outward"], COLUMNS["sideways"]


@inlined
def turned_about(axis, cos, sin, x, y, z):
    """A vector turned about a unit axis, shape (3,), by an angle's cosine and sine (Rodrigues)."""
    part = (axis[0] * x + axis[1] * y + axis[2] * z) * (1.0 - cos)
    return (
        cos * x + part * axis[0] + sin * (axis[1] * z - axis[2] * y),
        cos * y + part * axis[1] + sin * (axis[2] * x - axis[0] * z),
        cos * z + part * axis[2] + sin * (axis[0] * y - axis[1] * x),
    )


@kernel
def write_fixed(numbers, strike, along, across, fixed):
    """Writes a packed task's numbers with the tool `strike` [m] beyond and swung, shape (NUMBERS,).

    The swing's rotation vector is `along` times the approach direction at angle 0 and `across`
    times that at a quarter turn [rad].
    """
    fixed[:] = numbers
    fixed[_TOOL_LENGTH] = numbers[_TOOL_LENGTH] - strike
    angle = math.hypot(along, across)
    if angle == 0.0:
        return
    axis = np.empty(3)
    for i in range(3):
        axis[i] = (along * numbers[_OUTWARD + i] + across * numbers[_SIDEWAYS + i]) / angle
    cos, sin = math.cos(angle), math.sin(angle)
    for first in _TURNED:
        x, y, z = numbers[first], numbers[first + 1], numbers[first + 2]
        turned = turned_about(axis, cos, sin, x, y, z)
        fixed[first], fixed[first + 1], fixed[first + 2] = turned


@kernel
def write_points(numbers, strikes, along, across, fixed):
    """`write_fixed` for both tool sides and n points; `fixed` is shape (sides, n, NUMBERS)."""
    for side in range(len(numbers)):
        for k in range(len(strikes)):
            write_fixed(numbers[side], strikes[k], along[k], across[k], fixed[side, k])


@kernel
def effort_in_zone(numbers, retreats, cos_steps, scratch, zone, x, fixed):
    """The closed form's least effort at x, shares of the zone, which is brought back into it."""
    x[0] = min(max(x[0], 0.0), 1.0)
    length = math.hypot(x[1], x[2])
    if length > 1.0:
        x[1] /= length
        x[2] /= length
    best = math.inf
    for side in range(len(numbers)):
        write_fixed(numbers[side], zone[0] * x[0], zone[1] * x[1], zone[1] * x[2], fixed)
        task = PackedTask(fixed, retreats, cos_steps)
        _, _, cost, _ = cheapest(task, scratch, best)
        best = min(best, cost)
    return best


@kernel
def descend(numbers, retreats, cos_steps, zone, start, most):
    """Shares of a zone, shape (3,), at which the closed form's effort is least near `start`.

    Args:
        numbers: the packed task by tool side, shape (sides, NUMBERS).
        retreats: of a `PackedTask`.
        cos_steps: of a `PackedTask`.
        zone: strike zone [m] and tilt tolerance [rad], shape (2,); 0 for one that is off.
        start: share of the strike zone, and of the tolerance along both directions, shape (3,).
        most: points that are looked at, at most; a step may go beyond it.
    """
    moving = np.array([0, 1, 2])[np.array([zone[0] > 0.0, zone[1] > 0.0, zone[1] > 0.0])]
    scratch, fixed = cheapest_scratch(len(retreats)), np.empty(numbers.shape[1])
    n = len(moving)
    simplex, costs, x = np.empty((n + 1, 3)), np.empty(n + 1), start.copy()
    best, size, looks = math.inf, SIMPLEX_SIZE, 0
    while looks < most:
        for k in range(n + 1):
            simplex[k] = x
            if k > 0:
                i = moving[k - 1]
                simplex[k, i] += -size if x[i] > 1.0 - size else size
            costs[k] = effort_in_zone(
                numbers, retreats, cos_steps, scratch, zone, simplex[k], fixed
            )
        looks += n + 1
        before = best
        while looks < most:
            order = np.argsort(costs)
            simplex, costs = simplex[order], costs[order]
            if np.abs(simplex - simplex[0]).max() < SIMPLEX_SHARE:
                break
            centre = np.zeros(3)
            for k in range(n):
                centre += simplex[k] / n
            worst = simplex[n]
            tried = 2.0 * centre - worst
            cost = effort_in_zone(numbers, retreats, cos_steps, scratch, zone, tried, fixed)
            looks += 1
            if cost < costs[0]:
                further = 3.0 * centre - 2.0 * worst
                other = effort_in_zone(numbers, retreats, cos_steps, scratch, zone, further, fixed)
                looks += 1
                if other < cost:
                    tried, cost = further, other
            elif cost >= costs[n - 1]:
                outside = cost < costs[n]
                tried = (centre + tried) / 2.0 if outside else (centre + worst) / 2.0
                other = effort_in_zone(numbers, retreats, cos_steps, scratch, zone, tried, fixed)
                looks += 1
                if other >= min(cost, costs[n]):
                    for k in range(1, n + 1):
                        simplex[k] = (simplex[0] + simplex[k]) / 2.0
                        costs[k] = effort_in_zone(
                            numbers, retreats, cos_steps, scratch, zone, simplex[k], fixed
                        )
                    looks += n
                    continue
                cost = other
            simplex[n], costs[n] = tried, cost
        lowest = int(np.argmin(costs))
        x[:] = simplex[lowest]
        best = costs[lowest]
        size = max(size / 4.0, 2 * SIMPLEX_SHARE)
        if before - best <= SIMPLEX_GAIN * best:
            break
    return x
