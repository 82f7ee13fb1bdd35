"""Kernels: the least effort over feasible arcs, to rounding.

On an arc effort is sampled; between two samples it is at least the sum of each joint's smaller
travel, less what a joint may do in between, so most cells are beaten by the best sample. In the
others each joint that passes its reference value makes a kink of the l1 norm, found as a root, and
between kinks effort is smooth and its minimum is closed in on.
"""

import math
from typing import NamedTuple

import numpy as np

from solver.approach.packed import LOWER, REFERENCE, SQUARED, UPPER, WEIGHTS
from solver.approach.turns import TURN_ROWS, joints_of_turns, turns_at_angles
from solver.compiled import kernel
from solver.robots.model import Array
from solver.tolerances import (
    ANGLE_STEP_RAD,
    EFFORT_CELL_RAD,
    EFFORT_SWING_RAD,
    LEAST_EFFORT_CELLS,
    SMOOTH_MINIMUM_RAD,
)

_MOST = math.ceil(2 * math.pi / EFFORT_CELL_RAD) + 1
_ZOOM = 9
_SLOPE_SHARE = 1e-3


class EffortScratch(NamedTuple):
    """Working memory of the kernels: an arc's samples, and those of one cell."""

    angles: Array
    cosines: Array
    sines: Array
    turns: Array
    joints: Array
    efforts: Array


@kernel
def effort_scratch():
    """Working memory for arcs of up to one turn."""
    n = _MOST
    return EffortScratch(
        np.empty(n), np.empty(n), np.empty(n), np.empty((TURN_ROWS, n)), np.empty((6, n)),
        np.empty(n),
    )  # fmt: skip


@kernel
def nearest_turns(task, joints, count):
    """Moves joints that can turn further than once to the turn nearest to the reference."""
    numbers = task.numbers
    for i in range(6):
        if numbers[UPPER + i] - numbers[LOWER + i] <= 2 * math.pi:
            continue
        for n in range(count):
            q = joints[i, n]
            for turn in (-2 * math.pi, 2 * math.pi):
                other = joints[i, n] + turn
                inside = numbers[LOWER + i] <= other <= numbers[UPPER + i]
                if inside and abs(other - task.numbers[REFERENCE + i]) < abs(
                    q - task.numbers[REFERENCE + i]
                ):
                    q = other
            joints[i, n] = q


