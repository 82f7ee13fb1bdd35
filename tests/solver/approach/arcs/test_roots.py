"""Roots and extremes of margins that are told, and what is worst along a cut-in."""

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solver.approach.arcs import roots
from solver.approach.arcs.roots import (
    WHOLE_CUT_IN,
    arc_scratch,
    extreme_margin,
    fastest_row,
    pull_in,
    root,
    single_margin,
    stretched,
    worst_constraint,
)
from solver.approach.arcs.turns import (
    CONSTRAINTS,
    TURN_ROWS,
    jump_margin,
    row_margin,
    row_room,
    turns_along_path,
)
from solver.approach.task.constraints import BESIDE, JUMP, REACH
from solver.approach.task.packed import unpack_geometry
from tests.solver.interpreted import interpreted
from tests.solver.methods.synthetic import small_task

Margin = Callable[[float], float]
TASK = small_task(2).packed(1)
ROWS = len(TASK.retreats)
GEOMETRY = unpack_geometry(TASK.numbers)


def told(monkeypatch: pytest.MonkeyPatch, margin: Margin) -> list[float]:
    """The margin of constraint 3 in row 1 on arm 2 and wrist 1; the angles asked."""
    asked: list[float] = []

    def stand_in(task: object, scratch: object, angle: float, row: int, arm: int, wrist: int,
                 i: int) -> float:  # fmt: skip
        assert (row, arm, wrist, i) == (1, 2, 1, 3)
        asked.append(angle)
        return margin(angle)

    monkeypatch.setattr(roots, "single_margin", stand_in)
    return asked


@pytest.mark.parametrize("i", [*range(6), REACH, BESIDE, JUMP])
def test_a_single_margin_is_that_of_its_row_on_the_path(i: int) -> None:
    scratch, angle = arc_scratch(ROWS), 0.13
    for arm, wrist, row in ((0, 1, 0), (1, 0, 4), (2, 1, ROWS - 1), (3, 0, 2)):
        found = single_margin(TASK, scratch, angle, row, arm, wrist, i)
        turns = np.empty((TURN_ROWS, 24))
        turns_along_path(TASK, angle, arm, turns)
        if i == JUMP:
            assert found == pytest.approx(row_room(GEOMETRY, turns, row), abs=1e-12)
        else:
            assert found == pytest.approx(row_margin(TASK, turns, row, wrist, i), abs=1e-12)


def test_the_jump_s_in_the_whole_cut_in_is_the_path_s() -> None:
    """In the rows and between them, so it is not above that of any row."""
    assert WHOLE_CUT_IN == -1
    scratch, angle = arc_scratch(ROWS), 0.13
    for arm, wrist in ((0, 1), (1, 0), (2, 1), (3, 0)):
        found = single_margin(TASK, scratch, angle, WHOLE_CUT_IN, arm, wrist, JUMP)
        turns = np.empty((TURN_ROWS, 24))
        turns_along_path(TASK, angle, arm, turns)
        assert found == jump_margin(TASK, turns, wrist)
        rows = [single_margin(TASK, scratch, angle, row, arm, wrist, JUMP) for row in range(ROWS)]
        assert found <= min(rows) + 1e-12
        assert max(rows) > min(rows) + 1e-6


def extreme(low: float, high: float, sign: float, bracket: float) -> tuple[float, float]:
    found = interpreted(extreme_margin)(TASK, None, 2, 1, 3, 1, low, high, sign, bracket)
    return float(found[0]), float(found[1])


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("at", [0.21, 0.5, 0.77])
def test_an_extreme_that_stays_below_zero_is_closed_in_on(
    monkeypatch: pytest.MonkeyPatch, sign: float, at: float
) -> None:
    asked = told(monkeypatch, lambda angle: -sign * (0.1 + (angle - at) ** 2))
    where, value = extreme(0.2, 0.8, sign, 1e-6)
    assert where == pytest.approx(at, abs=1e-6)
    assert value == pytest.approx(-0.1, abs=1e-10)
    # The golden section: each look leaves 0.618 of what was left.
    looks = math.ceil(math.log(1e-6 / 0.6) / math.log((math.sqrt(5) - 1) / 2)) + 2
    assert len(asked) in (looks - 1, looks)
    assert asked[:2] == pytest.approx([0.8 - 0.618034 * 0.6, 0.2 + 0.618034 * 0.6])
    assert min(asked) >= 0.2
    assert max(asked) <= 0.8


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_extreme_beyond_zero_ends_the_search(
    monkeypatch: pytest.MonkeyPatch, sign: float
) -> None:
    asked = told(monkeypatch, lambda angle: sign * (0.01 - (angle - 0.3) ** 2))
    where, value = extreme(0.0, 1.0, sign, 1e-9)
    assert value > 0.0
    assert abs(where - 0.3) < 0.1
    assert len(asked) <= 4
    asked.clear()
    extreme(0.2, 0.45, sign, 1e-9)
    assert len(asked) == 2


