"""What is suspected between even rows of curves that are known."""

import math

import numpy as np
import pytest

from solver.approach.cut_in.between_rows import may_fall_below_zero_between, may_leave_between
from solver.approach.cut_in.tolerances import (
    BETWEEN_ROWS_CUSHION,
    BETWEEN_ROWS_REACH,
    MARGIN_CUSHION,
    MARGIN_REACH,
)

LOWER, UPPER = np.full(3, -1.0), np.full(3, 1.0)


def rows_of(joint: int, values: np.ndarray) -> np.ndarray:
    rows = np.zeros((len(values), 3))
    rows[:, joint] = values
    return rows


def parabola(top: float, at: float, bend: float, count: int = 6) -> np.ndarray:
    """Rows of a parabola with its vertex at a row number, of a second difference."""
    return np.asarray(top + bend / 2 * (np.arange(count) - at) ** 2)


@pytest.mark.parametrize("joint", range(3))
@pytest.mark.parametrize("at", [0.5, 1.3, 2.5, 3.75, 4.5])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_vertex_between_rows_beyond_a_limit_is_suspected(
    joint: int, at: float, sign: float
) -> None:
    """With a cushion that goes with the bend."""
    cushion = BETWEEN_ROWS_CUSHION * 0.1
    for away, expected in ((0.01, True), (-0.9 * cushion, True), (-1.1 * cushion, False)):
        values = sign * parabola(1.0 + away, at, -0.1)
        assert may_leave_between(rows_of(joint, values), LOWER, UPPER) == expected
    assert not may_leave_between(rows_of(joint, sign * parabola(-0.9, at, 0.1)), LOWER, UPPER)


def test_a_vertex_outside_the_rows_is_none() -> None:
    reach = BETWEEN_ROWS_REACH
    for at, expected in ((-reach - 0.1, False), (5 + reach + 0.1, False), (-reach + 0.1, True)):
        values = parabola(1.0, at, -0.1)
        values += 1.0 - max(values[0], values[-1])
        assert may_leave_between(rows_of(1, values), LOWER, UPPER) == expected
    steady = np.linspace(0.0, 1.0, 6)
    assert not may_leave_between(rows_of(1, steady), LOWER, UPPER)
    assert not may_leave_between(rows_of(1, np.full(6, 1.0)), LOWER, UPPER)


def test_two_rows_tell_nothing_of_what_lies_between() -> None:
    assert may_leave_between(np.zeros((2, 3)), LOWER, UPPER)
    assert not may_leave_between(np.zeros((3, 3)), LOWER, UPPER)


@pytest.mark.parametrize("at", [0.5, 2.2, 4.5])
def test_a_margin_with_its_least_between_rows(at: float) -> None:
    cushion = MARGIN_CUSHION * 0.1
    for least, expected in ((-0.01, True), (0.9 * cushion, True), (1.1 * cushion, False)):
        assert may_fall_below_zero_between(parabola(least, at, 0.1)) == expected
    assert not may_fall_below_zero_between(parabola(-0.01, at, -0.1) + 1.0)


def test_a_margin_that_falls_or_stays_has_no_least_between_rows() -> None:
    assert not may_fall_below_zero_between(np.linspace(0.5, 0.01, 6))
    assert not may_fall_below_zero_between(np.full(6, 1e-9))
    for at in (-MARGIN_REACH - 0.3, 5 + MARGIN_REACH + 0.3):
        values = parabola(0.0, at, 0.1)
        assert not may_fall_below_zero_between(values - values.min() + 1e-9)


@pytest.mark.parametrize("phase", np.linspace(0.0, 1.0, 7))
def test_waves_that_leave_between_rows_are_never_missed(phase: float) -> None:
    """Sines of eight rows a turn."""
    xs = np.arange(10)
    wave = 0.3 * np.sin(2 * math.pi * (xs + phase) / 8)
    fine = 0.3 * np.sin(2 * math.pi * (np.linspace(0, 9, 2001) + phase) / 8)
    for level in (0.299, 0.2999):
        if wave.max() <= level < fine.max():
            rows = rows_of(0, wave)
            assert may_leave_between(rows, np.full(3, -1.0), np.full(3, level))
        room = level - wave
        if room.min() >= 0.0 > (level - fine).min():
            assert may_fall_below_zero_between(room)


@pytest.mark.parametrize(
    "room", [[0.008, 0.025, 0.058, 0.04, 0.099], [0.067, 0.048, 0.032, 0.079, 0.012]]
)
def test_both_parabolas_of_a_pair_of_rows_are_looked_at(room: list[float]) -> None:
    """Where the first has no least between the two, or has it elsewhere, the second may."""
    assert may_fall_below_zero_between(np.array(room))
    assert not may_fall_below_zero_between(np.array(room) + 0.1)
