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
    CELL_SLOTS,
    extreme_margin,
    root,
    single_margin,
    tighten,
)
from solver.approach.arcs.tolerances import (
    CELL_STACK,
    EXTREME_ANGLE_RAD,
    NARROWEST_ARC_RAD,
    NARROWEST_CELL_RAD,
    SAME_ANGLE_RAD,
)
from solver.approach.arcs.turns import (
    CONSTRAINTS,
    path_margins,
    reaches_at_angles,
    row_margin,
    turns_along_path,
    write_turns,
)
from solver.approach.task.constraints import JUMP, REACH, WHOLE_TURN
from solver.approach.tolerances import ARC_CELLS
from solver.compiled import kernel

MOST_ARCS = 64
ARC_COLUMNS = 5
"""Columns of an arc: branch, lower and upper angle [rad], the constraint that ends it at each
(WHOLE_TURN where none does)."""

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
                    count = cell_pieces(task, scratch, arm, wrist, k, arcs, start, count)
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
def cell_pieces(task, scratch, arm, wrist, k, arcs, start, count):
    """Appends the feasible pieces of an open cell of one branch; returns the new count."""
    paths, known_paths = scratch.paths[arm], scratch.known_paths[arm]
    margins, known_margins = scratch.margins[arm, wrist], scratch.known_margins[arm, wrist]
    outer, after, beyond = (k - 1) % ARC_CELLS, (k + 1) % ARC_CELLS, (k + 2) % ARC_CELLS
    for node in (outer, k, after, beyond):
        know_path(task, arm, node, paths, known_paths)
    for node in (k, after):
        know_margins(task, wrist, node, paths, margins, known_margins)
    at_left, at_right, left, right = paths[k], paths[after], margins[k], margins[after]
    state, _, _ = path_state(
        task, wrist, _STEP, paths[outer], at_left, at_right, paths[beyond], left, right
    )
    low, high = _ANGLES[k], _ANGLES[k + 1]
    if state == CellState.DEAD:
        return count
    if state == CellState.FULL:
        return append_arc(arcs, start, count, arm, wrist, low, high, JUMP, JUMP)
    if state in (CellState.EDGE, CellState.CROSSED):
        first, end = (REACH, JUMP) if state == CellState.EDGE else (0, CONSTRAINTS)
        clean, a, b, by_a, by_b = tighten(
            task, scratch, arm, wrist, first, end, low, high, at_left, at_right, left, right
        )
        if clean and a >= b:
            return count
        if clean and state == CellState.CROSSED:
            return append_arc(arcs, start, count, arm, wrist, a, b, by_a, by_b)
        if clean:
            return settle(task, scratch, arm, wrist, a, b, by_a, by_b, arcs, start, count)
    return settle(task, scratch, arm, wrist, low, high, JUMP, JUMP, arcs, start, count)


@kernel
def append_arc(arcs, start, count, arm, wrist, low, high, by_low, by_high):
    """Appends a piece, or lengthens the last arc if the piece goes on where it ends."""
    if count > start and arcs[count - 1, 2] == low:
        arcs[count - 1, 2] = high
        arcs[count - 1, 4] = by_high
        return count
    assert count < MOST_ARCS
    arc = arcs[count]
    arc[0], arc[1], arc[2], arc[3], arc[4] = 2 * arm + wrist, low, high, by_low, by_high
    return count + 1


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


@kernel
def append_sliver(task, scratch, arm, wrist, low, high, arcs, start, count):
    """Appends what is feasible of a cell no wider than NARROWEST_CELL_RAD whose ends are too fast.

    A cut-in that ends just before a straight wrist is slow where it goes straight towards it.
    Returns the new count.
    """
    where, room = extreme_margin(
        task, scratch, arm, wrist, JUMP, 0, low, high, 1.0, NARROWEST_ARC_RAD
    )
    if room < 0.0:
        return count
    turns_along_path(task, where, arm, scratch.work)
    path_margins(task, scratch.work, wrist, scratch.work_margins)
    if scratch.work_margins.min() < 0.0:
        return count
    ends = (low, high)
    first, last = where, where
    for side in range(2):
        beyond = single_margin(task, scratch, ends[side], 0, arm, wrist, JUMP)
        end = ends[side]
        if beyond < 0.0:
            end = root(task, scratch, arm, wrist, JUMP, 0, end, beyond, where, room)
        if side == 0:
            first = end
        else:
            last = end
    return append_arc(arcs, start, count, arm, wrist, first, last, JUMP, JUMP)


