"""Kernels: the least effort over feasible arcs, to rounding.

On an arc effort is sampled; between two samples it is at least the sum of each joint's smaller
travel, less what a joint may do in between, so most cells are beaten by the best sample. In the
others each joint that passes its reference value makes a kink of the l1 norm, found as a root, and
between kinks effort is smooth and its minimum is closed in on.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.arcs.cells import peak_above
from solver.approach.optimum.effort_samples import (
    MOST_SAMPLES,
    effort_scratch,
    sample_effort,
    spread,
)
from solver.approach.optimum.tolerances import (
    EFFORT_CELL_RAD,
    EFFORT_SMOOTH_RAD,
    EFFORT_STACK,
    EFFORT_SWING_RAD,
    FLAT_EFFORT,
    KINK_ANGLE_RAD,
    KINK_STEPS,
    KINK_TRAVEL_RAD,
    SLOPE_SHARE,
    SMOOTH_MINIMUM_RAD,
)
from solver.approach.task.packed import REFERENCE, SQUARED, WEIGHTS, PackedTask
from solver.approach.tolerances import ANGLE_STEP_RAD, LEAST_EFFORT_CELLS, TURN_CHANGE_SHARE
from solver.compiled import YES, kernel
from solver.problem.effort import joint_cost

_GOLDEN = (3.0 - math.sqrt(5.0)) / 2.0


@kernel
def least_in_cell(task, joints, k, count):
    """What effort is at least between samples k and k + 1 of an arc's `count`.

    A joint leaves the range between its two samples by a TURN_CHANGE_SHARE of what its turn changes
    from cell to cell.
    """
    total = 0.0
    for i in range(6):
        a, b = (
            joints[i, k] - task.numbers[REFERENCE + i],
            joints[i, k + 1] - task.numbers[REFERENCE + i],
        )
        change = 0.0
        if k > 0:
            change = abs(b - a - (joints[i, k] - joints[i, k - 1]))
        if k + 2 < count:
            change = max(change, abs(joints[i, k + 2] - joints[i, k + 1] - (b - a)))
        slack = TURN_CHANGE_SHARE * change
        least = 0.0 if (a < 0.0) != (b < 0.0) else max(min(abs(a), abs(b)) - slack, 0.0)
        total += task.numbers[WEIGHTS + i] * joint_cost(least, task.numbers[SQUARED] > 0.0)
    return total


@kernel
def is_smooth(task, joints, k, count):
    """Whether effort has no kink from sample k - 1 to k + 2, and no joint swings there."""
    l1 = task.numbers[SQUARED] == 0.0
    first, last = max(k - 1, 0), min(k + 2, count - 1)
    for i in range(6):
        reference = task.numbers[REFERENCE + i]
        beside, nearest, sign = 0.0, math.inf, joints[i, k] - reference
        for n in range(first, last):
            beside = max(beside, abs(joints[i, n + 1] - joints[i, n]))
        for n in range(first, last + 1):
            travel = joints[i, n] - reference
            nearest = min(nearest, abs(travel) if (travel < 0.0) == (sign < 0.0) else 0.0)
        if beside > EFFORT_SMOOTH_RAD or (l1 and nearest <= beside / 2):
            return False
    return True


@kernel
def valley(efforts, k, count):
    """What effort is at least between samples k and k + 1 where it is smooth.

    Where it is convex it stays above the lines that lead in from outside, else above both samples.
    """
    low, high = efforts[k], efforts[k + 1]
    before = efforts[k - 1] if k > 0 else math.inf
    after = efforts[k + 2] if k + 2 < count else math.inf
    if k > 0 and k + 2 < count:
        return -peak_above(-before, -low, -high, -after)
    if k > 0:
        return min(low, high, 2 * low - before) if before > low else min(low, high)
    return min(low, high, 2 * high - after) if after > high else min(low, high)


@kernel
def optimum_on_arcs(numbers, retreats, cos_steps, sides, branches, lower, upper):
    """The arc of least effort of some arcs, shape (n,) each, its angle, effort, and cells refined.

    `numbers` are packed rows by tool side, shape (sides, NUMBERS). The arc is -1 where there is
    none.
    """
    rows = len(retreats)
    samples, cell = effort_scratch(rows), effort_scratch(rows)
    arc, angle, best, refined = -1, math.nan, math.inf, 0
    for n in range(len(branches)):
        task = PackedTask(numbers[sides[n]], retreats, cos_steps)
        where, cost, count = least_effort(
            task, samples, cell, branches[n], lower[n], upper[n], YES, YES, best
        )
        refined += count
        if cost < best:
            arc, angle, best = n, where, cost
    return arc, angle, best, refined


@kernel
def least_effort(task, arc, cell, branch, low, high, low_cusp, high_cusp, best):
    """Angle and effort of the least effort on one arc, if below `best`.

    Args:
        task: the target seen from its reference.
        arc: scratch for the arc's samples.
        cell: scratch for the samples within one cell.
        branch: 0 to 7.
        low: the arc's lower end [rad].
        high: its upper end [rad].
        low_cusp: effort may turn within no distance of the lower end, at the edge of reach.
        high_cusp: the same of the upper end.
        best: effort to beat; infinity to get the arc's own optimum.

    Returns:
        The angle [rad], its effort and how many cells were refined; the angle is NaN and the effort
        `best` where nothing on the arc is below it.
    """
    cells = max(LEAST_EFFORT_CELLS, math.ceil((high - low) / EFFORT_CELL_RAD))
    count = min(cells, MOST_SAMPLES - 1) + 1
    spread(arc, low, high, count)
    sample_effort(task, arc, branch, count)
    angle, refined = math.nan, 0
    for n in range(count):
        if arc.efforts[n] < best:
            angle, best = arc.angles[n], arc.efforts[n]
    for k in range(count - 1):
        if least_in_cell(task, arc.joints, k, count) >= best:
            continue
        cusp = (k == 0 and low_cusp) or (k == count - 2 and high_cusp)
        smooth = not cusp and is_smooth(task, arc.joints, k, count)
        if smooth and valley(arc.efforts, k, count) >= best:
            continue
        refined += 1
        found, cost = refine_cell(task, cell, branch, arc.angles[k], arc.angles[k + 1], best)
        if cost < best:
            angle, best = found, cost
    return angle, best, refined


@kernel
def refine_cell(task, scratch, branch, low, high, best):
    """Angle and effort of the least effort between two angles, if below `best`."""
    stack = np.empty((EFFORT_STACK, 2))
    stack[0, 0], stack[0, 1] = low, high
    top, angle = 1, math.nan
    bounds, ends = np.empty(8), np.empty((6, 2))
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
            ends[:, 0], ends[:, 1] = scratch.joints[:, 0], scratch.joints[:, 2]
            for i in range(6):
                before = scratch.joints[i, 0] - task.numbers[REFERENCE + i]
                after = scratch.joints[i, 2] - task.numbers[REFERENCE + i]
                if (before < 0.0) != (after < 0.0):
                    found += 1
                    bounds[found] = -(i + 1)
            for n in range(1, found + 1):
                i = int(-bounds[n]) - 1
                reference = task.numbers[REFERENCE + i]
                before, after = ends[i, 0] - reference, ends[i, 1] - reference
                bounds[n] = kink(task, scratch, branch, i, a, before, b, after)
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
def kink(task, scratch, branch, joint, a, fa, b, fb):
    """Angle at which a joint passes its reference value (Illinois method).

    It is fa and fb from it at the angles a and b, on different sides.
    """
    c = a
    for _ in range(KINK_STEPS):
        if fa == fb:
            break
        c = b - fb * (b - a) / (fb - fa)
        fc = travel_at(task, scratch, branch, c, joint)
        if abs(fc) <= KINK_TRAVEL_RAD or abs(b - a) <= KINK_ANGLE_RAD:
            break
        if (fc < 0.0) != (fb < 0.0):
            a, fa = b, fb
        else:
            fa *= 0.5
        b, fb = c, fc
    return c


@kernel
def effort_at(task, scratch, branch, angle):
    """Effort at one angle."""
    scratch.angles[0] = angle
    sample_effort(task, scratch, branch, 1)
    return scratch.efforts[0]


@kernel
def smooth_minimum(task, scratch, branch, low, high):
    """Angle and effort of the least effort where effort is smooth between two angles.

    Both ends are candidates; between them only where effort falls at the lower and rises at the
    upper, and there by Brent's method: parabolas through the three lowest, golden section where
    they do not close in.
    """
    h = (high - low) * SLOPE_SHARE
    scratch.angles[0], scratch.angles[1] = low, low + h
    scratch.angles[2], scratch.angles[3] = high - h, high
    sample_effort(task, scratch, branch, 4)
    costs = scratch.efforts
    falls, rises = costs[1] < costs[0], costs[3] > costs[2]
    angle, best = (low, costs[0]) if costs[0] <= costs[3] else (high, costs[3])
    if not falls or not rises:
        return angle, best
    a, b = low, high
    x = w = v = a + _GOLDEN * (b - a)
    fx = fw = fv = effort_at(task, scratch, branch, x)
    step = last = b - a
    while max(x - a, b - x) > 2 * SMOOTH_MINIMUM_RAD:
        if 0.0 < max(fw, fv) - fx <= FLAT_EFFORT:
            break
        r, q = (x - w) * (fx - fv), (x - v) * (fx - fw)
        p = (x - v) * q - (x - w) * r
        q = 2.0 * (q - r)
        p, q = (-p, q) if q > 0.0 else (p, -q)
        before, last = last, step
        if abs(p) < abs(0.5 * q * before) and q * (a - x) < p < q * (b - x):
            step = p / q
        else:
            last = (a if x >= (a + b) / 2 else b) - x
            step = _GOLDEN * last
        u = x + (
            step if abs(step) > SMOOTH_MINIMUM_RAD else math.copysign(SMOOTH_MINIMUM_RAD, step)
        )
        fu = effort_at(task, scratch, branch, u)
        if fu <= fx:
            a, b = (x, b) if u >= x else (a, x)
            v, fv, w, fw, x, fx = w, fw, x, fx, u, fu
            continue
        a, b = (u, b) if u < x else (a, u)
        if fu <= fw or w == x:
            v, fv, w, fw = w, fw, u, fu
        elif fu <= fv or v in (x, w):
            v, fv = u, fu
    return (x, fx) if fx < best else (angle, best)