CURVES: dict[str, Margin] = {
    "line": lambda x: x - 0.3,
    "cubic": lambda x: (x - 0.3) ** 3 + 0.01 * (x - 0.3),
    "root like": lambda x: math.copysign(math.sqrt(abs(x - 0.3)), x - 0.3),
    "flat then steep": lambda x: math.exp(30 * (x - 0.3)) - 1,
    "step": lambda x: 1.0 if x >= 0.3 else -1e-6,
}


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize(("broken", "met"), [(0.0, 1.0), (0.2, 0.31), (-5.0, 0.300001)])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_root_is_told_from_the_side_where_it_is_met(
    monkeypatch: pytest.MonkeyPatch, name: str, broken: float, met: float, mirrored: bool
) -> None:
    """To 1e-15, with few looks where the curve is smooth."""
    curve = CURVES[name]
    flip = -1.0 if mirrored else 1.0

    def margin(x: float) -> float:
        return curve(flip * x)

    asked = told(monkeypatch, margin)
    a, b = flip * broken, flip * met
    found = interpreted(root)(TASK, None, 2, 1, 3, 1, a, margin(a), b, margin(b))
    assert flip * found == pytest.approx(0.3, abs=2e-15)
    assert margin(found) >= 0.0
    assert len(asked) <= (12 if name == "line" else 70)
    assert len(asked) <= 25 or name != "cubic"
    low, high = sorted((a, b))
    assert all(low <= angle <= high for angle in asked)


def test_the_worst_constraint_and_its_row_are_told() -> None:
    margins = np.full(CONSTRAINTS, 0.1)
    turns = np.full((TURN_ROWS, 24), 0.5)
    assert worst_constraint(TASK, turns, 0, 0, CONSTRAINTS, margins) == (-1, 0, 0.0)
    turns[6 + REACH, 3], turns[6 + REACH, 5] = -0.2, -0.1
    turns[6 + BESIDE, 7] = -0.3
    margins[REACH], margins[BESIDE], margins[JUMP] = -0.2, -0.3, -0.25
    assert worst_constraint(TASK, turns, 0, 0, CONSTRAINTS, margins) == (BESIDE, 7, -0.3)
    assert worst_constraint(TASK, turns, 0, REACH, JUMP, margins) == (BESIDE, 7, -0.3)
    assert worst_constraint(TASK, turns, 0, REACH, BESIDE, margins) == (REACH, 3, -0.2)
    margins[JUMP] = -0.4
    worst = worst_constraint(TASK, turns, 0, 0, CONSTRAINTS, margins)
    assert worst == (JUMP, WHOLE_CUT_IN, -0.4)
    margins[0] = -5.0
    turns[0], turns[1] = 1.0, 0.0
    turns[0, 6], turns[1, 6] = -1.0, 0.0
    worst, row, least = worst_constraint(TASK, turns, 0, 0, CONSTRAINTS, margins)
    rows = [row_margin(TASK, turns, n, 0, 0) for n in range(ROWS)]
    assert (worst, row, least) == (0, int(np.argmin(rows)), min(rows))
    margins[:] = 0.0
    assert worst_constraint(TASK, turns, 0, 0, CONSTRAINTS, margins)[0] == -1


def beside_a_stretched_elbow(row: int) -> np.ndarray:
    """A cut-in's turns whose elbow is all but stretched in one row: joints are too fast there."""
    turns = np.zeros((TURN_ROWS, 24))
    turns_along_path(TASK, 0.15, 1, turns)
    angle = 1e-3 - GEOMETRY.beta
    turns[4, row], turns[5, row] = math.cos(angle), math.sin(angle)
    return turns


@pytest.mark.parametrize("row", [0, 6, ROWS - 1])
def test_the_fastest_row_has_the_least_room(row: int) -> None:
    turns = beside_a_stretched_elbow(row)
    rooms = [row_room(GEOMETRY, turns, n) for n in range(ROWS)]
    assert fastest_row(TASK, turns) == (row, min(rooms))
    assert (int(np.argmin(rooms)), min(rooms) < 0.0) == (row, True)
    plain = np.zeros((TURN_ROWS, 24))
    turns_along_path(TASK, 0.15, 1, plain)
    rooms = [row_room(GEOMETRY, plain, n) for n in range(ROWS)]
    assert fastest_row(TASK, plain) == (int(np.argmin(rooms)), min(rooms))
    # Columns beyond the cut-in's rows are not rows of it.
    assert plain.shape[1] > ROWS
    plain[:, ROWS:] = turns[:, [row]]
    assert fastest_row(TASK, plain) == (int(np.argmin(rooms)), min(rooms))


