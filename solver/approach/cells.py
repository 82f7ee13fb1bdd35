"""Kernels: what a cell of approach angles can hold, from values at its ends and beside them.

A constraint that is negative at both ends of a cell, and has no maximum in between, is negative in
the whole cell. Slopes outside the cell tell whether there is one: where the function is concave it
stays below both lines that lead in. That holds where a joint does not swing, beside a
straight wrist or the waist's axis, and does not enter the arm's reach, where it has a cusp.
"""

from typing import Final

from solver.approach.packed import COS_HALF
from solver.approach.turns import (
    BESIDE,
    JOINT_OF_ROW,
    JUMP,
    REACH,
    WRIST_ROWS,
    jump_margin,
    passes_behind,
    row_constraints,
    row_margin,
    swings,
)
from solver.compiled import kernel
from solver.tolerances import (
    ARC_CELLS,
    CELL_SWING_COSINE,
    CLEAR_MARGIN,
    NARROW_JUMP_RAD,
    ROUND_TURN_COSINE,
    STEEPEST_JUMP,
)

DEAD: Final = 0
FULL: Final = 1
CROSSED: Final = 2
EXTREME: Final = 3
EDGE: Final = 4
"""States of a cell: no angle is feasible; all are; constraints change sign; one may have an
extremum across zero, or a joint swings; the arm enters its reach."""


@kernel
def peak_above(before, left, right, after):
    """Bound of a maximum between two values, from the slopes outside them.

    Where the function is concave it stays below both lines that lead in from outside.
    """
    rise, fall = left - before, right - after
    if rise <= 0.0 or fall <= 0.0:
        return max(left, right)
    share = min(max((right - left + fall) / (rise + fall), 0.0), 1.0)
    return left + rise * share


@kernel
def close_cells(task, turns, count, column, values, open_cells):
    """Closes cells in which a constraint of one row is certainly negative; returns how many stay.

    Args:
        task: the packed task.
        turns: of the row, shape (TURN_ROWS, count or more).
        count: how many columns are in use.
        column: the column of each node.
        values: working memory, shape (ROW_CONSTRAINTS, ARC_CELLS).
        open_cells: shape (2, ARC_CELLS), by wrist.
    """
    row_constraints(task, turns, count, values)
    stay = 0
    for k in range(ARC_CELLS):
        if not (open_cells[0, k] or open_cells[1, k]):
            continue
        places = (
            column[(k - 1) % ARC_CELLS],
            column[k],
            column[(k + 1) % ARC_CELLS],
            column[(k + 2) % ARC_CELLS],
        )
        if certainly_broken(turns, values, places, 0, WRIST_ROWS):
            open_cells[0, k] = open_cells[1, k] = False
            continue
        for wrist in range(2):
            if open_cells[wrist, k]:
                first = WRIST_ROWS + 3 * wrist
                if certainly_broken(turns, values, places, first, first + 3):
                    open_cells[wrist, k] = False
                else:
                    stay += 1
    return stay


@kernel
def certainly_broken(turns, values, places, first, last):
    """Whether one of some constraints is negative in the whole cell between places 1 and 2."""
    before, left, right, after = places
    # Joints have a cusp at the edge of reach, of which slopes outside the cell do not tell.
    edge = enters_reach(turns, left, turns, right)
    for row in range(first, last):
        a, b = values[row, left], values[row, right]
        if a < 0.0 and b < 0.0:
            i = JOINT_OF_ROW[row]
            if i >= 0 and (edge or swung(turns, left, turns, right, i)):
                continue
            if peak_above(values[row, before], a, b, values[row, after]) < 0.0:
                return True
    return False


@kernel
def enters_reach(left, m, right, n):
    """Whether a reach margin changes its sign from column m of left to column n of right."""
    arm = (left[6 + REACH, m] < 0.0) != (right[6 + REACH, n] < 0.0)
    return arm or (left[6 + BESIDE, m] < 0.0) != (right[6 + BESIDE, n] < 0.0)


@kernel
def swung(left, m, right, n, i):
    """Whether joint i turns so far between two columns that its margin need not be smooth."""
    cosines = left[2 * i, m] * right[2 * i, n]
    return cosines + left[2 * i + 1, m] * right[2 * i + 1, n] < CELL_SWING_COSINE


@kernel
def needed_nodes(open_cells, needed):
    """Marks the ends of open cells and their outer neighbours."""
    needed[:] = False
    for wrist in range(2):
        for k in range(ARC_CELLS):
            if open_cells[wrist, k]:
                for step in range(-1, 3):
                    needed[(k + step) % ARC_CELLS] = True


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
        The state, and for EXTREME the constraint and row that may have an extremum, or -1 where a
        joint swings or may jump. EDGE where the arm enters its reach: joints have a cusp there.
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
                return DEAD, -1, 0
    if min(left_margins[REACH], right_margins[REACH]) < 0.0 or (
        min(left_margins[BESIDE], right_margins[BESIDE]) < 0.0
    ):
        for n in range(rows):
            if enters_reach(left, n, right, n):
                return EDGE, -1, 0
    if swings(left, right, rows, CELL_SWING_COSINE):
        return EXTREME, -1, 0
    state, extreme, at_row = FULL, -1, 0
    for i in range(JUMP):
        clear = min(left_margins[i], right_margins[i])
        # Between ends that far inside only a joint that may turn all but freely can get outside.
        turns_round = i < REACH and task.numbers[COS_HALF + i] < ROUND_TURN_COSINE
        if clear >= CLEAR_MARGIN and not turns_round:
            continue
        for n in range(rows):
            a, b = row_margin(task, left, n, wrist, i), row_margin(task, right, n, wrist, i)
            if (a < 0.0) != (b < 0.0):
                state = CROSSED
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
        # The smallest of many rows' margins has corners, so that slopes tell little of it.
        if width > NARROW_JUMP_RAD and max(a, b) > -STEEPEST_JUMP * width:
            return EXTREME, -1, 0
        before, after = jump_margin(task, outer, wrist), jump_margin(task, beyond, wrist)
        if peak_above(before, a, b, after) < 0.0:
            return DEAD, -1, 0
        extreme, at_row = JUMP, 0
    elif (a < 0.0) != (b < 0.0):
        state = CROSSED
    return (EXTREME, extreme, at_row) if extreme >= 0 else (state, -1, 0)
