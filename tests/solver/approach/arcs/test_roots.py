"""Roots and extremes of margins that are told, and what is worst along a cut-in."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from solver.approach.arcs import roots
from solver.approach.arcs.roots import (
    arc_scratch,
    extreme_margin,
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
    turns_along_path,
)
from solver.approach.task.constraints import BESIDE, JUMP, REACH
from tests.solver.interpreted import interpreted
from tests.solver.methods.synthetic import small_task

Margin = Callable[[float], float]
TASK = small_task(2).packed(1)
ROWS = len(TASK.retreats)


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
            assert found == jump_margin(TASK, turns, wrist)
        else:
            assert found == pytest.approx(row_margin(TASK, turns, row, wrist, i), abs=1e-12)


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
    assert worst_constraint(TASK, turns, 0, 0, CONSTRAINTS, margins) == (JUMP, 0, -0.4)
    margins[0] = -5.0
    turns[0], turns[1] = 1.0, 0.0
    turns[0, 6], turns[1, 6] = -1.0, 0.0
    worst, row, least = worst_constraint(TASK, turns, 0, 0, CONSTRAINTS, margins)
    rows = [row_margin(TASK, turns, n, 0, 0) for n in range(ROWS)]
    assert (worst, row, least) == (0, int(np.argmin(rows)), min(rows))
    margins[:] = 0.0
    assert worst_constraint(TASK, turns, 0, 0, CONSTRAINTS, margins)[0] == -1


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
