"""Kernels: how fast the joints of any serial chain turn while its tool goes straight ahead.

From its Jacobian, without a closed form and without branches. Rates are those for a unit of tool
travel along the tool's z axis: rad/m for joints that turn, m/m for those that slide.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import numpy as np

from solver.compiled import kernel
from solver.kinematics.numerical import (
    chain_of,
    fill_jacobian,
    follow_with,
    free_joints,
    locate,
    solve_gram,
)
from solver.kinematics.tolerances import RATE_MISSED, RATE_PIECES, RATE_ZOOMS
from solver.robots.model import Array, Robot, Tool
from solver.tolerances import LEAST_DIVISOR


def rates_behind(robot: Robot, tool: Tool, rows: Array) -> Array:
    """How fast joints turn or slide in a cut-in of `postures_behind`, for a unit of tool travel.

    From the Jacobian's columns of the joints that move there, those chosen at the last row.

    Args:
        robot: any arm.
        tool: its tool.
        rows: postures of the cut-in, thinning last, shape (k, n) [rad or m].

    Returns:
        Magnitudes, shape (k, n) [rad/m or m/m]; as good as infinite where the arm is
        singular.
    """
    rates = np.empty(rows.shape)
    rates_of_rows(chain_of(robot, tool), np.ascontiguousarray(rows), rates)
    return rates


@kernel
def rates_of_rows(chain, rows, rates):
    """Writes `rates_behind` of rows, shape (k, n) both."""
    n = rows.shape[1]
    frames, columns = np.empty((n + 1, 4, 4)), np.empty((6, n))
    locate(chain, rows[-1], frames)
    free = free_joints(chain, frames, columns)
    for k in range(len(rows)):
        rates_at(chain, rows[k], free, frames, columns, rates[k])


@kernel
def rates_at(chain, q, free, frames, columns, rates):
    """Writes the rates in one posture, shape (n,); returns the largest of a joint that turns.

    The least squares solution of J rates = straight ahead, with the joints that are free. Where
    it does not lead straight ahead, as the arm is singular, rates are as good as infinite. Frames
    and columns are scratch.
    """
    n = len(q)
    locate(chain, q, frames)
    fill_jacobian(chain, frames, columns)
    # What stands still has an equation of its own, rate = 0.
    gram, right, solution = np.empty((n, n)), np.empty(n), np.empty(n)
    for i in range(n):
        right[i] = 0.0
        for row in range(3):
            right[i] += free[i] * columns[row, i] * frames[n, row, 2]
        for j in range(i + 1):
            gram[i, j] = 1.0 - free[i] if i == j else 0.0
            for row in range(6):
                gram[i, j] += free[i] * columns[row, i] * free[j] * columns[row, j]
    solve_gram(gram, right, solution)
    leads_ahead = True
    for row in range(6):
        left = frames[n, row, 2] if row < 3 else 0.0
        for i in range(n):
            left -= free[i] * columns[row, i] * solution[i]
        # Not met by what is not a number, where the solution overflows.
        leads_ahead = leads_ahead and abs(left) <= RATE_MISSED
    fastest = 0.0
    for i in range(n):
        rates[i] = abs(solution[i]) if leads_ahead else free[i] / LEAST_DIVISOR
        fastest = max(fastest, chain.turning[i] * rates[i])
    return fastest


@kernel
def turned(chain, before, after):
    """The largest difference of a joint that turns between two postures [rad]."""
    largest = 0.0
    for i in range(len(before)):
        largest = max(largest, chain.turning[i] * abs(before[i] - after[i]))
    return largest


@kernel
def fastest_on_paths(chain, paths, standoff, count, screened):
    """The largest rate of a joint that turns anywhere on n cut-ins, shape (n,) [rad/m].

    Where joints turn little from row to row, that travel over the distance is returned.

    Args:
        chain: the arm.
        paths: evenly spaced rows, standby first, shape (n, rows, joints).
        standoff: length of the cut-ins [m].
        count: so many rows lie close enough to tell by what joints turn between them whether one
            has to be looked at in between.
        screened: rate from row to row up to which it has not [rad/m].
    """
    n = paths.shape[2]
    frames, columns = np.empty((n + 1, 4, 4)), np.empty((6, n))
    scratch, found = np.empty(n), np.empty(len(paths))
    rows_given = paths.shape[1]
    for p in range(len(paths)):
        path = paths[p]
        locate(chain, path[-1], frames)
        free = free_joints(chain, frames, columns)
        fastest = 0.0
        for k in range(rows_given - 1):
            travel = turned(chain, path[k], path[k + 1]) * (rows_given - 1) / standoff
            fastest = max(fastest, travel)
        # At the ends a joint may be fast and yet turn little, where it is on its way into a swing.
        fastest = max(fastest, rates_at(chain, path[0], free, frames, columns, scratch))
        fastest = max(fastest, rates_at(chain, path[-1], free, frames, columns, scratch))
        if rows_given < count or fastest > screened:
            behind = fastest_behind(chain, path[-1], free, standoff, count, screened)
            fastest = max(fastest, behind)
        found[p] = fastest
    return found


@kernel
def fastest_behind(chain, thinning, free, standoff, count, screened):
    """The largest rate straight behind a thinning posture, by postures of its own [rad/m].

    Between rows that joints turn little between, that travel over the distance; elsewhere that in
    postures between them, closed in on around the fastest.
    """
    n, spacing = len(thinning), standoff / (count - 1)
    frames, columns, scratch = np.empty((n + 1, 4, 4)), np.empty((6, n)), np.empty(n)
    locate(chain, thinning, frames)
    position, axes = frames[n, :3, 3].copy(), frames[n, :3, :3].copy()
    rows = np.empty((count, n))
    rows[-1] = thinning
    retreats = np.linspace(standoff, 0.0, count)
    follow_with(chain, position, axes, free, retreats, rows)
    pieces = np.empty((RATE_PIECES + 1, n))
    near, fastest, rate_there = thinning.copy(), 0.0, -1.0
    begin, end = 0.0, 0.0
    for k in range(count - 1):
        travel = turned(chain, rows[k], rows[k + 1]) / spacing
        fastest = max(fastest, travel)
        if travel <= screened:
            continue
        pieces[-1] = rows[k + 1]
        between = np.linspace(retreats[k], retreats[k + 1], RATE_PIECES + 1)
        follow_with(chain, position, axes, free, between, pieces)
        for i in range(RATE_PIECES + 1):
            rate = rates_at(chain, pieces[i], free, frames, columns, scratch)
            if rate > rate_there:
                rate_there = rate
                begin, end = between[max(i - 1, 0)], between[min(i + 1, RATE_PIECES)]
                near[:] = pieces[min(i + 1, RATE_PIECES)]
    for _ in range(RATE_ZOOMS):
        if rate_there < 0.0:
            break
        pieces[-1] = near
        between = np.linspace(begin, end, RATE_PIECES + 1)
        follow_with(chain, position, axes, free, between, pieces)
        best, highest = 0, -1.0
        for i in range(RATE_PIECES + 1):
            rate = rates_at(chain, pieces[i], free, frames, columns, scratch)
            if rate > highest:
                highest, best = rate, i
        rate_there = max(rate_there, highest)
        begin, end = between[max(best - 1, 0)], between[min(best + 1, RATE_PIECES)]
        near[:] = pieces[min(best + 1, RATE_PIECES)]
    return max(fastest, rate_there)