@kernel
def push(stack, top, low, high, by_low, by_high):
    """Writes a cell, and what ends it at both sides, to a row of the stack."""
    stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3] = low, high, by_low, by_high


@kernel
def forget_cells(scratch):
    """Marks the turns along cut-ins that `know_cell` keeps as those of no angle."""
    scratch.cell_angles[:] = math.inf
    scratch.cell_ages[:] = 0


@kernel
def know_cell(task, scratch, arm, angle, apart):
    """The slot with the turns along the cut-in at an angle, or at one no further than `apart`.

    A cell shares its ends with its halves, and has theirs beside them. Where none has them they are
    computed into the slot that was not asked for the longest.
    """
    oldest = 0
    for slot in range(CELL_SLOTS):
        if abs(scratch.cell_angles[slot] - angle) <= apart:
            scratch.cell_ages[slot] = 0
            return slot
        if scratch.cell_ages[slot] > scratch.cell_ages[oldest]:
            oldest = slot
    turns_along_path(task, angle, arm, scratch.cell_paths[oldest])
    scratch.cell_angles[oldest], scratch.cell_ages[oldest] = angle, 0
    scratch.cell_known_margins[oldest] = False
    return oldest


@kernel
def settle(task, scratch, arm, wrist, low, high, by_low, by_high, arcs, start, count):
    """Appends the feasible pieces of a cell that has to be split; returns the new count."""
    stack = np.empty((CELL_STACK, 4))
    push(stack, 0, low, high, by_low, by_high)
    top = 1
    paths, margins, ages = scratch.cell_paths, scratch.cell_margins, scratch.cell_ages
    forget_cells(scratch)
    while top > 0:
        top -= 1
        a, b, by_a, by_b = stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3]
        width = b - a
        for slot in range(CELL_SLOTS):
            ages[slot] += 1
        # The ends first: they have to be met exactly, what lies beside them only nearly.
        left, right = know_cell(task, scratch, arm, a, 0.0), know_cell(task, scratch, arm, b, 0.0)
        outer = know_cell(task, scratch, arm, a - width, SAME_ANGLE_RAD)
        beyond = know_cell(task, scratch, arm, b + width, SAME_ANGLE_RAD)
        for slot in (left, right):
            if not scratch.cell_known_margins[slot]:
                path_margins(task, paths[slot], wrist, margins[slot])
                scratch.cell_known_margins[slot] = True
        state, i, row = path_state(
            task, wrist, width, paths[outer], paths[left], paths[right], paths[beyond],
            margins[left], margins[right],
        )  # fmt: skip
        middle = (a + b) / 2
        if state == CellState.DEAD:
            continue
        if state == CellState.FULL:
            count = append_arc(arcs, start, count, arm, wrist, a, b, by_a, by_b)
            continue
        if state in (CellState.CROSSED, CellState.EDGE):
            first, end = (REACH, JUMP) if state == CellState.EDGE else (0, CONSTRAINTS)
            clean, c, d, by_c, by_d = tighten(
                task, scratch, arm, wrist, first, end, a, b,
                paths[left], paths[right], margins[left], margins[right],
            )  # fmt: skip
            by_c, by_d = by_a if c == a else by_c, by_b if d == b else by_d
            if clean and c >= d:
                continue
            if clean and state == CellState.CROSSED:
                count = append_arc(arcs, start, count, arm, wrist, c, d, by_c, by_d)
                continue
            if clean and d - c < width:
                push(stack, top, c, d, by_c, by_d)
                top += 1
                continue
        if width < NARROWEST_CELL_RAD or top + 2 > len(stack):
            if max(margins[left, JUMP], margins[right, JUMP]) < 0.0:
                count = append_sliver(task, scratch, arm, wrist, a, b, arcs, start, count)
            continue
        if state == CellState.EXTREME and i >= 0:
            sign = 1.0
            at_end = margins[left, JUMP]
            if i != JUMP:
                at_end = row_margin(task, paths[left], row, wrist, i)
            if at_end >= 0.0:
                sign = -1.0
            where, value = extreme_margin(
                task, scratch, arm, wrist, i, row, a, b, sign, EXTREME_ANGLE_RAD
            )
            if sign > 0.0 and value < 0.0:
                continue
            if min(where - a, b - where) > EXTREME_ANGLE_RAD:
                middle = where
        push(stack, top, middle, b, JUMP, by_b)
        push(stack, top + 1, a, middle, by_a, JUMP)
        top += 2
    return count
