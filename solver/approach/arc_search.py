"""Kernels: the feasible arcs of every branch of one target, from sampled margins and their roots.

One turn is cut into cells. A cell with a constraint that is negative at both ends, and that has no
maximum in between, is dead at once for the thinning posture alone, then for the standby posture,
then for the whole cut-in; few cells reach the last. There a constraint that changes sign has one
root, which is refined on its own row; a constraint that may have a maximum above zero, or a minimum
below, between the ends has the cell split at it. So a feasible arc is found however narrow it is,
as long as each single constraint is resolved by the cells; where a joint swings from cell to cell
(beside a straight wrist or the waist's axis) the cells are halved until it does not.
"""

import math
from typing import NamedTuple

import numpy as np

from solver.approach.packed import (
    COS_HALF,
    unpack_circle,
    unpack_geometry,
)
from solver.approach.turns import (
    BESIDE,
    CONSTRAINTS,
    JOINT_OF_ROW,
    JUMP,
    REACH,
    ROW_CONSTRAINTS,
    TURN_ROWS,
    WRIST_ROWS,
    jump_margin,
    passes_behind,
    path_margins,
    row_constraints,
    row_margin,
    swings,
    turns_along_path,
    turns_at_angles,
    write_turns,
)
from solver.compiled import kernel
from solver.robots.model import Array
from solver.tolerances import (
    ARC_CELLS,
    ARC_END_RAD,
    CELL_SWING_COSINE,
    CLEAR_MARGIN,
    EXTREME_ANGLE_RAD,
    NARROWEST_CELL_RAD,
    ROUND_TURN_COSINE,
)

MOST_ARCS = 64
ARC_COLUMNS = 5
WHOLE_TURN = -1
"""Columns of an arc: branch, lower and upper angle [rad], the constraint that ends it at each
(WHOLE_TURN where none does)."""

_STEP = 2 * math.pi / ARC_CELLS
_ANGLES = -math.pi + _STEP * np.arange(ARC_CELLS + 1)
_ANGLES[-1] = math.pi
_COSINES, _SINES = np.cos(_ANGLES), np.sin(_ANGLES)
_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0

DEAD, FULL, CROSSED, EXTREME, EDGE = 0, 1, 2, 3, 4


class ArcScratch(NamedTuple):
    """Working memory of the kernels, one for a thread; nothing in it outlives a call."""

    thinning: Array
    standby: Array
    values: Array
    cosines: Array
    sines: Array
    paths: Array
    margins: Array
    cell_paths: Array
    cell_margins: Array
    single: Array
    work: Array
    work_margins: Array
    single_path: Array


@kernel
def arc_scratch(rows):
    """Working memory for cut-ins of that many rows."""
    return ArcScratch(
        np.empty((TURN_ROWS, ARC_CELLS)),
        np.empty((TURN_ROWS, ARC_CELLS)),
        np.empty((ROW_CONSTRAINTS, ARC_CELLS)),
        np.empty(ARC_CELLS),
        np.empty(ARC_CELLS),
        np.empty((ARC_CELLS, TURN_ROWS, rows)),
        np.empty((2, ARC_CELLS, CONSTRAINTS)),
        np.empty((4, TURN_ROWS, rows)),
        np.empty((2, CONSTRAINTS)),
        np.empty((TURN_ROWS, 1)),
        np.empty((TURN_ROWS, rows)),
        np.empty(CONSTRAINTS),
        np.empty((TURN_ROWS, rows)),
    )


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
def arcs_of(task):
    """Feasible arcs of all branches, shape (arcs, ARC_COLUMNS)."""
    arcs = np.empty((MOST_ARCS, ARC_COLUMNS))
    count = find_arcs(task, arc_scratch(len(task.retreats)), arcs)
    return arcs[:count].copy()


