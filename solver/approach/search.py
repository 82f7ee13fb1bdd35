"""Kernels: bracketing the ends of feasible arcs and the least effort on them."""

import math

import numpy as np

from solver.approach.feasibility import effort, evaluate, thinning
from solver.compiled import kernel
from solver.tolerances import ANGLE_STEP_RAD, ARC_END_RAD, NEAR_FEASIBLE_RAD

_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


@kernel
def arc_end(task, branch, feasible, infeasible, rows):
    """The last feasible angle between a feasible and an infeasible one."""
    while abs(feasible - infeasible) > ARC_END_RAD:
        middle = (feasible + infeasible) / 2
        if middle in (feasible, infeasible):
            break
        if evaluate(task, middle, branch, rows)[0] >= 0:
            feasible = middle
        else:
            infeasible = middle
    return feasible


@kernel
def extreme_margin(task, branch, low, high, sign, rows):
    """Golden section for the largest (sign 1) or smallest (-1) margin; stops where it crosses 0."""
    a, b = low, high
    x1, x2 = b - _GOLDEN * (b - a), a + _GOLDEN * (b - a)
    f1 = sign * evaluate(task, x1, branch, rows)[0]
    f2 = sign * evaluate(task, x2, branch, rows)[0]
    while b - a > ANGLE_STEP_RAD:
        crossed = max(f1, f2) >= 0 if sign > 0 else max(f1, f2) > 0
        if crossed:
            break
        if f1 >= f2:
            b, x2, f2 = x2, x1, f1
            x1 = b - _GOLDEN * (b - a)
            f1 = sign * evaluate(task, x1, branch, rows)[0]
        else:
            a, x1, f1 = x1, x2, f2
            x2 = a + _GOLDEN * (b - a)
            f2 = sign * evaluate(task, x2, branch, rows)[0]
    if f1 >= f2:
        return x1, sign * f1
    return x2, sign * f2


@kernel
def branch_marks(task, branch, angles, margins, rows):
    """Angles in ascending order over one turn that bracket every change of feasibility found.

    The samples themselves and, between them, narrow maxima of the margin above zero and narrow
    minima below it. Returns the angles and whether each is feasible.
    """
    n = len(angles)
    marks = np.empty(3 * n)
    feasible = np.empty(3 * n, dtype=np.bool_)
    count = 0
    step = 2 * math.pi / n
    for k in range(n):
        before, here, after = margins[(k - 1) % n], margins[k], margins[(k + 1) % n]
        found, value = angles[k], here
        if here < 0 and here > -NEAR_FEASIBLE_RAD and here >= before and here >= after:
            found, value = extreme_margin(
                task, branch, angles[k] - step, angles[k] + step, 1.0, rows
            )
        elif here >= 0 and here < NEAR_FEASIBLE_RAD and here <= before and here <= after:
            found, value = extreme_margin(
                task, branch, angles[k] - step, angles[k] + step, -1.0, rows
            )
        crossed = (value >= 0) != (here >= 0)
        if crossed and found < angles[k]:
            marks[count], feasible[count] = found, value >= 0
            count += 1
        marks[count], feasible[count] = angles[k], here >= 0
        count += 1
        if crossed and found > angles[k]:
            marks[count], feasible[count] = found, value >= 0
            count += 1
    return marks[:count], feasible[:count]


