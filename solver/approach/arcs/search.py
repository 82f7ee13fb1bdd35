"""Kernels: the feasible arcs of every branch of one target, from sampled margins and their roots.

One turn is cut into cells. A cell with a constraint that is negative at both ends, and that has no
maximum in between, is dead at once for the thinning posture alone, then for the standby posture,
then for the whole cut-in; few cells reach the last. There a constraint that changes sign has one
root, which is refined on its own row; a constraint that may have a maximum above zero, or a minimum
below, between the ends has the cell split at it. So a feasible arc is found however narrow it is,
as long as each single constraint is resolved by the cells; where a joint swings from cell to cell
(beside a straight wrist or the waist's axis) the cells are halved until it does not.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.arcs.cells import (
    ARC_NODES,
    CellState,
    any_cell_reached,
    close_cells,
    path_state,
)
from solver.approach.arcs.roots import (
    ARMS,
    tighten,
)
from solver.approach.arcs.splitting import JUMP_IN_CUT_IN, append_arc, settle
from solver.approach.arcs.turns import (
    CONSTRAINTS,
    path_margins,
    reaches_at_angles,
    turns_along_path,
    write_turns,
)
from solver.approach.task.constraints import JUMP, REACH, WHOLE_TURN
from solver.approach.tolerances import ARC_CELLS
from solver.compiled import kernel

_STEP = 2 * math.pi / ARC_CELLS
_ANGLES = -math.pi + _STEP * np.arange(ARC_CELLS + 1)
_ANGLES[-1] = math.pi
_NODES = np.concatenate(([math.pi - _STEP], _ANGLES, [_STEP - math.pi]))
_COSINES, _SINES = np.cos(_NODES), np.sin(_NODES)


@kernel
def find_arcs(task, scratch, arcs):
    """Feasible arcs of all branches into arcs, shape (MOST_ARCS, ARC_COLUMNS); returns how many."""
    open_up(task, scratch)
    count = 0
    for arm in range(ARMS):
        for wrist in range(2):
            start = count
            for k in range(ARC_CELLS):
                if scratch.open_cells[arm, wrist, k]:
                    state = cell_state(task, scratch, arm, wrist, k)
                    count = cell_pieces(
                        task, scratch, arm, wrist, k, state, arcs, start, count, math.inf
                    )
            count = close_turn(arcs, start, count)
    return count


@kernel
def open_up(task, scratch):
    """Scans the thinning and the standby posture of a new task: marks the cells that stay open."""
    scratch.open_cells[:] = True
    scratch.known_paths[:] = False
    scratch.known_margins[:] = False
    values, highest = scratch.values, scratch.highest
    for shoulder in range(2):
        reaches_at_angles(task, _COSINES, _SINES, shoulder, values)
        if not any_cell_reached(values, highest):
            scratch.open_cells[2 * shoulder : 2 * shoulder + 2] = False
            continue
        for arm in range(2 * shoulder, 2 * shoulder + 2):
            open_cells, thinning = scratch.open_cells[arm], scratch.thinning[arm]
            turns_at_nodes(task, 0.0, arm, thinning)
            if close_cells(task, thinning, values, highest, open_cells):
                turns_at_nodes(task, task.retreats[0], arm, scratch.standby)
                close_cells(task, scratch.standby, values, highest, open_cells)


@kernel
def turns_at_nodes(task, retreat, arm, turns):
    """Turns of one arm branch at all nodes of the turn, at one retreat."""
    turns[0], turns[1], turns[2] = _COSINES, _SINES, retreat
    write_turns(task, ARC_NODES, arm, turns)


@kernel
def know_path(task, arm, k, paths, known):
    """Turns along the cut-in at node k of one arm, computed when they are first asked for."""
    if not known[k]:
        turns_along_path(task, _ANGLES[k], arm, paths[k])
        known[k] = True


@kernel
def know_margins(task, wrist, k, paths, margins, known):
    """Smallest margins over that cut-in, computed when they are first asked for."""
    if not known[k]:
        path_margins(task, paths[k], wrist, margins[k])
        known[k] = True


@kernel
def cell_state(task, scratch, arm, wrist, k):
    """State of an open cell of one branch, from every constraint in every row."""
    paths, known_paths = scratch.paths[arm], scratch.known_paths[arm]
    margins, known_margins = scratch.margins[arm, wrist], scratch.known_margins[arm, wrist]
    outer, after, beyond = (k - 1) % ARC_CELLS, (k + 1) % ARC_CELLS, (k + 2) % ARC_CELLS
    for node in (outer, k, after, beyond):
        know_path(task, arm, node, paths, known_paths)
    for node in (k, after):
        know_margins(task, wrist, node, paths, margins, known_margins)
    state, _, _ = path_state(
        task, wrist, _STEP, paths[outer], paths[k], paths[after], paths[beyond],
        margins[k], margins[after],
    )  # fmt: skip
    return state


@kernel
def cell_pieces(task, scratch, arm, wrist, k, state, arcs, start, count, best):
    """Appends the feasible pieces of a cell of one branch, of that state; returns the new count.

    Parts of a cell in which effort is certainly not below `best` may be left out; with infinity
    none is, and no reference need be known.
    """
    low, high = _ANGLES[k], _ANGLES[k + 1]
    if state == CellState.DEAD:
        return count
    if state == CellState.FULL:
        return append_arc(arcs, start, count, arm, wrist, low, high, JUMP_IN_CUT_IN, JUMP_IN_CUT_IN)
    if state in (CellState.EDGE, CellState.CROSSED):
        after = (k + 1) % ARC_CELLS
        paths, margins = scratch.paths[arm], scratch.margins[arm, wrist]
        first, end = (REACH, JUMP) if state == CellState.EDGE else (0, CONSTRAINTS)
        clean, a, b, by_a, by_b = tighten(
            task, scratch, arm, wrist, first, end, low, high,
            paths[k], paths[after], margins[k], margins[after],
        )  # fmt: skip
        if clean and a >= b:
            return count
        if clean and state == CellState.CROSSED:
            return append_arc(arcs, start, count, arm, wrist, a, b, by_a, by_b)
        if clean:
            return settle(task, scratch, arm, wrist, a, b, by_a, by_b, arcs, start, count, best)
    by = JUMP_IN_CUT_IN
    return settle(task, scratch, arm, wrist, low, high, by, by, arcs, start, count, best)


@kernel
def close_turn(arcs, start, count):
    """Joins the arcs at both sides of the half turn into one that goes beyond it."""
    if count == start or arcs[start, 1] != _ANGLES[0] or arcs[count - 1, 2] != _ANGLES[-1]:
        return count
    if count == start + 1:
        arcs[start, 3] = arcs[start, 4] = WHOLE_TURN
        return count
    arcs[count - 1, 2] = arcs[start, 2] + 2 * math.pi
    arcs[count - 1, 4] = arcs[start, 4]
    for k in range(start, count - 1):
        arcs[k] = arcs[k + 1]
    return count - 1