@kernel
def find_arcs(task, scratch, arcs):
    """Feasible arcs of all branches into arcs, shape (MOST_ARCS, ARC_COLUMNS); returns how many."""
    count = 0
    column = np.empty(ARC_CELLS, dtype=np.int64)
    open_cells = np.empty((2, ARC_CELLS), dtype=np.bool_)
    needed = np.empty(ARC_CELLS, dtype=np.bool_)
    for arm in range(4):
        turns_at_angles(task, _COSINES, _SINES, ARC_CELLS, 0.0, arm, scratch.thinning)
        open_cells[:] = True
        column[:] = np.arange(ARC_CELLS)
        values = scratch.values
        if close_cells(task, scratch.thinning, ARC_CELLS, column, values, open_cells) == 0:
            continue
        needed_nodes(open_cells, needed)
        listed = 0
        for k in range(ARC_CELLS):
            if needed[k]:
                scratch.cosines[listed], scratch.sines[listed] = _COSINES[k], _SINES[k]
                column[k] = listed
                listed += 1
        standoff = task.retreats[0]
        turns_at_angles(
            task, scratch.cosines, scratch.sines, listed, standoff, arm, scratch.standby
        )
        if close_cells(task, scratch.standby, listed, column, values, open_cells) == 0:
            continue
        needed_nodes(open_cells, needed)
        for k in range(ARC_CELLS):
            if needed[k]:
                turns_along_path(task, _ANGLES[k], arm, scratch.paths[k])
                for wrist in range(2):
                    path_margins(task, scratch.paths[k], wrist, scratch.margins[wrist, k])
        for wrist in range(2):
            count = branch_arcs(task, scratch, arm, wrist, open_cells[wrist], arcs, count)
    return count


@kernel
def branch_arcs(task, scratch, arm, wrist, open_cells, arcs, count):
    """Appends the arcs of one branch; returns the new count."""
    start = count
    margins, paths = scratch.margins[wrist], scratch.paths
    for k in range(ARC_CELLS):
        if not open_cells[k]:
            continue
        outer, after = paths[(k - 1) % ARC_CELLS], (k + 1) % ARC_CELLS
        beyond = paths[(k + 2) % ARC_CELLS]
        left, right = margins[k], margins[after]
        state, _, _ = path_state(
            task, wrist, outer, paths[k], paths[after], beyond, left, right
        )  # fmt: skip
        low, high = _ANGLES[k], _ANGLES[k + 1]
        if state == FULL:
            count = append_arc(arcs, start, count, arm, wrist, low, high, JUMP, JUMP)
            continue
        clean = state == DEAD
        if state == EDGE:
            clean, a, b, by_a, by_b = tighten(
                task, scratch, arm, wrist, REACH, JUMP, low, high,
                paths[k], paths[after], left, right,
            )  # fmt: skip
            if clean and a < b:
                count = settle(task, scratch, arm, wrist, a, b, by_a, by_b, arcs, start, count)
        if state == CROSSED:
            clean, a, b, by_a, by_b = tighten(
                task, scratch, arm, wrist, 0, CONSTRAINTS, low, high,
                paths[k], paths[after], left, right,
            )  # fmt: skip
            if clean and a < b:
                count = append_arc(arcs, start, count, arm, wrist, a, b, by_a, by_b)
        if not clean:
            count = settle(task, scratch, arm, wrist, low, high, JUMP, JUMP, arcs, start, count)
    return close_turn(arcs, start, count)


