"""Kernel: the least effort among approaches that bear a displacement of the target.

The optimum without a margin is looked at first. Where it does not bear what is wished for, cells
are searched as for the optimum itself, in the order of what effort is at least in them, and only
those pieces in which effort may be lower are asked what they bear.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

from solver.approach.arcs.search import cell_pieces, cell_state, open_up
from solver.approach.optimum.cheapest import (
    at_cusp,
    cheapest_scratch,
    list_open_cells,
    take_cheapest,
)
from solver.approach.optimum.search import least_effort
from solver.approach.task.packed import PackedTask, unpack_geometry
from solver.approach.uncertainty.robust_parts import (
    excess,
    margin_at,
    robust_parts,
    robust_work,
)
from solver.compiled import NO, NONE_YET, kernel


@kernel
def cheapest_at_level(task, scratch, work, needed, best):
    """Angle, branch and effort of the least effort below `best` that bears `needed` [m].

    The angle is NaN and the branch -1 where there is none.
    """
    arcs, samples, cell = scratch.arcs, scratch.samples, scratch.cell
    cells, bounds, pieces = scratch.cells, scratch.bounds, scratch.pieces
    g = unpack_geometry(task.numbers)
    open_up(task, arcs)
    waiting = list_open_cells(task, arcs, cells, bounds)
    angle, branch = math.nan, -1
    while take_cheapest(cells, bounds, waiting, best):
        waiting -= 1
        arm, wrist, k = cells[waiting]
        own = 2 * arm + wrist
        state = cell_state(task, arcs, arm, wrist, k)
        found = cell_pieces(task, arcs, arm, wrist, k, state, pieces, NONE_YET, NONE_YET, best)
        for n in range(found):
            low, high = pieces[n, 1], pieces[n, 2]
            low_cusp, high_cusp = at_cusp(pieces[n, 3]), at_cusp(pieces[n, 4])
            where, cost, _ = least_effort(
                task, samples, cell, own, low, high, low_cusp, high_cusp, best
            )
            if not cost < best:
                continue
            if excess(task, g, where, own, needed, work) >= 0.0:
                angle, branch, best = where, own, cost
                continue
            for m in range(robust_parts(task, g, own, low, high, needed, work)):
                where, cost, _ = least_effort(
                    task, samples, cell, own, work.parts[m, 0], work.parts[m, 1],
                    NO, NO, best,
                )  # fmt: skip
                if cost < best:
                    angle, branch, best = where, own, cost
    return angle, branch, best


@kernel
def raise_margins(
    numbers, retreats, cos_steps, levels, angles, sides, branches, efforts, margins, moved
):
    """Replaces optima that bear less than they might by the cheapest that bear the most.

    Args:
        numbers: packed rows by tool side and target, shape (sides, n, NUMBERS).
        retreats: where cut-ins are planned, shape (rows,) [m].
        cos_steps: of a `PackedTask`, shape (rows - 1,).
        levels: displacement margins to try for each target, falling, shape (n, levels) [m].
        angles: of the optima, shape (n,), written, as all that follow [rad].
        sides: 1 or -1, shape (n,).
        branches: 0 to 7, shape (n,); -1 where there is none, or none bears the last level.
        efforts: shape (n,).
        margins: displacement margins, shape (n,) [m].
        moved: whether the optimum was replaced, shape (n,).
    """
    scratch, work = cheapest_scratch(len(retreats)), robust_work(len(retreats))
    for k in range(numbers.shape[1]):
        margins[k], moved[k] = math.nan, False
        if branches[k] < 0:
            continue
        task = PackedTask(numbers[(1 - sides[k]) // 2, k], retreats, cos_steps)
        g = unpack_geometry(task.numbers)
        margins[k] = margin_at(task, g, angles[k], branches[k], work)
        borne = False
        for needed in levels[k]:
            borne = margins[k] >= needed
            if borne:
                break
            best = math.inf
            for side in range(numbers.shape[0]):
                task = PackedTask(numbers[side, k], retreats, cos_steps)
                where, own, cost = cheapest_at_level(task, scratch, work, needed, best)
                if cost < best:
                    angles[k], branches[k], best = where, own, cost
                    sides[k] = 1 - 2 * side
            borne = best < math.inf
            if borne:
                efforts[k], moved[k] = best, True
                task = PackedTask(numbers[(1 - sides[k]) // 2, k], retreats, cos_steps)
                margins[k] = margin_at(task, g, angles[k], branches[k], work)
                break
        if not borne:
            branches[k] = -1
