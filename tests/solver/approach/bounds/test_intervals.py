"""Intervals and jets hold what they stand for, and little more."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from solver.approach.bounds import intervals as iv

RNG = np.random.default_rng(1)
BOXES = [tuple(sorted(RNG.uniform(-2.0, 2.0, 2))) for _ in range(12)]
BOXES += [(-1.0, 1.0), (0.0, 1.5), (-1.5, 0.0), (0.3, 0.3)]
Interval = tuple[float, float]


def inside(box: Interval) -> np.ndarray:
    return np.linspace(*box, 7)


def assert_holds(found: Interval, values: Any, slack: float = 1e-12) -> None:
    """The values, and nothing that is further away than rounding."""
    low, high = float(np.min(values)), float(np.max(values))
    assert found[0] <= low
    assert high <= found[1]
    assert list(found) == pytest.approx([low, high], abs=slack)


def test_results_are_moved_outward() -> None:
    low, high = iv.outward(1.0, 2.0)
    assert (low, high) == (1.0 - 2.0**-52, 2.0 + 2.0**-51)
    assert iv.outward(-1.0, 0.0, 4.0) == (-1.0 - 2.0**-50, 1e-300)


@pytest.mark.parametrize("a", BOXES)
@pytest.mark.parametrize("b", BOXES[::3])
def test_the_four_operations(a: Interval, b: Interval) -> None:
    x, y = (part.ravel() for part in np.meshgrid(inside(a), inside(b)))
    assert_holds(iv.add(a, b), x + y)
    assert_holds(iv.subtract(a, b), x - y)
    assert_holds(iv.multiply(a, b), x * y)
    positive = (abs(b[0]) + 0.1, abs(b[0]) + 0.2)
    z = np.linspace(*positive, len(x))
    low, high = iv.over_positive(a, positive)
    ends = [v / w for v in a for w in positive]
    assert_holds((low, high), ends)
    assert np.all((low <= x / z) & (x / z <= high))


def test_a_divisor_that_may_be_zero_leaves_the_steepest_slope() -> None:
    assert iv.over_positive((1.0, 2.0), (0.0, 1.0)) == (-1e30, 1e30)
    assert iv.over_positive((1.0, 2.0), (1e-200, 1e-200)) == (1e30, 1e30) or iv.over_positive(
        (1.0, 2.0), (1e-200, 1e-200)
    )[1] == pytest.approx(1e30)


@pytest.mark.parametrize("a", BOXES)
def test_functions_of_one_interval(a: Interval) -> None:
    x = np.linspace(*a, 20_001)
    assert_holds(iv.square(a), x * x, 1e-7)
    assert_holds(iv.root(a), np.sqrt(np.maximum(x, 0.0)), 1e-12)
    for factor in (2.5, -1.5, 0.0):
        assert_holds(iv.scale(factor, a), factor * x)
    for shift in (0.0, 2.0, 5.0):
        moved = (a[0] + shift, a[1] + shift)
        assert_holds(iv.cosine(moved), np.cos(x + shift), 1e-7)
        assert_holds(iv.sine(moved), np.sin(x + shift), 1e-7)
    low, high = iv.shifted(a, 3.0)
    assert (low, high) == (pytest.approx(a[0] + 3, abs=1e-12), pytest.approx(a[1] + 3, abs=1e-12))
    assert low < a[0] + 3
    assert high > a[1] + 3


def test_a_whole_turn_has_every_cosine() -> None:
    assert iv.cosine((0.3, 0.3 + 2 * math.pi)) == (-1.0, 1.0)
    assert iv.cosine(iv.WHOLE) == (-1.0, 1.0)
    assert iv.cosine((-0.1, 0.1))[1] == 1.0
    assert iv.cosine((3.1, 3.2))[0] == -1.0
    assert iv.square((-1.0, 2.0))[0] == 0.0
    assert iv.root((-1.0, 4.0))[0] == 0.0


Function = Callable[[float], float]
JETS: dict[str, tuple[Callable[[Any], Any], Function]] = {
    "add": (lambda j: iv.j_add(j, iv.number(0.7)), lambda x: x + 0.7),
    "subtract": (lambda j: iv.j_subtract(iv.number(0.7), j), lambda x: 0.7 - x),
    "multiply": (lambda j: iv.j_multiply(j, iv.j_cosine(j)), lambda x: x * math.cos(x)),
    "scale": (lambda j: iv.j_scale(-1.7, j), lambda x: -1.7 * x),
    "square": (lambda j: iv.j_square(j), lambda x: x * x),
    "root": (lambda j: iv.j_root(iv.j_add(j, iv.number(3.0))), lambda x: math.sqrt(x + 3.0)),
    "cosine": (lambda j: iv.j_cosine(j), math.cos),
    "sine": (lambda j: iv.j_sine(j), math.sin),
    "arc cosine": (lambda j: iv.j_arc_cosine(iv.j_scale(0.4, j)), lambda x: math.acos(0.4 * x)),
    "arc tangent": (
        lambda j: iv.j_arc_tangent(iv.j_sine(j), iv.j_add(iv.number(2.0), j)),
        lambda x: math.atan2(math.sin(x), 2.0 + x),
    ),
}


@pytest.mark.parametrize("name", JETS)
@pytest.mark.parametrize("middle", [-1.2, -0.3, 0.0, 0.4, 1.5])
def test_jets_hold_values_and_slopes(name: str, middle: float) -> None:
    jet, function = JETS[name]
    for half in (1e-9, 0.01, 0.2):
        value, slope = jet(((middle - half, middle + half), (1.0, 1.0)))
        for x in np.linspace(middle - half, middle + half, 5):
            assert value[0] <= function(float(x)) <= value[1]
            difference = (function(float(x) + 1e-6) - function(float(x) - 1e-6)) / 2e-6
            assert slope[0] - 1e-8 <= difference <= slope[1] + 1e-8
        assert value[1] - value[0] <= 12 * half + 1e-12
        assert slope[1] - slope[0] <= 40 * half + 1e-10


def test_an_angle_of_which_nothing_is_known_is_more_than_a_turn() -> None:
    box = (-1.0, 1.0), (1.0, 1.0)
    value, slope = iv.j_arc_tangent(box, box)
    assert value == iv.WHOLE
    assert slope == (-1e30, 1e30)
    assert iv.WHOLE[1] - iv.WHOLE[0] > 2 * math.pi
    # Beside the half turn it does not jump.
    value, _ = iv.j_arc_tangent(((-0.1, 0.1), (0.0, 0.0)), ((-1.0, -0.9), (0.0, 0.0)))
    assert value[1] - value[0] == pytest.approx(2 * math.atan2(0.1, 0.9), abs=1e-12)
    assert iv.widened(iv.number(1.0), 0.5) == ((0.5, 1.5), (0.0, 0.0))