@kernel
def path_state(task, wrist, outer, left, right, beyond, left_margins, right_margins):
    """State of a cell from every constraint in every row.

    Args:
        task: the packed task.
        wrist: 0 or 1.
        outer: turns along the cut-in one cell before the cell's lower end.
        left: the same at its lower end.
        right: the same at its upper end.
        beyond: the same one cell further.
        left_margins: smallest margins over all rows at the lower end, shape (CONSTRAINTS,).
        right_margins: the same at the upper end.

    Returns:
        The state, and for EXTREME the constraint and row that may have an extremum, or -1 where a
        joint swings. EDGE where the arm enters its reach: joints have a cusp there.
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
        before, after = jump_margin(task, outer, wrist), jump_margin(task, beyond, wrist)
        if peak_above(before, a, b, after) < 0.0:
            return DEAD, -1, 0
        extreme, at_row = JUMP, 0
    elif (a < 0.0) != (b < 0.0):
        state = CROSSED
    return (EXTREME, extreme, at_row) if extreme >= 0 else (state, -1, 0)


@kernel
def append_arc(arcs, start, count, arm, wrist, low, high, by_low, by_high):
    """Appends a piece, or lengthens the last arc if the piece goes on where it ends."""
    if count > start and arcs[count - 1, 2] == low:
        arcs[count - 1, 2] = high
        arcs[count - 1, 4] = by_high
        return count
    if count == MOST_ARCS:
        return count
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
def push(stack, top, low, high, by_low, by_high):
    """Writes a cell, and what ends it at both sides, to a row of the stack."""
    stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3] = low, high, by_low, by_high


@kernel
def settle(task, scratch, arm, wrist, low, high, by_low, by_high, arcs, start, count):
    """Appends the feasible pieces of a cell that has to be split; returns the new count."""
    stack = np.empty((64, 4))
    push(stack, 0, low, high, by_low, by_high)
    top = 1
    paths, margins = scratch.cell_paths, scratch.cell_margins
    while top > 0:
        top -= 1
        a, b, by_a, by_b = stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3]
        width = b - a
        for m in range(4):
            angle = a + (m - 1) * width if m != 2 else b
            turns_along_path(task, angle, arm, paths[m])
        path_margins(task, paths[1], wrist, margins[0])
        path_margins(task, paths[2], wrist, margins[1])
        state, i, row = path_state(
            task, wrist, paths[0], paths[1], paths[2], paths[3], margins[0], margins[1]
        )
        middle = (a + b) / 2
        if state == DEAD:
            continue
        if state == FULL:
            count = append_arc(arcs, start, count, arm, wrist, a, b, by_a, by_b)
            continue
        if state in (CROSSED, EDGE):
            first, end = (REACH, JUMP) if state == EDGE else (0, CONSTRAINTS)
            clean, c, d, by_c, by_d = tighten(
                task, scratch, arm, wrist, first, end, a, b,
                paths[1], paths[2], margins[0], margins[1],
            )  # fmt: skip
            by_c, by_d = by_a if c == a else by_c, by_b if d == b else by_d
            if clean and c >= d:
                continue
            if clean and state == CROSSED:
                count = append_arc(arcs, start, count, arm, wrist, c, d, by_c, by_d)
                continue
            if clean and d - c < width:
                push(stack, top, c, d, by_c, by_d)
                top += 1
                continue
        if width < NARROWEST_CELL_RAD or top + 2 > len(stack):
            continue  # a straight wrist, where no angle keeps its branch
        if state == EXTREME and i >= 0:
            sign = 1.0
            if i != JUMP and row_margin(task, paths[1], row, wrist, i) >= 0.0:
                sign = -1.0
            where, value = extreme_margin(task, scratch, arm, wrist, i, row, a, b, sign)
            if sign > 0.0 and value < 0.0:
                continue
            if min(where - a, b - where) > EXTREME_ANGLE_RAD:
                middle = where
        push(stack, top, middle, b, JUMP, by_b)
        push(stack, top + 1, a, middle, by_a, JUMP)
        top += 2
    return count


@kernel
def extreme_margin(task, scratch, arm, wrist, i, row, low, high, sign):
    """Golden section for the largest (sign 1) or smallest (-1) margin; stops where it crosses 0.

    Returns the angle and sign times the margin there.
    """
    a, b = low, high
    x1, x2 = b - _GOLDEN * (b - a), a + _GOLDEN * (b - a)
    f1 = sign * single_margin(task, scratch, x1, row, arm, wrist, i)
    f2 = sign * single_margin(task, scratch, x2, row, arm, wrist, i)
    while b - a > EXTREME_ANGLE_RAD and max(f1, f2) <= 0.0:
        if f1 >= f2:
            b, x2, f2 = x2, x1, f1
            x1 = b - _GOLDEN * (b - a)
            f1 = sign * single_margin(task, scratch, x1, row, arm, wrist, i)
        else:
            a, x1, f1 = x1, x2, f2
            x2 = a + _GOLDEN * (b - a)
            f2 = sign * single_margin(task, scratch, x2, row, arm, wrist, i)
    return (x1, f1) if f1 >= f2 else (x2, f2)


@kernel
def tighten(task, scratch, arm, wrist, first, end, low, high, left_path, right_path, left, right):
    """The feasible part of a cell in which every constraint has one root at most in every row.

    Only constraints from `first` to before `end` are looked at.

    Returns whether that held, the part's ends (the first is not the lower where there is none) and
    the constraints that end it.
    """
    a, by_a, clean = pull_in(
        task, scratch, arm, wrist, first, end, low, high, left_path, right_path, left, right
    )
    if not clean:
        return False, low, high, JUMP, JUMP
    if a >= high:
        return True, high, low, JUMP, JUMP
    b, by_b, clean = pull_in(
        task, scratch, arm, wrist, first, end, high, low, right_path, left_path, right, left
    )
    return clean, a, b, by_a, by_b


@kernel
def pull_in(
    task, scratch, arm, wrist, first, last, start, end, at_start, at_end, start_margins, end_margins
):
    """Moves from one end of a cell inwards until no constraint that is met at the other is broken.

    Returns the angle, `end` where the cell has no feasible part, the constraint that was met last,
    and whether the cell behaves: constraints met at both ends are met at the angle.
    """
    angle, by = start, JUMP
    turns, margins = at_start, start_margins
    inwards = 1.0 if end > start else -1.0
    for _ in range(8 * CONSTRAINTS):
        worst, row, least = worst_constraint(task, turns, wrist, first, last, margins)
        if worst < 0:
            return angle, by, True
        if worst == JUMP:
            at_other, at_this = end_margins[JUMP], start_margins[JUMP]
        else:
            at_other = row_margin(task, at_end, row, wrist, worst)
            at_this = row_margin(task, at_start, row, wrist, worst)
        if at_other < 0.0:
            return end, worst, True
        if at_this >= 0.0:
            return end, worst, False
        found = root(task, scratch, arm, wrist, worst, row, angle, least, end, at_other)
        angle, by = found if found != angle else angle + inwards * ARC_END_RAD, worst
        if (end - angle) * inwards <= 0.0:
            return end, by, True
        turns_along_path(task, angle, arm, scratch.work)
        path_margins(task, scratch.work, wrist, scratch.work_margins)
        turns, margins = scratch.work, scratch.work_margins
    return end, by, False


@kernel
def worst_constraint(task, turns, wrist, first, last, margins):
    """The constraint with the smallest margin below zero, its row and its margin; -1 if none is."""
    worst, row, least = -1, 0, 0.0
    for i in range(first, last):
        if margins[i] < least:
            worst, least = i, margins[i]
    if 0 <= worst < JUMP:
        least = math.inf
        for n in range(len(task.retreats)):
            value = row_margin(task, turns, n, wrist, worst)
            if value < least:
                row, least = n, value
    return worst, row, least


@kernel
def single_margin(task, scratch, angle, row, arm, wrist, i):
    """One constraint's margin at one angle in one row of the cut-in; the jump is the path's."""
    if i == JUMP:
        turns_along_path(task, angle, arm, scratch.single_path)
        return jump_margin(task, scratch.single_path, wrist)
    g, circle = unpack_geometry(task.numbers), unpack_circle(task.numbers)
    shoulder, elbow = arm // 2, 1.0 - 2.0 * (arm % 2)
    retreat = task.retreats[row]
    write_turns(
        g, circle, math.cos(angle), math.sin(angle), retreat, shoulder, elbow, scratch.single, 0
    )
    return row_margin(task, scratch.single, 0, wrist, i)


@kernel
def root(task, scratch, arm, wrist, i, row, broken, f_broken, met, f_met):
    """The angle next to the root of a constraint's row, on the side where it is met.

    Chandrupatla's method: inverse quadratic interpolation where that is safe, else bisection.
    """
    x1, f1, x2, f2 = broken, f_broken, met, f_met
    kept, t = met, f1 / (f1 - f2)
    for _ in range(100):
        x3 = x1 + t * (x2 - x1)
        f3 = single_margin(task, scratch, x3, row, arm, wrist, i)
        if (f3 >= 0.0) == (f1 >= 0.0):
            x0, f0 = x1, f1
        else:
            x0, f0 = x2, f2
            x2, f2 = x1, f1
        x1, f1 = x3, f3
        kept = x1 if f1 >= 0.0 else x2
        width = abs(x1 - x2)
        if width <= ARC_END_RAD * (1.0 + abs(kept)):
            break
        xi, phi = (x1 - x2) / (x0 - x2), (f1 - f2) / (f0 - f2)
        if phi * phi < xi and (1.0 - phi) * (1.0 - phi) < 1.0 - xi:
            t = f1 / (f2 - f1) * f0 / (f2 - f0)
            t += (x0 - x1) / (x2 - x1) * f1 / (f0 - f1) * f2 / (f0 - f2)
        else:
            t = 0.5
        least = 0.5 * ARC_END_RAD / width
        t = min(max(t, least), 1.0 - least)
    return kept