def test_a_jump_is_told_in_its_fastest_row_or_between_rows() -> None:
    """The margin is the path's in either case; the row is where that margin is met."""
    turns, margins = beside_a_stretched_elbow(6), np.full(CONSTRAINTS, 0.1)
    room = fastest_row(TASK, turns)[1]
    for least, row in ((room, 6), (room + 1e-9, 6), (room - 1e-9, WHOLE_CUT_IN)):
        margins[JUMP] = least
        worst = worst_constraint(TASK, turns, 0, 0, CONSTRAINTS, margins)
        assert worst == (JUMP, row, least)
        assert worst_constraint(TASK, turns, 0, 0, JUMP, margins)[0] == -1
    # Another one that is worse is told instead.
    turns[6 + REACH, 3] = margins[REACH] = room - 1.0
    assert worst_constraint(TASK, turns, 0, 0, CONSTRAINTS, margins) == (REACH, 3, room - 1.0)


@pytest.mark.parametrize(("row", "met"), [(2, 0.7), (0, 0.7), (WHOLE_CUT_IN, 0.3)])
def test_a_jump_is_closed_in_on_in_its_row_alone(
    monkeypatch: pytest.MonkeyPatch, row: int, met: float
) -> None:
    """Between the row's own rooms at both ends; between rows, the path's."""
    asked: list[tuple[Any, ...]] = []
    start, end, work = "at start", "at end", "work"

    def worst(task: object, turns: object, *_: object) -> tuple[int, int, float]:
        return (JUMP, row, -0.2) if turns == start else (-1, 0, 0.0)

    def room(geometry: object, turns: object, n: int) -> float:
        assert (turns, n) == (end, row)
        return 0.7

    def root_of(task: object, scratch: object, *given: Any) -> float:
        asked.append(given)
        return 0.4

    monkeypatch.setattr(roots, "worst_constraint", worst)
    monkeypatch.setattr(roots, "row_room", room)
    monkeypatch.setattr(roots, "root", root_of)
    monkeypatch.setattr(roots, "turns_along_path", lambda *_: None)
    monkeypatch.setattr(roots, "path_margins", lambda *_: None)
    monkeypatch.setattr(roots, "stretched", lambda *_: False)
    scratch = SimpleNamespace(work=work, work_margins=None)

    def pulled(jump_at_start: float, jump_at_end: float) -> tuple[float, int, bool]:
        at_start, at_end = np.full(CONSTRAINTS, 9.0), np.full(CONSTRAINTS, 9.0)
        at_start[JUMP], at_end[JUMP] = jump_at_start, jump_at_end
        found: tuple[float, int, bool] = interpreted(pull_in)(
            TASK, scratch, 2, 1, 0, CONSTRAINTS, 0.0, 1.0, start, end, at_start, at_end
        )
        return found

    assert pulled(-0.2, 0.3) == (0.4, JUMP, True)
    assert asked == [(2, 1, JUMP, row, 0.0, -0.2, 1.0, met)]
    # Whether the cell has a feasible part, and behaves, is still told by all of the cut-in.
    assert pulled(-0.2, -0.1) == (1.0, JUMP, True)
    assert pulled(0.1, 0.3) == (1.0, JUMP, False)
    assert len(asked) == 1


@pytest.mark.parametrize(("elbow", "expected"), [(0.09, True), (-0.09, True), (0.11, False)])
@pytest.mark.parametrize("folded", [0.0, math.pi])
def test_an_elbow_is_stretched_where_joints_turn_fastest(
    elbow: float, expected: bool, folded: float
) -> None:
    """Within 0.1 rad of straight, or of folded."""
    turns = np.zeros((TURN_ROWS, 24))
    turns_along_path(TASK, 0.15, 1, turns)
    geometry = small_task(2).for_kernels(1).geometry
    angle = elbow + folded - geometry.beta
    turns[4, 6], turns[5, 6] = math.cos(angle), math.sin(angle)
    assert stretched(TASK, turns) == expected
    turns_along_path(TASK, 0.15, 1, turns)
    assert not stretched(TASK, turns)
