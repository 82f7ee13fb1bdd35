"""Kernels: the least effort of one target over all branches, without all of its arcs.

Cells of the approach angle that may hold feasible pieces are looked at in the order of what effort
is at least in them; when none can be below the best found, the rest need no exact ends.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple

import numpy as np

from solver.approach.arcs.cells import CellState
from solver.approach.arcs.effort_bound import effort_at_least, write_reference
from solver.approach.arcs.roots import ARMS, ArcScratch, arc_scratch
from solver.approach.arcs.search import cell_pieces, cell_state, open_up
from solver.approach.arcs.splitting import ARC_COLUMNS, MOST_ARCS
from solver.approach.optimum.effort_samples import EffortScratch, effort_scratch
from solver.approach.optimum.search import least_effort
from solver.approach.task.constraints import BESIDE, REACH
from solver.approach.tolerances import ARC_CELLS
from solver.compiled import NONE_YET, inlined, kernel
from solver.robots.model import Array


class CheapestScratch(NamedTuple):
    """Working memory of the kernels, one for a thread; nothing in it outlives a call."""

    arcs: ArcScratch
    samples: EffortScratch
    cell: EffortScratch
    pieces: Array
    cells: Array
    bounds: Array
    later: Array
    later_bounds: Array


@kernel
def cheapest_scratch(rows):
    """Working memory for cut-ins of that many rows."""
    most = 2 * ARMS * ARC_CELLS
    return CheapestScratch(
        arc_scratch(rows), effort_scratch(rows), effort_scratch(rows),
        np.empty((MOST_ARCS, ARC_COLUMNS)), np.empty((most, 3), dtype=np.int64),
        np.empty(most), np.empty((most, 3), dtype=np.int64), np.empty(most),
    )  # fmt: skip


@kernel
def cheapest(task, scratch, best):
    """Angle, branch and effort of the least effort below `best`, and how many cells were refined.

    The angle is NaN and the branch -1 where no feasible approach is below `best`.
    """
    arcs, samples, cell = scratch.arcs, scratch.samples, scratch.cell
    cells, bounds, pieces = scratch.cells, scratch.bounds, scratch.pieces
    open_up(task, arcs)
    later, later_bounds = scratch.later, scratch.later_bounds
    waiting, put_off = list_open_cells(task, arcs, cells, bounds), 0
    angle, branch, work = math.nan, -1, 0
    # Cells that have to be split last: the better the best found, the less of them is looked at.
    for last in (False, True):
        if last:
            cells, bounds, waiting = later, later_bounds, put_off
        while take_cheapest(cells, bounds, waiting, best):
            waiting -= 1
            arm, wrist, k = cells[waiting]
            own, state = 2 * arm + wrist, cell_state(task, arcs, arm, wrist, k)
            if not last and (state == CellState.EXTREME or state == CellState.EDGE):
                later[put_off, 0], later[put_off, 1], later[put_off, 2] = arm, wrist, k
                later_bounds[put_off] = bounds[waiting]
                put_off += 1
                continue
            found = cell_pieces(task, arcs, arm, wrist, k, state, pieces, NONE_YET, NONE_YET, best)
            for n in range(found):
                low, high = pieces[n, 1], pieces[n, 2]
                low_cusp, high_cusp = at_cusp(pieces[n, 3]), at_cusp(pieces[n, 4])
                where, cost, looked = least_effort(
                    task, samples, cell, own, low, high, low_cusp, high_cusp, best
                )
                work += looked
                if cost < best:
                    angle, branch, best = where, own, cost
    return angle, branch, best, work


@kernel
def take_cheapest(cells, bounds, waiting, best):
    """Puts the cell of the lowest bound last of those waiting; whether that is below `best`."""
    if waiting == 0:
        return False
    first = 0
    for n in range(1, waiting):
        if bounds[n] < bounds[first]:
            first = n
    if bounds[first] >= best:
        return False
    last = waiting - 1
    arm, wrist, k = cells[first]
    cells[first] = cells[last]
    cells[last, 0], cells[last, 1], cells[last, 2] = arm, wrist, k
    bounds[first], bounds[last] = bounds[last], bounds[first]
    return True


@inlined
def at_cusp(constraint):
    """Whether what ends a piece is the edge of reach, where joints have a cusp."""
    return constraint in (REACH, BESIDE)


@kernel
def list_open_cells(task, arcs, cells, bounds):
    """Lists arm, wrist and number of the cells that `open_up` left open, and their least efforts.

    Returns how many there are; `cells`, `bounds` and the reference in `arcs` are written.
    """
    write_reference(task, arcs.reference)
    count = 0
    for arm in range(ARMS):
        turns = arcs.thinning[arm]
        for wrist in range(2):
            for k in range(ARC_CELLS):
                if arcs.open_cells[arm, wrist, k]:
                    cells[count, 0], cells[count, 1], cells[count, 2] = arm, wrist, k
                    bounds[count] = effort_at_least(
                        task, arcs.reference, wrist, turns, k, turns, k + 1, turns, k + 2,
                        turns, k + 3,
                    )  # fmt: skip
                    count += 1
    return count