@kernel
def sample_effort(task, scratch, branch, count):
    """Fills cosines, sines, turns, joints and efforts of the first `count` angles of scratch."""
    for n in range(count):
        scratch.cosines[n] = math.cos(scratch.angles[n])
        scratch.sines[n] = math.sin(scratch.angles[n])
    turns_at_angles(task, scratch.cosines, scratch.sines, count, 0.0, branch // 2, scratch.turns)
    joints_of_turns(task, scratch.turns, count, branch % 2, scratch.joints)
    nearest_turns(task, scratch.joints, count)
    squared = task.numbers[SQUARED] > 0.0
    for n in range(count):
        scratch.efforts[n] = 0.0
    for i in range(6):
        reference, weight = task.numbers[REFERENCE + i], task.numbers[WEIGHTS + i]
        for n in range(count):
            change = abs(scratch.joints[i, n] - reference)
            scratch.efforts[n] += weight * (change * change if squared else change)


@kernel
def spread(scratch, low, high, count):
    """Sets the first `count` angles of scratch evenly from low to high, both included."""
    step = (high - low) / (count - 1)
    for n in range(count):
        scratch.angles[n] = low + n * step
    scratch.angles[count - 1] = high


@kernel
def least_in_cell(task, joints, k, count):
    """What effort is at least between samples k and k + 1 of an arc's `count`.

    A joint may leave the range between its two samples by half of what it turns next to it.
    """
    total = 0.0
    for i in range(6):
        a, b = (
            joints[i, k] - task.numbers[REFERENCE + i],
            joints[i, k + 1] - task.numbers[REFERENCE + i],
        )
        beside = abs(b - a)
        if k > 0:
            beside = max(beside, abs(joints[i, k] - joints[i, k - 1]))
        if k + 2 < count:
            beside = max(beside, abs(joints[i, k + 2] - joints[i, k + 1]))
        least = 0.0 if (a < 0.0) != (b < 0.0) else max(min(abs(a), abs(b)) - beside / 2, 0.0)
        total += task.numbers[WEIGHTS + i] * (
            least * least if task.numbers[SQUARED] > 0.0 else least
        )
    return total


@kernel
def optimum_on_arc(task, branch, low, high, best):
    """The same as `least_effort`, with working memory of its own."""
    return least_effort(task, effort_scratch(), effort_scratch(), branch, low, high, best)


@kernel
def least_effort(task, arc, cell, branch, low, high, best):
    """Angle and effort of the least effort on one arc, if below `best`.

    Args:
        task: the target seen from its reference.
        arc: scratch for the arc's samples.
        cell: scratch for the samples within one cell.
        branch: 0 to 7.
        low: the arc's lower end [rad].
        high: its upper end [rad].
        best: effort to beat; infinity to get the arc's own optimum.

    Returns:
        The angle [rad], its effort and how many cells were refined; the angle is NaN and the effort
        `best` where nothing on the arc is below it.
    """
    cells = max(LEAST_EFFORT_CELLS, math.ceil((high - low) / EFFORT_CELL_RAD))
    count = min(cells, _MOST - 1) + 1
    spread(arc, low, high, count)
    sample_effort(task, arc, branch, count)
    angle, refined = math.nan, 0
    for n in range(count):
        if arc.efforts[n] < best:
            angle, best = arc.angles[n], arc.efforts[n]
    for k in range(count - 1):
        if least_in_cell(task, arc.joints, k, count) >= best:
            continue
        refined += 1
        found, cost = refine_cell(task, cell, branch, arc.angles[k], arc.angles[k + 1], best)
        if cost < best:
            angle, best = found, cost
    return angle, best, refined


@kernel
def refine_cell(task, scratch, branch, low, high, best):
    """Angle and effort of the least effort between two angles, if below `best`."""
    stack = np.empty((64, 2))
    stack[0, 0], stack[0, 1] = low, high
    top, angle = 1, math.nan
    bounds = np.empty(8)
    while top > 0:
        top -= 1
        a, b = stack[top, 0], stack[top, 1]
        spread(scratch, a, b, 3)
        sample_effort(task, scratch, branch, 3)
        for n in range(3):
            if scratch.efforts[n] < best:
                angle, best = scratch.angles[n], scratch.efforts[n]
        if swings_between(scratch.joints, 2) and b - a > ANGLE_STEP_RAD and top + 2 <= len(stack):
            middle = (a + b) / 2
            stack[top, 0], stack[top, 1] = middle, b
            stack[top + 1, 0], stack[top + 1, 1] = a, middle
            top += 2
            continue
        found = 0
        bounds[0] = a
        if task.numbers[SQUARED] == 0.0:
            for i in range(6):
                before = scratch.joints[i, 0] - task.numbers[REFERENCE + i]
                after = scratch.joints[i, 2] - task.numbers[REFERENCE + i]
                if (before < 0.0) != (after < 0.0):
                    found += 1
                    bounds[found] = -(i + 1)
            for n in range(1, found + 1):
                bounds[n] = kink(task, scratch, branch, a, b, int(-bounds[n]) - 1)
        bounds[1 : found + 1].sort()
        bounds[found + 1] = b
        for n in range(found + 1):
            where, cost = smooth_minimum(task, scratch, branch, bounds[n], bounds[n + 1])
            if cost < best:
                angle, best = where, cost
    return angle, best


@kernel
def swings_between(joints, last):
    """Whether a joint turns further than EFFORT_SWING_RAD from the first sample to `last`."""
    for i in range(6):
        for n in range(last):
            if abs(joints[i, n + 1] - joints[i, n]) > EFFORT_SWING_RAD:
                return True
    return False


@kernel
def travel_at(task, scratch, branch, angle, joint):
    """How far a joint is from its reference value at one angle [rad]."""
    scratch.angles[0] = angle
    sample_effort(task, scratch, branch, 1)
    return scratch.joints[joint, 0] - task.numbers[REFERENCE + joint]


@kernel
def kink(task, scratch, branch, low, high, joint):
    """Angle between two at which a joint passes its reference value (Illinois method)."""
    a, fa = low, travel_at(task, scratch, branch, low, joint)
    b, fb = high, travel_at(task, scratch, branch, high, joint)
    if (fa < 0.0) == (fb < 0.0):
        return a if abs(fa) < abs(fb) else b
    c = a
    for _ in range(60):
        if fa == fb:
            break
        c = b - fb * (b - a) / (fb - fa)
        fc = travel_at(task, scratch, branch, c, joint)
        if abs(fc) <= ANGLE_STEP_RAD * 1e-3 or abs(b - a) <= ANGLE_STEP_RAD * 1e-2:
            break
        if (fc < 0.0) != (fb < 0.0):
            a, fa = b, fb
        else:
            fa *= 0.5
        b, fb = c, fc
    return c


@kernel
def smooth_minimum(task, scratch, branch, low, high):
    """Angle and effort of the least effort where effort is smooth between two angles.

    Both ends are candidates; between them only where effort falls at the lower and rises at the
    upper, and there by closing in on the best of evenly spaced angles.
    """
    h = (high - low) * _SLOPE_SHARE
    scratch.angles[0], scratch.angles[1] = low, low + h
    scratch.angles[2], scratch.angles[3] = high - h, high
    sample_effort(task, scratch, branch, 4)
    costs = scratch.efforts
    falls, rises = costs[1] < costs[0], costs[3] > costs[2]
    angle, best = (low, costs[0]) if costs[0] <= costs[3] else (high, costs[3])
    if not falls or not rises:
        return angle, best
    a, b = low, high
    while b - a > SMOOTH_MINIMUM_RAD:
        spread(scratch, a, b, _ZOOM)
        sample_effort(task, scratch, branch, _ZOOM)
        k = 0
        for n in range(1, _ZOOM):
            if costs[n] < costs[k]:
                k = n
        if costs[k] < best:
            angle, best = scratch.angles[k], costs[k]
        a, b = scratch.angles[max(k - 1, 0)], scratch.angles[min(k + 1, _ZOOM - 1)]
    return angle, best
