"""Kernels: branch and bound over the approach angle, for a proven bound on the least effort."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import heapq
import math

import numpy as np

from solver.approach.bounds.enclosure import enclosure, half_length
from solver.approach.bounds.intervals import (
    add,
    multiply,
    outward,
    scale,
    shifted,
    square,
    subtract,
)
from solver.approach.bounds.rates import too_fast
from solver.approach.bounds.tolerances import CERTIFICATE_PIECES, SUM_STEPS
from solver.approach.task.feasibility import effort, limit_margin, posture, tool_axes, trace
from solver.compiled import kernel
from solver.kinematics.straight_rates import posture_rate_room
from solver.problem.effort import joint_cost
from solver.tolerances import JOINT_RATE_RAD_M, LIMIT_EXCESS_RAD, REACH_ROUNDING_M

_TURN = 2 * math.pi
_HALF_TURN_ABOVE = math.nextafter(math.pi, 4.0)


@kernel
def turns_inside(task, joint, low, high):
    """First and last number of turns that bring an interval to the limits; first > last if none.

    Limits are those that the verifier accepts. An angle of which nothing is known has one turn.
    """
    if high - low >= _TURN:
        return 0, 0
    below = task.lower[joint] - LIMIT_EXCESS_RAD
    above = task.upper[joint] + LIMIT_EXCESS_RAD
    return math.ceil((below - high) / _TURN), math.floor((above - low) / _TURN)


@kernel
def excluded(task, q, reach):
    """Whether no posture in the intervals q, on any turns, holds: reach, limits, joint rates."""
    if reach < -REACH_ROUNDING_M or too_fast(task.geometry, q):
        return True
    for i in range(6):
        first, last = turns_inside(task, i, q[i, 0], q[i, 1])
        if first > last:
            return True
    return False


@kernel
def travel(task, joint, low, high, turn):
    """The least and most |q - reference| of a joint on one turn of an interval, inside limits."""
    below = task.lower[joint] - LIMIT_EXCESS_RAD - task.reference[joint]
    above = task.upper[joint] + LIMIT_EXCESS_RAD - task.reference[joint]
    first, last = shifted((low, high), turn * _TURN - task.reference[joint])
    return max(first, below, -last, -above, 0.0), max(abs(first), abs(last))


@kernel
def nearest_turn(task, joint, low, high, first, last):
    """The turn of least travel among first to last, that travel, and whether it is so everywhere.

    Everywhere: at all angles of the interval.
    """
    nearest, least, most, others = first, math.inf, math.inf, math.inf
    for turn in range(first, last + 1):
        shortest, longest = travel(task, joint, low, high, turn)
        if shortest < least:
            others = min(others, least)
            nearest, least, most = turn, shortest, longest
        else:
            others = min(others, shortest)
    return nearest, least, most <= others


@kernel
def least_effort_in_cell(task, half, turns, q, slopes, middle):
    """A lower bound on the effort of all postures of a cell that are inside the limits.

    The larger of two. One adds up every joint's least travel. The other is a line under the effort:
    joints that are on one side of their reference in the whole cell count with their sign, a joint
    that may pass it with any factor from -1 to 1, chosen so that the line is as level as can be;
    joints of which the turn or the angle is open count with their least travel.

    Args:
        task: a `CutInTask`.
        half: half the cell's length, rounded up [rad].
        turns: first and last turn of each joint that may be inside the limits, shape (6, 2).
        q: intervals of the thinning posture, shape (6, 2).
        slopes: their derivatives, shape (6, 2).
        middle: intervals at the middle of the cell, shape (6, 2).
    """
    plain, value, slope = 0.0, (0.0, 0.0), (0.0, 0.0)
    passing = np.zeros(6, dtype=np.bool_)
    change = np.empty((6, 2))
    for i in range(6):
        weight = task.weights[i]
        turn, least, certain = nearest_turn(task, i, q[i, 0], q[i, 1], turns[i, 0], turns[i, 1])
        cost = weight * joint_cost(least, task.squared)
        least_cost = outward(cost, cost, SUM_STEPS)[0]
        plain += least_cost
        if q[i, 1] - q[i, 0] >= math.pi or middle[i, 1] - middle[i, 0] >= math.pi or not certain:
            value = add(value, (least_cost, least_cost))
            continue
        shift = turn * _TURN - task.reference[i]
        across, here = (
            shifted((q[i, 0], q[i, 1]), shift),
            shifted((middle[i, 0], middle[i, 1]), shift),
        )
        change[i, 0], change[i, 1] = here
        rate = (slopes[i, 0], slopes[i, 1])
        if task.squared:
            value = add(value, scale(weight, square(here)))
            slope = add(slope, scale(2 * weight, multiply(across, rate)))
        elif across[0] >= 0.0:
            value, slope = add(value, scale(weight, here)), add(slope, scale(weight, rate))
        elif across[1] <= 0.0:
            value, slope = add(value, scale(-weight, here)), add(slope, scale(-weight, rate))
        else:
            passing[i] = True
    for i in range(6):
        pull = task.weights[i] * (slopes[i, 0] + slopes[i, 1])
        if passing[i] and pull != 0.0:
            factor = min(max(-(slope[0] + slope[1]) / pull, -1.0), 1.0) * task.weights[i]
            value = add(value, scale(factor, (change[i, 0], change[i, 1])))
            slope = add(slope, scale(factor, (slopes[i, 0], slopes[i, 1])))
    line = subtract(value, scale(half, (0.0, max(abs(slope[0]), abs(slope[1])))))[0]
    return max(outward(plain, plain, SUM_STEPS)[0], line, 0.0)


@kernel
def worst_row(task, angle, branch, rows):
    """The row of a traced cut-in furthest from holding, and whether that is so on every turn."""
    axes, q = np.empty((3, 3)), np.empty(6)
    tool_axes(task, angle, axes)
    worst, margin, on_every_turn = 0, math.inf, False
    for n in range(len(rows)):
        reach = posture(task, axes, task.retreats[n], branch, q)
        inside, joint = limit_margin(task, rows[n])
        room = posture_rate_room(task.geometry, rows[n])
        if min(min(reach, inside), room) < margin:
            worst, margin = n, min(min(reach, inside), room)
            first, last = turns_inside(task, joint, rows[n, joint], rows[n, joint])
            on_every_turn = reach < 0 or room < 0 or first > last
    return worst, on_every_turn


@kernel
def follow_cut_in(task, low, high, branch, turns, work):
    """Follows the cut-in row by row without turns between rows; True if it is certainly infeasible.

    A joint's intervals are kept within the travel from the row before that is no wrist jump. Takes
    from `turns`, shape (6, 2), those on which a joint breaks its limits at some row. `work` holds
    the thinning posture's intervals as `cell_bound` leaves them, and is overwritten.
    """
    before = work[3]
    before[:] = work[0]
    followed = np.ones(6, dtype=np.bool_)
    for n in range(len(task.retreats) - 2, -1, -1):
        reach = enclosure(task, low, high, task.retreats[n], branch, work[0], work[1], work[2])
        q = work[0]
        if excluded(task, q, reach):
            return True
        allowed = JOINT_RATE_RAD_M * (task.retreats[n] - task.retreats[n + 1]) + LIMIT_EXCESS_RAD
        for i in range(6):
            near = add((before[i, 0], before[i, 1]), (-allowed, allowed))
            before[i, 0], before[i, 1] = q[i, 0], q[i, 1]
            if allowed >= math.pi or near[1] - near[0] >= _TURN:
                followed[i] = False
                continue
            if q[i, 1] - q[i, 0] >= _TURN:
                before[i, 0], before[i, 1] = near
            else:
                first = math.ceil((near[0] - q[i, 1]) / _TURN)
                last = math.floor((near[1] - q[i, 0]) / _TURN)
                if first > last:
                    return True
                if first < last:
                    followed[i] = False
                    continue
                ends = shifted((q[i, 0], q[i, 1]), first * _TURN)
                before[i, 0], before[i, 1] = max(ends[0], near[0]), min(ends[1], near[1])
            if followed[i]:
                first, last = turns_inside(task, i, before[i, 0], before[i, 1])
                turns[i, 0], turns[i, 1] = max(turns[i, 0], first), min(turns[i, 1], last)
                if turns[i, 0] > turns[i, 1]:
                    return True
    return False


@kernel
def cell_bound(task, low, high, branch, turns, work):
    """A lower bound on the effort in a cell by its thinning postures; infinity if there are none.

    Writes the turns that may be inside the limits, shape (6, 2).
    """
    q, slopes, middle = work[0], work[1], work[2]
    reach = enclosure(task, low, high, 0.0, branch, q, slopes, middle)
    if excluded(task, q, reach):
        return math.inf
    for i in range(6):
        turns[i, 0], turns[i, 1] = turns_inside(task, i, q[i, 0], q[i, 1])
    half = half_length(low, high)
    return least_effort_in_cell(task, half, turns, q, slopes, middle)


@kernel
def examine(task, low, high, branch, known, gap, rows, work):
    """A cell's bound, infinity where it has no feasible approach, and the least effort known then.

    The cut-in is looked at only where the thinning postures do not close the cell: at its row that
    is worst in the middle of the cell, and row by row where that cannot tell.
    """
    turns = np.empty((6, 2), dtype=np.int64)
    bound = cell_bound(task, low, high, branch, turns, work)
    if bound >= known * (1 - gap):
        return bound, known
    open_turn = False
    for i in range(6):
        open_turn = open_turn or turns[i, 0] < turns[i, 1]
    if trace(task, (low + high) / 2, branch, task.retreats, rows) >= 0:
        known = min(known, effort(task, rows[-1]))
        if not open_turn:
            return bound, known
    else:
        n, on_every_turn = worst_row(task, (low + high) / 2, branch, rows)
        reach = enclosure(task, low, high, task.retreats[n], branch, work[0], work[1], work[2])
        if excluded(task, work[0], reach):
            return math.inf, known
        if on_every_turn:
            return bound, known
    q, slopes, middle = work[0], work[1], work[2]
    enclosure(task, low, high, 0.0, branch, q, slopes, middle)
    thinning_work = work.copy()
    if follow_cut_in(task, low, high, branch, turns, work):
        return math.inf, known
    half = half_length(low, high)
    q, slopes, middle = thinning_work[0], thinning_work[1], thinning_work[2]
    return max(bound, least_effort_in_cell(task, half, turns, q, slopes, middle)), known


@kernel
def prove(task, incumbent, gap, most_cells):
    """The least effort of a task with the tool on one side, bounded from below.

    Best first: the cell with the lowest bound is halved, until that bound is within `gap` of the
    least effort known, or `most_cells` have been looked at. The lowest bound is valid at any time.

    Args:
        task: a `CutInTask`.
        incumbent: an effort that is known to be possible, infinity if none is.
        gap: relative distance from the least effort known that is near enough.
        most_cells: budget.

    Returns:
        The bound (infinity: no approach is feasible), the least effort known, the cells looked at,
        and whether the search was finished within its budget.
    """
    rows, work = np.empty((len(task.retreats), 6)), np.empty((4, 6, 2))
    edges = np.linspace(-_HALF_TURN_ABOVE, _HALF_TURN_ABOVE, CERTIFICATE_PIECES + 1)
    heap = [(0.0, edges[k], edges[k + 1], 0) for k in range(0)]
    cells, known = 0, incumbent
    for branch in range(8):
        for k in range(CERTIFICATE_PIECES):
            bound, known = examine(task, edges[k], edges[k + 1], branch, known, gap, rows, work)
            cells += 1
            if bound < math.inf:
                heapq.heappush(heap, (bound, edges[k], edges[k + 1], branch))
    while heap:
        bound, low, high, branch = heap[0]
        if bound >= known * (1 - gap):
            return bound, known, cells, True
        middle = (low + high) / 2
        if cells >= most_cells or not low < middle < high:
            return bound, known, cells, False
        heapq.heappop(heap)
        for half in range(2):
            first, last = (low, middle) if half == 0 else (middle, high)
            found, known = examine(task, first, last, branch, known, gap, rows, work)
            cells += 1
            if found < math.inf:
                heapq.heappush(heap, (max(bound, found), first, last, branch))
    return math.inf, known, cells, True
