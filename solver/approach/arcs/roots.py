"""Kernels: where in a cell constraints change sign, and where one has an extremum."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple, cast

import numpy as np

from solver.approach.arcs.cells import ARC_NODES
from solver.approach.arcs.tolerances import (
    ARC_END_RAD,
    PULL_IN_STEPS,
    ROOT_STEPS,
    STRETCHED_SINE,
)
from solver.approach.arcs.turns import (
    CONSTRAINTS,
    ROW_CONSTRAINTS,
    TURN_ROWS,
    jump_margin,
    path_columns,
    path_margins,
    row_margin,
    row_room,
    turns_along_path,
    write_turns,
)
from solver.approach.task.constraints import JUMP, REACH
from solver.approach.task.packed import unpack_geometry
from solver.approach.tolerances import ARC_CELLS
from solver.compiled import NONE_YET, kernel
from solver.robots.model import Array

ARMS = 4
"""Branches but for the wrist: shoulder and elbow."""

CELL_SLOTS = 8
"""Cut-ins that are kept while a cell is split: a cell takes four, of which its halves use three."""

WHOLE_CUT_IN = cast(int, np.int64(-1))
"""In place of a row: all of them, and what is between them."""

_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


class ArcScratch(NamedTuple):
    """Working memory of the kernels, one for a thread; nothing in it outlives a call."""

    thinning: Array
    standby: Array
    values: Array
    highest: Array
    open_cells: Array
    paths: Array
    known_paths: Array
    margins: Array
    known_margins: Array
    cell_angles: Array
    cell_ages: Array
    cell_paths: Array
    cell_margins: Array
    cell_known_margins: Array
    single: Array
    work: Array
    work_margins: Array
    single_path: Array
    reference: Array


@kernel
def arc_scratch(rows):
    """Working memory for cut-ins of that many rows."""
    return ArcScratch(
        np.empty((ARMS, TURN_ROWS, ARC_NODES)),
        np.empty((TURN_ROWS, ARC_NODES)),
        np.empty((ROW_CONSTRAINTS, ARC_NODES)),
        np.empty((3, ARC_CELLS)),
        np.empty((ARMS, 2, ARC_CELLS), dtype=np.bool_),
        np.empty((ARMS, ARC_CELLS, TURN_ROWS, path_columns(rows))),
        np.empty((ARMS, ARC_CELLS), dtype=np.bool_),
        np.empty((ARMS, 2, ARC_CELLS, CONSTRAINTS)),
        np.empty((ARMS, 2, ARC_CELLS), dtype=np.bool_),
        np.empty(CELL_SLOTS),
        np.empty(CELL_SLOTS, dtype=np.int64),
        np.empty((CELL_SLOTS, TURN_ROWS, path_columns(rows))),
        np.empty((CELL_SLOTS, CONSTRAINTS)),
        np.empty(CELL_SLOTS, dtype=np.bool_),
        np.empty((TURN_ROWS, 1)),
        np.empty((TURN_ROWS, path_columns(rows))),
        np.empty(CONSTRAINTS),
        np.empty((TURN_ROWS, path_columns(rows))),
        np.empty((6, 2)),
    )


@kernel
def single_margin(task, scratch, angle, row, arm, wrist, i):
    """One constraint's margin at one angle in one row of the cut-in.

    The jump's is the room of the rates in that row, or in WHOLE_CUT_IN that of all of them and
    between them.
    """
    if i == JUMP and row < 0:
        turns_along_path(task, angle, arm, scratch.single_path)
        return jump_margin(task, scratch.single_path, wrist)
    turns = scratch.single
    turns[0, 0], turns[1, 0], turns[2, 0] = math.cos(angle), math.sin(angle), task.retreats[row]
    write_turns(task, 1, arm, turns)
    if i == JUMP:
        return row_room(unpack_geometry(task.numbers), turns, 0)
    return row_margin(task, turns, 0, wrist, i)


@kernel
def extreme_margin(task, scratch, arm, wrist, i, row, low, high, sign, bracket):
    """Golden section for the largest (sign 1) or smallest (-1) margin; stops where it crosses 0.

    It ends in a bracket that narrow [rad].

    Returns the angle and sign times the margin there.
    """
    a, b = low, high
    x1, x2 = b - _GOLDEN * (b - a), a + _GOLDEN * (b - a)
    f1 = sign * single_margin(task, scratch, x1, row, arm, wrist, i)
    f2 = sign * single_margin(task, scratch, x2, row, arm, wrist, i)
    while b - a > bracket and max(f1, f2) <= 0.0:
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
def root(task, scratch, arm, wrist, i, row, broken, f_broken, met, f_met):
    """The angle next to the root of a constraint's row, on the side where it is met.

    Chandrupatla's method: inverse quadratic interpolation where that is safe, else bisection.
    """
    x1, f1, x2, f2 = broken, f_broken, met, f_met
    kept, t = met, f1 / (f1 - f2)
    for _ in range(ROOT_STEPS):
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


@kernel
def fastest_row(task, turns):
    """The row of the cut-in where joints have the least room below the highest rate, and that."""
    g, fastest, least = unpack_geometry(task.numbers), NONE_YET, math.inf
    for n in range(len(task.retreats)):
        room = row_room(g, turns, n)
        if room < least:
            fastest, least = n, room
    return fastest, least


@kernel
def worst_constraint(task, turns, wrist, first, last, margins):
    """The constraint with the smallest margin below zero, its row and its margin; -1 if none is.

    The row is WHOLE_CUT_IN where joints are too fast between rows.
    """
    worst, row, least = -1, NONE_YET, 0.0
    for i in range(first, last):
        if margins[i] < least:
            worst, least = i, margins[i]
    if 0 <= worst < JUMP:
        least = math.inf
        for n in range(len(task.retreats)):
            value = row_margin(task, turns, n, wrist, worst)
            if value < least:
                row, least = n, value
    if worst == JUMP:
        row, room = fastest_row(task, turns)
        row = row if room <= least else WHOLE_CUT_IN
    return worst, row, least


@kernel
def stretched(task, turns):
    """Whether the elbow is all but stretched or folded in the row where joints turn fastest."""
    g = unpack_geometry(task.numbers)
    fastest, _ = fastest_row(task, turns)
    cos3, sin3 = turns[4, fastest], turns[5, fastest]
    return abs(sin3 * g.cos_beta + cos3 * g.sin_beta) < STRETCHED_SINE


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
    for _ in range(PULL_IN_STEPS * CONSTRAINTS):
        worst, row, least = worst_constraint(task, turns, wrist, first, last, margins)
        if worst < 0:
            if by == JUMP and angle != start and stretched(task, turns):
                by = REACH
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
        if worst == JUMP and row >= 0:
            at_other = row_room(unpack_geometry(task.numbers), at_end, row)
        found = root(task, scratch, arm, wrist, worst, row, angle, least, end, at_other)
        angle, by = found if found != angle else angle + inwards * ARC_END_RAD, worst
        if (end - angle) * inwards <= 0.0:
            return end, by, True
        turns_along_path(task, angle, arm, scratch.work)
        path_margins(task, scratch.work, wrist, scratch.work_margins)
        turns, margins = scratch.work, scratch.work_margins
    return end, by, False


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