@kernel
def feasible_arcs(task, angles, margins):
    """Feasible arcs of all branches, shape (arcs, 3): branch, lower and upper angle.

    `margins` are those of `sample` at `angles`, evenly spaced over one turn. An arc across the end
    of the turn has its upper angle beyond it; an arc that is the whole turn is as long as one.
    """
    rows = np.empty((len(task.retreats), 6))
    arcs = np.empty((0, 3))
    for branch in range(8):
        if margins[branch].max() < -NEAR_FEASIBLE_RAD:
            continue
        marks, feasible = branch_marks(task, branch, angles, margins[branch], rows)
        n = len(marks)
        if feasible.all():
            whole = np.array([[branch, marks[0], marks[0] + 2 * math.pi]])
            arcs = np.concatenate((arcs, whole))
            continue
        for k in range(n):
            if not feasible[k] or feasible[(k - 1) % n]:
                continue
            before = marks[k - 1] if k > 0 else marks[n - 1] - 2 * math.pi
            lower = arc_end(task, branch, marks[k], before, rows)
            last = k
            while feasible[(last + 1) % n]:
                last += 1
            after = marks[(last + 1) % n] + 2 * math.pi * ((last + 1) // n)
            upper = arc_end(task, branch, marks[last % n] + 2 * math.pi * (last // n), after, rows)
            arcs = np.concatenate((arcs, np.array([[branch, lower, upper]])))
    return arcs


@kernel
def cost_at(task, branch, angle, q):
    """Effort of the thinning posture at an angle; q is scratch and holds the posture afterwards."""
    thinning(task, angle, branch, q)
    return effort(task, q)


@kernel
def golden_effort(task, branch, low, high, q):
    """Angle of a local minimum of the effort between two angles."""
    a, b = low, high
    x1, x2 = b - _GOLDEN * (b - a), a + _GOLDEN * (b - a)
    f1, f2 = cost_at(task, branch, x1, q), cost_at(task, branch, x2, q)
    while b - a > ANGLE_STEP_RAD:
        if f1 <= f2:
            b, x2, f2 = x2, x1, f1
            x1 = b - _GOLDEN * (b - a)
            f1 = cost_at(task, branch, x1, q)
        else:
            a, x1, f1 = x1, x2, f2
            x2 = a + _GOLDEN * (b - a)
            f2 = cost_at(task, branch, x2, q)
    return (a + b) / 2


@kernel
def kink(task, branch, low, high, joint, q):
    """Angle between two where a joint passes its reference value; it does so between them."""
    thinning(task, low, branch, q)
    below = q[joint] < task.reference[joint]
    while high - low > ANGLE_STEP_RAD:
        middle = (low + high) / 2
        thinning(task, middle, branch, q)
        if (q[joint] < task.reference[joint]) == below:
            low = middle
        else:
            high = middle
    return (low + high) / 2


@kernel
def least_effort(task, branch, lower, upper, pieces):
    """Angle and effort of the least effort on one feasible arc.

    The arc is cut into `pieces` at least; where a sample is not above its neighbours a golden
    section refines it, and every kink of the l1 norm between samples is a candidate, as are both
    ends. Returns angle, effort and the number of efforts refined.
    """
    q, q_after = np.empty(6), np.empty(6)
    n = pieces + 1
    angles = np.linspace(lower, upper, n)
    costs = np.empty(n)
    for k in range(n):
        costs[k] = cost_at(task, branch, angles[k], q)
    best = int(np.argmin(costs))
    best_angle, best_cost, refined = angles[best], costs[best], 0
    for k in range(n):
        before, after = max(k - 1, 0), min(k + 1, n - 1)
        if costs[k] <= costs[before] and costs[k] <= costs[after]:
            angle = golden_effort(task, branch, angles[before], angles[after], q)
            cost = cost_at(task, branch, angle, q)
            refined += 1
            if cost < best_cost:
                best_angle, best_cost = angle, cost
    if task.squared:
        return best_angle, best_cost, refined
    for k in range(n - 1):
        thinning(task, angles[k], branch, q)
        thinning(task, angles[k + 1], branch, q_after)
        for joint in range(6):
            here = q[joint] < task.reference[joint]
            if here != (q_after[joint] < task.reference[joint]):
                angle = kink(task, branch, angles[k], angles[k + 1], joint, np.empty(6))
                cost = cost_at(task, branch, angle, np.empty(6))
                refined += 1
                if cost < best_cost:
                    best_angle, best_cost = angle, cost
    return best_angle, best_cost, refined
