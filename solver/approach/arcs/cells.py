"""Kernels: what a cell of approach angles can hold, from values at its ends and beside them.

A constraint that is negative at both ends of a cell, and has no maximum in between, is negative in
the whole cell. Slopes outside the cell tell whether there is one: where the function is concave it
stays below both lines that lead in. That holds where a joint does not swing, beside a
straight wrist or the waist's axis, and does not enter the arm's reach, where it has a cusp.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from enum import IntEnum
from typing import Final

from solver.approach.arcs.tolerances import (
    CELL_SWING_COSINE,
    CLEAR_MARGIN,
    CLEAR_ROOM,
    NARROW_JUMP_RAD,
    ROUND_TURN_COSINE,
)
from solver.approach.arcs.turns import (
    JOINT_OF_ROW,
    ROW_CONSTRAINTS,
    WRIST_ROWS,
    jump_margin,
    passes_behind,
    row_constraints,
    row_margin,
    turn_cosine,
)
from solver.approach.task.constraints import BESIDE, JUMP, REACH
from solver.approach.task.packed import COS_HALF
from solver.approach.tolerances import ARC_CELLS
from solver.compiled import inlined, kernel

ARC_NODES: Final = ARC_CELLS + 3
"""Ends of all cells, and a node beyond at each side."""


class CellState(IntEnum):
    """What a cell holds: no feasible angle, or feasible angles only, or what has to be looked at.

    CROSSED: constraints change sign. EXTREME: one may have an extremum across zero, or a joint
    swings. EDGE: the arm enters its reach.
    """

    DEAD = 0
    FULL = 1
    CROSSED = 2
    EXTREME = 3
    EDGE = 4


@inlined
def peak_above(before, left, right, after):
    """Bound of a maximum between two values, from the slopes outside them.

    Where the function is concave it stays below both lines that lead in from outside.
    """
    rise, fall = left - before, right - after
    hill = rise > 0.0 and fall > 0.0
    share = min(max((right - left + fall) / (rise + fall if hill else 1.0), 0.0), 1.0)
    return left + rise * share if hill else max(left, right)


@kernel
def close_cells(task, turns, values, highest, open_cells):
    """Closes cells in which a constraint of one row is certainly negative; returns how many stay.

    Args:
        task: the packed task.
        turns: of the row at all nodes: one before the first cell, both ends of every cell, and one
            beyond the last, shape (TURN_ROWS, ARC_NODES).
        values: working memory, shape (ROW_CONSTRAINTS, ARC_NODES).
        highest: working memory, shape (3, ARC_CELLS).
        open_cells: shape (2, ARC_CELLS), by wrist.
    """
    row_constraints(task, turns, ARC_NODES, values)
    # What each wrist shares, then each wrist's own: the least of the constraints' highest values.
    highest[:] = 0.0
    for row in range(ROW_CONSTRAINTS):
        group = 0 if row < WRIST_ROWS else 1 if row < WRIST_ROWS + 3 else 2
        lower_highest(turns, values[row], JOINT_OF_ROW[row], highest[group])
    stay = 0
    for k in range(ARC_CELLS):
        for wrist in range(2):
            if min(highest[0, k], highest[1 + wrist, k]) < 0.0:
                open_cells[wrist, k] = False
            elif open_cells[wrist, k]:
                stay += 1
    return stay


@kernel
def any_cell_reached(values, highest):
    """Whether the first two rows of values, the reaches at all nodes, leave a cell open."""
    for k in range(ARC_CELLS):
        highest[0, k] = math.inf
        for row in range(2):
            margins = values[row]
            peak = peak_above(margins[k], margins[k + 1], margins[k + 2], margins[k + 3])
            highest[0, k] = min(highest[0, k], peak)
    return highest[0].max() >= 0.0


@kernel
def lower_highest(turns, margins, i, highest):
    """Lowers what is highest in each cell, shape (ARC_CELLS,), to a margin that stays below zero.

    Joints (i >= 0) have a cusp at the edge of reach, and no slopes to believe where they swing.
    """
    cosine, sine = turns[2 * max(i, 0)], turns[2 * max(i, 0) + 1]
    reach, beside = turns[6 + REACH], turns[6 + BESIDE]
    # Without calls that get an array: the compiler makes a vector loop of it.
    for k in range(ARC_CELLS):
        a, b = margins[k + 1], margins[k + 2]
        peak = peak_above(margins[k], a, b, margins[k + 3])
        edge = ((reach[k + 1] < 0.0) != (reach[k + 2] < 0.0)) or (
            (beside[k + 1] < 0.0) != (beside[k + 2] < 0.0)
        )
        turn = cosine[k + 1] * cosine[k + 2] + sine[k + 1] * sine[k + 2]
        smooth = i < 0 or not (edge or turn < CELL_SWING_COSINE)
        below = a < 0.0 and b < 0.0 and smooth
        highest[k] = min(highest[k], peak if below else 0.0)


@kernel
def enters_reach(left, m, right, n):
    """Whether a reach margin changes its sign from column m of left to column n of right."""
    arm = (left[6 + REACH, m] < 0.0) != (right[6 + REACH, n] < 0.0)
    return arm or (left[6 + BESIDE, m] < 0.0) != (right[6 + BESIDE, n] < 0.0)


@kernel
def least_reach(turns, rows):
    """The smaller of both reach margins in the first `rows` columns [m]."""
    return min(turns[6 + REACH, :rows].min(), turns[6 + BESIDE, :rows].min())


@kernel
def swung(left, m, right, n, i):
    """Whether joint i turns so far between two columns that its margin need not be smooth."""
    cosines = left[2 * i, m] * right[2 * i, n]
    return cosines + left[2 * i + 1, m] * right[2 * i + 1, n] < CELL_SWING_COSINE


@kernel
def path_state(task, wrist, width, outer, left, right, beyond, left_margins, right_margins):
    """State of a cell from every constraint in every row.

    Args:
        task: the packed task.
        wrist: 0 or 1.
        width: of the cell [rad].
        outer: turns along the cut-in one cell before the cell's lower end.
        left: the same at its lower end.
        right: the same at its upper end.
        beyond: the same one cell further.
        left_margins: smallest margins over all rows at the lower end, shape (CONSTRAINTS,).
        right_margins: the same at the upper end.

    Returns:
        The state, and for EXTREME the constraint and row (-1: the whole cut-in) that may have an
        extremum, or -1 where a joint swings or may jump. EDGE where the arm enters its reach:
        joints have a cusp there.
    """
    rows = len(task.retreats)
    for i in range(JUMP):
        if left_margins[i] >= 0.0 or right_margins[i] >= 0.0:
            continue
        for n in range(rows):
            a, b = row_margin(task, left, n, wrist, i), row_margin(task, right, n, wrist, i)
            if a >= 0.0 or b >= 0.0:
                continue
            if i < REACH and (enters_reach(left, n, right, n) or swung(left, n, right, n, i)):
                continue
            before = row_margin(task, outer, n, wrist, i)
            if peak_above(before, a, b, row_margin(task, beyond, n, wrist, i)) < 0.0:
                return CellState.DEAD, -1, 0
    if min(left_margins[REACH], right_margins[REACH]) < 0.0 or (
        min(left_margins[BESIDE], right_margins[BESIDE]) < 0.0
    ):
        for n in range(rows):
            if enters_reach(left, n, right, n):
                return CellState.EDGE, -1, 0
    least_cosine = turn_cosine(left, right, rows)
    if least_cosine < CELL_SWING_COSINE:
        return CellState.EXTREME, -1, 0
    state, extreme, at_row = CellState.FULL, -1, 0
    for i in range(JUMP):
        clear = min(left_margins[i], right_margins[i])
        # Between ends that far inside only a joint that may turn all but freely can get outside.
        turns_round = i < REACH and task.numbers[COS_HALF + i] < ROUND_TURN_COSINE
        if clear >= CLEAR_MARGIN and not turns_round:
            continue
        for n in range(rows):
            a, b = row_margin(task, left, n, wrist, i), row_margin(task, right, n, wrist, i)
            if (a < 0.0) != (b < 0.0):
                state = CellState.CROSSED
                continue
            if a >= 0.0 and clear >= CLEAR_MARGIN:
                if passes_behind(task, left, n, right, n, wrist, i):
                    extreme, at_row = i, n
                continue
            before, after = (
                row_margin(task, outer, n, wrist, i),
                row_margin(task, beyond, n, wrist, i),
            )
            if (
                a < 0.0
                or peak_above(-before, -a, -b, -after) > 0.0
                or (turns_round and passes_behind(task, left, n, right, n, wrist, i))
            ):
                extreme, at_row = i, n
    a, b = left_margins[JUMP], right_margins[JUMP]
    if a < 0.0 and b < 0.0:
        before, after = jump_margin(task, outer, wrist), jump_margin(task, beyond, wrist)
        peak = peak_above(before, a, b, after)
        # Rates turn with the joints, so slopes tell of them to the square of how far one turns in
        # the cell; at the edge of reach the elbow's falls like a root, of which they tell nothing.
        edge = least_reach(outer, rows) < 0.0 or least_reach(beyond, rows) < 0.0
        bent = (edge and width > NARROW_JUMP_RAD) or peak > 2.0 * (least_cosine - 1.0)
        return (CellState.EXTREME if bent else CellState.DEAD), -1, 0
    if (a < 0.0) != (b < 0.0):
        state = CellState.CROSSED
    elif min(a, b) < CLEAR_ROOM:
        before, after = jump_margin(task, outer, wrist), jump_margin(task, beyond, wrist)
        valley = -peak_above(-before, -a, -b, -after)
        if width > NARROW_JUMP_RAD and valley < 2.0 * (1.0 - least_cosine):
            return CellState.EXTREME, -1, 0
        if valley < 0.0:
            extreme, at_row = JUMP, -1
    return (CellState.EXTREME, extreme, at_row) if extreme >= 0 else (state, -1, 0)
