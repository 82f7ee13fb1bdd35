"""Kernels: the feasible pieces of a cell that has to be split, and where pieces are kept."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.arcs.cells import CellState, path_state
from solver.approach.arcs.effort_bound import effort_at_least
from solver.approach.arcs.roots import (
    CELL_SLOTS,
    WHOLE_CUT_IN,
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
from solver.approach.arcs.turns import CONSTRAINTS, path_margins, row_margin, turns_along_path
from solver.approach.task.constraints import JUMP, REACH
from solver.compiled import NONE_YET, kernel

MOST_ARCS = 64
ARC_COLUMNS = 5
"""Columns of an arc: branch, lower and upper angle [rad], the constraint that ends it at each
(WHOLE_TURN where none does)."""

JUMP_IN_CUT_IN = np.int64(JUMP)
"""JUMP as what is handed on, see `NONE_YET`."""


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
def append_sliver(task, scratch, arm, wrist, low, high, arcs, start, count):
    """Appends what is feasible of a cell no wider than NARROWEST_CELL_RAD whose ends are too fast.

    A cut-in that ends just before a straight wrist is slow where it goes straight towards it.
    Returns the new count.
    """
    where, room = extreme_margin(
        task, scratch, arm, wrist, JUMP_IN_CUT_IN, WHOLE_CUT_IN, low, high, 1.0, NARROWEST_ARC_RAD
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
        beyond = single_margin(task, scratch, ends[side], WHOLE_CUT_IN, arm, wrist, JUMP_IN_CUT_IN)
        end = ends[side]
        if beyond < 0.0:
            end = root(
                task, scratch, arm, wrist, JUMP_IN_CUT_IN, WHOLE_CUT_IN, end, beyond, where, room
            )
        if side == 0:
            first = end
        else:
            last = end
    return append_arc(arcs, start, count, arm, wrist, first, last, JUMP_IN_CUT_IN, JUMP_IN_CUT_IN)


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
def settle(task, scratch, arm, wrist, low, high, by_low, by_high, arcs, start, count, best):
    """Appends the feasible pieces of a cell that has to be split; returns the new count.

    Parts in which effort is certainly not below `best` are left out.
    """
    stack = np.empty((CELL_STACK, 4))
    top = NONE_YET
    push(stack, top, low, high, by_low, by_high)
    top += 1
    paths, margins, ages = scratch.cell_paths, scratch.cell_margins, scratch.cell_ages
    forget_cells(scratch)
    # The thinning posture's column.
    last = paths.shape[2] - 1
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
        if best < math.inf:
            least = effort_at_least(
                task, scratch.reference, wrist, paths[outer], last, paths[left], last,
                paths[right], last, paths[beyond], last,
            )  # fmt: skip
            if least >= best:
                continue
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
        push(stack, top, middle, b, JUMP_IN_CUT_IN, by_b)
        push(stack, top + 1, a, middle, by_a, JUMP_IN_CUT_IN)
        top += 2
    return count
