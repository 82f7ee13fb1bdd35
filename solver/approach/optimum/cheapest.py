"""Kernels: the least effort of one target over all branches, without all of its arcs.

Cells of the approach angle that may hold feasible pieces are looked at in the order of what effort
is at least in them; when none can be below the best found, the rest need no exact ends.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple

import numpy as np

from solver.approach.arcs.cells import enters_reach
from solver.approach.arcs.roots import ARMS, ArcScratch, arc_scratch
from solver.approach.arcs.search import cell_pieces, open_up
from solver.approach.arcs.splitting import ARC_COLUMNS, MOST_ARCS
from solver.approach.arcs.turns import wrist_sign
from solver.approach.optimum.effort_samples import EffortScratch, effort_scratch
from solver.approach.optimum.search import least_effort
from solver.approach.task.constraints import BESIDE, REACH
from solver.approach.task.packed import REFERENCE, SQUARED, WEIGHTS, unpack_geometry
from solver.approach.tolerances import ARC_CELLS, CELL_SWING_COSINE
from solver.compiled import NONE_YET, inlined, kernel
from solver.kinematics.arctangent import atan2
from solver.problem.effort import joint_cost
from solver.robots.model import Array


class CheapestScratch(NamedTuple):
    """Working memory of the kernels, one for a thread; nothing in it outlives a call."""

    arcs: ArcScratch
    samples: EffortScratch
    cell: EffortScratch
    pieces: Array
    cells: Array
    bounds: Array
    reference: Array


@kernel
def cheapest_scratch(rows):
    """Working memory for cut-ins of that many rows."""
    most = 2 * ARMS * ARC_CELLS
    return CheapestScratch(
        arc_scratch(rows), effort_scratch(rows), effort_scratch(rows),
        np.empty((MOST_ARCS, ARC_COLUMNS)), np.empty((most, 3), dtype=np.int64),
        np.empty(most), np.empty((6, 2)),
    )  # fmt: skip


@kernel
def cheapest(task, scratch, best):
    """Angle, branch and effort of the least effort below `best`, and how many cells were refined.

    The angle is NaN and the branch -1 where no feasible approach is below `best`.
    """
    arcs, samples, cell = scratch.arcs, scratch.samples, scratch.cell
    cells, bounds, pieces = scratch.cells, scratch.bounds, scratch.pieces
    open_up(task, arcs)
    waiting = list_open_cells(
        task, arcs.open_cells, arcs.thinning, scratch.reference, cells, bounds
    )
    angle, branch, work = math.nan, -1, 0
    while take_cheapest(cells, bounds, waiting, best):
        waiting -= 1
        arm, wrist, k = cells[waiting]
        own = 2 * arm + wrist
        for n in range(cell_pieces(task, arcs, arm, wrist, k, pieces, NONE_YET, NONE_YET)):
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
    bounds[first], cells[first] = bounds[last], cells[last]
    cells[last, 0], cells[last, 1], cells[last, 2] = arm, wrist, k
    return True


@inlined
def at_cusp(constraint):
    """Whether what ends a piece is the edge of reach, where joints have a cusp."""
    return constraint in (REACH, BESIDE)


@kernel
def list_open_cells(task, open_cells, thinning, reference, cells, bounds):
    """Lists arm, wrist and number of the open cells, and what effort is at least in each.

    Returns how many there are; the last three arrays are written.
    """
    offsets = unpack_geometry(task.numbers).offsets
    for i in range(6):
        theta = task.numbers[REFERENCE + i] + offsets[i]
        reference[i, 0], reference[i, 1] = math.cos(theta), math.sin(theta)
    count = 0
    for arm in range(ARMS):
        for wrist in range(2):
            for k in range(ARC_CELLS):
                if open_cells[arm, wrist, k]:
                    cells[count, 0], cells[count, 1], cells[count, 2] = arm, wrist, k
                    bounds[count] = effort_at_least(task, thinning[arm], reference, wrist, k)
                    count += 1
    return count


@inlined
def angle_of_cosine(cosine):
    """The angle between two directions, from its cosine [rad]."""
    return atan2(math.sqrt(max((1.0 - cosine) * (1.0 + cosine), 0.0)), cosine)


@kernel
def effort_at_least(task, turns, reference, wrist, k):
    """What effort is at least in a cell of the turn.

    A joint may leave the range between the cell's ends by half of what it turns next to it, by all
    of it where the arm enters its reach; nothing is said of one that swings. A joint of more than
    one turn counts by its nearest.

    Args:
        task: the packed task.
        turns: of the thinning posture at all nodes, shape (TURN_ROWS, ARC_NODES).
        reference: cosine and sine of each joint of the reference, shape (6, 2).
        wrist: 0 or 1.
        k: number of the cell.
    """
    slack = 1.0 if enters_reach(turns, k + 1, turns, k + 2) else 0.5
    total = 0.0
    for i in range(6):
        c, s = turns[2 * i], turns[2 * i + 1]
        inside = c[k + 1] * c[k + 2] + s[k + 1] * s[k + 2]
        if inside < CELL_SWING_COSINE:
            continue
        before = c[k] * c[k + 1] + s[k] * s[k + 1]
        after = c[k + 2] * c[k + 3] + s[k + 2] * s[k + 3]
        beside = angle_of_cosine(min(inside, before, after))
        cos = wrist_sign(wrist, i, True) * reference[i, 0]
        sin = wrist_sign(wrist, i, False) * reference[i, 1]
        nearest = max(c[k + 1] * cos + s[k + 1] * sin, c[k + 2] * cos + s[k + 2] * sin)
        least = max(angle_of_cosine(nearest) - slack * beside, 0.0)
        total += task.numbers[WEIGHTS + i] * joint_cost(least, task.numbers[SQUARED] > 0.0)
    return total
