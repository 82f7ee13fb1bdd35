"""Kernels: the parts of feasible arcs at which a target may move as far as is asked for.

Whether it may is looked at closely only where it is in doubt: where limits are much nearer, or much
further, to first order, that decides. Rows of a cut-in have one orientation, so what is near one of
them is further from another by no more than the two are apart, and most need not be looked at.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple

import numpy as np

from solver.approach.task.constraints import LIMITS
from solver.approach.task.feasibility import choose_packed_turns
from solver.approach.task.packed import (
    LOWER,
    UPPER,
    PackedTask,
    tool_place,
    unpack_circle,
    unpack_geometry,
)
from solver.approach.tolerances import LEAST_EFFORT_CELLS
from solver.approach.uncertainty.displacement import rows_displacement_margin
from solver.approach.uncertainty.nearest_limit import first_order
from solver.approach.uncertainty.tolerances import (
    BORNE_EXCESS_M,
    EXTREME_STEPS,
    ROBUST_ANGLE_RAD,
    ROBUST_CELL_RAD,
    ROOT_SHARE,
    ROOT_STEPS,
    SCREENED_DISTANCES,
)
from solver.compiled import kernel
from solver.kinematics.spherical_wrist import pose_branch, wrap
from solver.robots.model import Array

MOST_PARTS = 64

_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


class RobustWork(NamedTuple):
    """Working memory of the kernels, one for a thread; nothing in it outlives a call."""

    rows: Array
    pose: Array
    rates: Array
    reach_rates: Array
    distances: Array
    parts: Array


@kernel
def robust_work(rows):
    """Working memory for cut-ins of that many rows."""
    return RobustWork(
        np.empty((rows, 6)), np.zeros((4, 4)), np.empty((6, 4)), np.empty(4), np.empty(LIMITS),
        np.empty((MOST_PARTS, 2)),
    )  # fmt: skip


@kernel
def write_cut_in(task, g, angle, branch, work):
    """Writes pose and rows of a cut-in to the working memory."""
    circle, rows, last = unpack_circle(task.numbers), work.rows, len(task.retreats) - 1
    cos, sin = math.cos(angle), math.sin(angle)
    for n in range(last, -1, -1):
        place, x, y, z = tool_place(circle, cos, sin, task.retreats[n])
        pose_branch(g, place, x, y, z, branch, rows[n])
        if n == last:
            for i in range(3):
                work.pose[i, 0], work.pose[i, 1] = x[i], y[i]
                work.pose[i, 2], work.pose[i, 3] = z[i], place[i]
            continue
        for i in range(6):
            rows[n, i] = rows[n + 1, i] + wrap(rows[n, i] - rows[n + 1, i])
    choose_packed_turns(task.numbers, rows)


@kernel
def margin_at(task, g, angle, branch, work):
    """The displacement margin of a feasible approach [m]."""
    write_cut_in(task, g, angle, branch, work)
    lower, upper = task.numbers[LOWER : LOWER + 6], task.numbers[UPPER : UPPER + 6]
    margin, _, _ = rows_displacement_margin(
        g, lower, upper, work.pose, task.retreats, branch, work.rows
    )
    return margin


@kernel
def excess(task, g, angle, branch, needed, work):
    """The displacement margin less what is needed [m]: exact near zero, else of the right sign."""
    write_cut_in(task, g, angle, branch, work)
    lower, upper = task.numbers[LOWER : LOWER + 6], task.numbers[UPPER : UPPER + 6]
    axes, retreats = np.ascontiguousarray(work.pose[:3, :3]), task.retreats
    least, looked_from = math.inf, math.inf
    for n in range(len(retreats)):
        if n < len(retreats) - 1 and retreats[n] > looked_from:
            continue
        first_order(
            g, lower, upper, work.rows[n], axes, work.rates, work.reach_rates, work.distances
        )
        own = work.distances.min()
        least = min(least, own)
        looked_from = retreats[n] - max(own / SCREENED_DISTANCES - needed, 0.0)
    if least * SCREENED_DISTANCES < needed or least > SCREENED_DISTANCES * needed:
        return least - needed
    margin, _, _ = rows_displacement_margin(g, lower, upper, work.pose, retreats, branch, work.rows)
    return margin - needed


@kernel
def robust_parts(task, g, branch, lower, upper, needed, work):
    """Writes the parts of a feasible arc whose displacement margin is at least `needed` [m].

    Sampled; narrow maxima below and narrow minima above what is needed are looked for between
    samples where the slopes beside them allow one, and every end is closed in on, from inside.

    Returns how many parts there are, in `work.parts`: lower and upper angles [rad].
    """
    n = max(LEAST_EFFORT_CELLS, math.ceil((upper - lower) / ROBUST_CELL_RAD)) + 1
    angles, values = np.linspace(lower, upper, n), np.empty(n)
    for k in range(n):
        values[k] = excess(task, g, angles[k], branch, needed, work)
    marks, heights, count = np.empty(2 * n), np.empty(2 * n), 0
    for k in range(n):
        here = values[k]
        before, after = values[max(k - 1, 0)], values[min(k + 1, n - 1)]
        sign = -1.0 if here >= 0 else 1.0
        found, value = angles[k], here
        is_extreme = sign * here >= sign * before and sign * here >= sign * after
        if is_extreme and abs(here) <= max(abs(before - here), abs(after - here)):
            found, value = extreme_excess(
                task,
                g,
                branch,
                angles[max(k - 1, 0)],
                angles[min(k + 1, n - 1)],
                sign,
                needed,
                work,
            )
        crossed = (value >= 0) != (here >= 0)
        if crossed and found < angles[k]:
            marks[count], heights[count] = found, value
            count += 1
        marks[count], heights[count] = angles[k], here
        count += 1
        if crossed and found > angles[k]:
            marks[count], heights[count] = found, value
            count += 1
    parts, first = 0, lower
    for k in range(count):
        if heights[k] < 0 or parts == MOST_PARTS:
            continue
        if k == 0 or heights[k - 1] < 0:
            first = marks[k]
            if k > 0:
                first = robust_end(
                    task,
                    g,
                    branch,
                    marks[k],
                    heights[k],
                    marks[k - 1],
                    heights[k - 1],
                    needed,
                    work,
                )
        if k == count - 1 or heights[k + 1] < 0:
            end = marks[k]
            if k < count - 1:
                end = robust_end(
                    task,
                    g,
                    branch,
                    marks[k],
                    heights[k],
                    marks[k + 1],
                    heights[k + 1],
                    needed,
                    work,
                )
            work.parts[parts, 0], work.parts[parts, 1] = first, end
            parts += 1
    return parts


@kernel
def extreme_excess(task, g, branch, low, high, sign, needed, work):
    """Golden section for the largest (sign 1) or smallest (-1) excess; ends where it crosses 0."""
    x1, x2 = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    f1 = sign * excess(task, g, x1, branch, needed, work)
    f2 = sign * excess(task, g, x2, branch, needed, work)
    for _ in range(EXTREME_STEPS):
        if max(f1, f2) > 0:
            break
        if f1 >= f2:
            high, x2, f2 = x2, x1, f1
            x1 = high - _GOLDEN * (high - low)
            f1 = sign * excess(task, g, x1, branch, needed, work)
        else:
            low, x1, f1 = x1, x2, f2
            x2 = low + _GOLDEN * (high - low)
            f2 = sign * excess(task, g, x2, branch, needed, work)
    return (x1, sign * f1) if f1 >= f2 else (x2, sign * f2)


@kernel
def robust_end(task, g, branch, inside, above, outside, below, needed, work):
    """The last robust angle between a robust one and one that is not (Illinois method).

    `above` and `below` are the excesses there [m].
    """
    rise, fall, moved = above, below, 0
    for _ in range(ROOT_STEPS):
        if abs(inside - outside) <= ROBUST_ANGLE_RAD or above <= BORNE_EXCESS_M:
            break
        # Aimed at half of what may be left, so that the search ends on the robust side.
        up, down = max(rise - BORNE_EXCESS_M / 2, 0.0), fall - BORNE_EXCESS_M / 2
        share = min(max(up / (up - down), ROOT_SHARE), 1.0 - ROOT_SHARE)
        angle = inside + share * (outside - inside)
        value = excess(task, g, angle, branch, needed, work)
        if value >= 0:
            inside, above, rise = angle, value, value
            fall = fall / 2 if moved == 1 else fall
            moved = 1
        else:
            outside, fall = angle, value
            rise = rise / 2 if moved == -1 else rise
            moved = -1
    return inside


@kernel
def parts_of_arcs(needed, numbers, retreats, cos_steps, sides, branches, lower, upper):
    """Robust parts of some arcs of one target, shape (parts, 3): the arc's place, and both ends.

    `numbers` are packed rows by tool side, shape (sides, NUMBERS); the arcs have shape (n,) each.
    """
    work = robust_work(len(retreats))
    table, count = np.empty((4 * len(branches) + MOST_PARTS, 3)), 0
    for n in range(len(branches)):
        task = PackedTask(numbers[sides[n]], retreats, cos_steps)
        g = unpack_geometry(task.numbers)
        own = robust_parts(task, g, branches[n], lower[n], upper[n], needed, work)
        if count + own > len(table):
            table = np.concatenate((table, np.empty_like(table)))
        for k in range(own):
            table[count, 0], table[count, 1:] = n, work.parts[k]
            count += 1
    return table[:count].copy()


@kernel
def most_borne(task, branch, lower, upper):
    """The angle of a feasible arc at which a target may move furthest [rad].

    Sampled, and closed in on beside the best sample.
    """
    g, work = unpack_geometry(task.numbers), robust_work(len(task.retreats))
    n = max(LEAST_EFFORT_CELLS, math.ceil((upper - lower) / ROBUST_CELL_RAD)) + 1
    angles, best, most = np.linspace(lower, upper, n), 0, -math.inf
    for k in range(n):
        margin = margin_at(task, g, angles[k], branch, work)
        if margin > most:
            best, most = k, margin
    where = angles[best]
    low, high = angles[max(best - 1, 0)], angles[min(best + 1, n - 1)]
    while high - low > ROBUST_ANGLE_RAD:
        x1, x2 = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        f1, f2 = margin_at(task, g, x1, branch, work), margin_at(task, g, x2, branch, work)
        if f1 >= f2:
            high = x2
        else:
            low = x1
        if max(f1, f2) > most:
            where, most = (x1 if f1 >= f2 else x2), max(f1, f2)
    return where


@kernel
def margin_of_approach(task, angle, branch):
    """The displacement margin of one feasible approach [m]."""
    work = robust_work(len(task.retreats))
    return margin_at(task, unpack_geometry(task.numbers), angle, branch, work)
