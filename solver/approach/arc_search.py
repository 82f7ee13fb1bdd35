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

from solver.approach.packed import unpack_circle, unpack_geometry
from solver.approach.turns import (
    CONSTRAINTS,
    JUMP,
    TURN_ROWS,
    path_margins,
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
    EXTREME_ANGLE_RAD,
    NARROWEST_CELL_RAD,
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

DEAD, FULL, CROSSED, EXTREME = 0, 1, 2, 3


class ArcScratch(NamedTuple):
    """Working memory of the kernels, one for a thread; nothing in it outlives a call."""

    thinning: Array
    standby: Array
    cosines: Array
    sines: Array
    paths: Array
    margins: Array
    cell_paths: Array
    cell_margins: Array
    single: Array
    work: Array
    work_margins: Array


@kernel
def arc_scratch(rows):
    """Working memory for cut-ins of that many rows."""
    return ArcScratch(
        np.empty((TURN_ROWS, ARC_CELLS)),
        np.empty((TURN_ROWS, ARC_CELLS)),
        np.empty(ARC_CELLS),
        np.empty(ARC_CELLS),
        np.empty((ARC_CELLS, TURN_ROWS, rows)),
        np.empty((2, ARC_CELLS, CONSTRAINTS)),
        np.empty((4, TURN_ROWS, rows)),
        np.empty((4, CONSTRAINTS)),
        np.empty((TURN_ROWS, 1)),
        np.empty((TURN_ROWS, rows)),
        np.empty(CONSTRAINTS),
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
def cell_state(before, left, right, after):
    """DEAD, FULL, CROSSED or EXTREME for one constraint's values at four evenly spaced angles."""
    if left < 0.0 and right < 0.0:
        return DEAD if peak_above(before, left, right, after) < 0.0 else EXTREME
    if left >= 0.0 and right >= 0.0:
        return FULL if peak_above(-before, -left, -right, -after) <= 0.0 else EXTREME
    return CROSSED


@kernel
def close_cells(task, turns, column, wrist, open_cells):
    """Closes cells in which a constraint of one row is certainly negative; returns how many stay.

    `column` has the column of each node in turns.
    """
    left_open = 0
    for k in range(ARC_CELLS):
        if not open_cells[k]:
            continue
        before, left = column[(k - 1) % ARC_CELLS], column[k]
        right, after = column[(k + 1) % ARC_CELLS], column[(k + 2) % ARC_CELLS]
        for i in range(7):
            a = row_margin(task, turns, left, wrist, i)
            b = row_margin(task, turns, right, wrist, i)
            if a < 0.0 and b < 0.0:
                outer_a = row_margin(task, turns, before, wrist, i)
                outer_b = row_margin(task, turns, after, wrist, i)
                if peak_above(outer_a, a, b, outer_b) < 0.0 and not _swung(turns, left, right, i):
                    open_cells[k] = False
                    break
        left_open += open_cells[k]
    return left_open


@kernel
def _swung(turns, left, right, i):
    if i > 5:
        return False
    change = (
        turns[2 * i, left] * turns[2 * i, right] + turns[2 * i + 1, left] * turns[2 * i + 1, right]
    )
    return change < CELL_SWING_COSINE


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
        some = 0
        for wrist in range(2):
            some += close_cells(task, scratch.thinning, column, wrist, open_cells[wrist])
        if some == 0:
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
        some = 0
        for wrist in range(2):
            some += close_cells(task, scratch.standby, column, wrist, open_cells[wrist])
        if some == 0:
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
    margins, rows = scratch.margins[wrist], len(task.retreats)
    for k in range(ARC_CELLS):
        if not open_cells[k]:
            continue
        after = (k + 1) % ARC_CELLS
        outer, beyond = margins[(k - 1) % ARC_CELLS], margins[(k + 2) % ARC_CELLS]
        left, right = margins[k], margins[after]
        state = EXTREME
        if not swings(scratch.paths[k], scratch.paths[after], rows, CELL_SWING_COSINE):
            state, _ = path_state(outer, left, right, beyond)
        low, high = _ANGLES[k], _ANGLES[k + 1]
        if state == FULL:
            count = append_arc(arcs, start, count, arm, wrist, low, high, JUMP, JUMP)
        elif state == CROSSED:
            clean, a, b, by_a, by_b = tighten(
                task, scratch, arm, wrist, low, high, scratch.paths[k], scratch.paths[after],
                left, right,
            )  # fmt: skip
            if not clean:
                count = settle(task, scratch, arm, wrist, low, high, arcs, start, count)
            elif a < b:
                count = append_arc(arcs, start, count, arm, wrist, a, b, by_a, by_b)
        elif state == EXTREME:
            count = settle(task, scratch, arm, wrist, low, high, arcs, start, count)
    return close_turn(arcs, start, count)


@kernel
def path_state(before, left, right, after):
    """State of a cell from all constraints, and the constraint that makes it EXTREME."""
    state, extreme = FULL, -1
    for i in range(CONSTRAINTS):
        own = cell_state(before[i], left[i], right[i], after[i])
        if own == DEAD:
            return DEAD, -1
        if own == EXTREME:
            extreme = i
        elif own == CROSSED:
            state = CROSSED
    return (EXTREME, extreme) if extreme >= 0 else (state, -1)


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
def settle(task, scratch, arm, wrist, low, high, arcs, start, count):
    """Appends the feasible pieces of a cell that has to be split; returns the new count."""
    stack = np.empty((64, 2))
    stack[0, 0], stack[0, 1] = low, high
    top = 1
    paths, margins, rows = scratch.cell_paths, scratch.cell_margins, len(task.retreats)
    while top > 0:
        top -= 1
        a, b = stack[top, 0], stack[top, 1]
        width = b - a
        for m in range(4):
            angle = a + (m - 1) * width if m != 2 else b
            turns_along_path(task, angle, arm, paths[m])
            path_margins(task, paths[m], wrist, margins[m])
        middle = (a + b) / 2
        if swings(paths[1], paths[2], rows, CELL_SWING_COSINE):
            if width < NARROWEST_CELL_RAD:
                continue  # the straight wrist itself: no angle here keeps its branch
        else:
            state, extreme = path_state(margins[0], margins[1], margins[2], margins[3])
            if state == DEAD:
                continue
            if state == EXTREME:
                sign = 1.0 if margins[1, extreme] < 0.0 else -1.0
                middle, value = extreme_margin(task, scratch, arm, wrist, extreme, a, b, sign)
                if sign > 0.0 and value < 0.0:
                    continue
                if sign < 0.0 and value <= 0.0:
                    middle = (a + b) / 2
                    state, _ = sign_state(margins[1], margins[2]), 0
            if state == FULL:
                count = append_arc(arcs, start, count, arm, wrist, a, b, JUMP, JUMP)
                continue
            if state == CROSSED:
                clean, c, d, by_c, by_d = tighten(
                    task, scratch, arm, wrist, a, b, paths[1], paths[2], margins[1], margins[2]
                )
                if clean:
                    if c < d:
                        count = append_arc(arcs, start, count, arm, wrist, c, d, by_c, by_d)
                    continue
            if width < NARROWEST_CELL_RAD:
                continue
        if top + 2 > len(stack):
            continue
        stack[top, 0], stack[top, 1] = middle, b
        stack[top + 1, 0], stack[top + 1, 1] = a, middle
        top += 2
    return count


@kernel
def sign_state(left, right):
    """State by the signs at both ends alone: FULL, CROSSED, or DEAD with one negative at both."""
    state = FULL
    for i in range(CONSTRAINTS):
        if left[i] < 0.0 and right[i] < 0.0:
            return DEAD
        if (left[i] < 0.0) != (right[i] < 0.0):
            state = CROSSED
    return state


@kernel
def constraint_at(task, scratch, angle, arm, wrist, i):
    """One constraint's margin over the whole cut-in at one angle."""
    turns_along_path(task, angle, arm, scratch.work)
    path_margins(task, scratch.work, wrist, scratch.work_margins)
    return scratch.work_margins[i]


@kernel
def extreme_margin(task, scratch, arm, wrist, i, low, high, sign):
    """Golden section for the largest (sign 1) or smallest (-1) margin; stops where it crosses 0.

    Returns the angle and sign times the margin there.
    """
    a, b = low, high
    x1, x2 = b - _GOLDEN * (b - a), a + _GOLDEN * (b - a)
    f1 = sign * constraint_at(task, scratch, x1, arm, wrist, i)
    f2 = sign * constraint_at(task, scratch, x2, arm, wrist, i)
    while b - a > EXTREME_ANGLE_RAD and max(f1, f2) <= 0.0:
        if f1 >= f2:
            b, x2, f2 = x2, x1, f1
            x1 = b - _GOLDEN * (b - a)
            f1 = sign * constraint_at(task, scratch, x1, arm, wrist, i)
        else:
            a, x1, f1 = x1, x2, f2
            x2 = a + _GOLDEN * (b - a)
            f2 = sign * constraint_at(task, scratch, x2, arm, wrist, i)
    return (x1, f1) if f1 >= f2 else (x2, f2)


@kernel
def tighten(task, scratch, arm, wrist, low, high, left_path, right_path, left, right):
    """The feasible part of a cell in which every constraint has one root at most.

    Returns whether that held, the part's ends (the first is not the lower where there is none) and
    the constraints that end it.
    """
    a, by_a, clean = pull_in(task, scratch, arm, wrist, low, high, left_path, left, right)
    if not clean:
        return False, low, high, JUMP, JUMP
    if a >= high:
        return True, high, low, JUMP, JUMP
    b, by_b, clean = pull_in(task, scratch, arm, wrist, high, low, right_path, right, left)
    return clean, a, b, by_a, by_b


@kernel
def pull_in(task, scratch, arm, wrist, start, end, path, margins, at_end):
    """Moves from one end of a cell inwards until no constraint that is met at the other is broken.

    Returns the angle, `end` where the cell has no feasible part, the constraint that was met last,
    and whether the cell behaves: constraints met at both ends are met at the angle.
    """
    angle, by = start, JUMP
    now, turns = margins, path
    inwards = 1.0 if end > start else -1.0
    for _ in range(4 * CONSTRAINTS):
        worst, least = -1, 0.0
        for i in range(CONSTRAINTS):
            if now[i] < least:
                if at_end[i] < 0.0:
                    return end, i, True
                if margins[i] >= 0.0:
                    return end, i, False
                worst, least = i, now[i]
        if worst < 0:
            return angle, by, True
        found = root(task, scratch, arm, wrist, worst, angle, end, turns)
        if found == angle:
            found = angle + inwards * ARC_END_RAD
        angle, by = found, worst
        if (end - angle) * inwards <= 0.0:
            return end, by, True
        turns_along_path(task, angle, arm, scratch.work)
        path_margins(task, scratch.work, wrist, scratch.work_margins)
        now, turns = scratch.work_margins, scratch.work
    return end, by, False


@kernel
def single_margin(task, scratch, angle, row, arm, wrist, i):
    """One constraint's margin at one angle in one row of the cut-in; the jump is the path's."""
    if i == JUMP:
        return constraint_at(task, scratch, angle, arm, wrist, i)
    g, circle = unpack_geometry(task.numbers), unpack_circle(task.numbers)
    shoulder, elbow = arm // 2, 1.0 - 2.0 * (arm % 2)
    retreat = task.retreats[row]
    write_turns(
        g, circle, math.cos(angle), math.sin(angle), retreat, shoulder, elbow, scratch.single, 0
    )
    return row_margin(task, scratch.single, 0, wrist, i)


@kernel
def worst_row(task, turns, wrist, i):
    """The row of a cut-in in which a constraint is smallest, and its margin."""
    row, least = 0, math.inf
    for n in range(len(task.retreats)):
        value = row_margin(task, turns, n, wrist, i)
        if value < least:
            row, least = n, value
    return row, least


@kernel
def root(task, scratch, arm, wrist, i, broken, met, turns):
    """The angle next to the root of a constraint, on the side where it is met.

    The root is that of the row that is worst where it is broken. Chandrupatla's method: inverse
    quadratic interpolation where that is safe, bisection elsewhere.
    """
    row, f_broken = 0, 0.0
    if i == JUMP:
        f_broken = constraint_at(task, scratch, broken, arm, wrist, i)
    else:
        row, f_broken = worst_row(task, turns, wrist, i)
    x1, f1 = broken, f_broken
    x2 = met
    f2 = single_margin(task, scratch, met, row, arm, wrist, i)
    if f2 < 0.0 or f1 >= 0.0:
        return met if f2 >= 0.0 and f1 >= 0.0 and broken == met else broken
    t = f1 / (f1 - f2)
    lost, kept = x1, x2
    for _ in range(100):
        x3 = x1 + t * (x2 - x1)
        f3 = single_margin(task, scratch, x3, row, arm, wrist, i)
        if (f3 >= 0.0) == (f1 >= 0.0):
            x0, f0 = x1, f1
        else:
            x0, f0 = x2, f2
            x2, f2 = x1, f1
        x1, f1 = x3, f3
        if f1 >= 0.0:
            kept, lost = x1, x2
        else:
            kept, lost = x2, x1
        width = abs(kept - lost)
        if width <= ARC_END_RAD:
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
