"""The ladder of zones and the points looked at, number by number."""

import math

import numpy as np
import pytest

from solver.methods.relaxed.zones import in_zone, looked_at, strike_rungs, tilt_rungs, zone_of
from tests.solver.methods.synthetic import small_task

DEGREE = math.radians(1)


def relaxed(strike_m: float, tilt_rad: float):  # type: ignore[no-untyped-def]
    return in_zone(small_task(standoff_m=0.1), strike_m, tilt_rad)


@pytest.mark.parametrize(
    ("strike_m", "rungs"),
    [
        (0.0, (0.0,)),
        (0.005, (0.0, 0.005)),
        (0.02, (0.0, 0.02)),
        (0.03, (0.0, 0.02, 0.03)),
        (0.1, (0.0, 0.02, 0.04, 0.08, 0.1)),
    ],
)
def test_strike_zones_are_two_centimetres_and_doubled(
    strike_m: float, rungs: tuple[float, ...]
) -> None:
    assert strike_rungs(relaxed(strike_m, 0.0).options) == pytest.approx(rungs)


@pytest.mark.parametrize(
    ("degrees", "rungs"),
    [(0.0, (0.0,)), (4.0, (0.0, 4.0)), (10.0, (0.0, 10.0)), (45.0, (0.0, 10.0, 20.0, 40.0, 45.0))],
)
def test_tilts_are_ten_degrees_and_doubled(degrees: float, rungs: tuple[float, ...]) -> None:
    options = relaxed(0.0, degrees * DEGREE).options
    assert tilt_rungs(options) == pytest.approx(np.array(rungs) * DEGREE)


def test_a_zone_has_what_is_on_and_zero_for_what_is_off() -> None:
    assert zone_of(relaxed(0.03, 0.2).options).tolist() == [0.03, 0.2]
    assert zone_of(relaxed(0.0, 0.2).options).tolist() == [0.0, 0.2]
    assert zone_of(relaxed(0.03, 1e-300).options).tolist() == [0.03, 0.0]
    assert zone_of(relaxed(1e-300, 0.2).options).tolist() == [0.0, 0.2]


def ring(task, tilt: float) -> list[np.ndarray]:  # type: ignore[no-untyped-def]
    turns = [2 * math.pi * k / 8 for k in range(8)]
    u, v = task.frame.outward, task.frame.sideways
    return [tilt * (math.cos(turn) * u + math.sin(turn) * v) for turn in turns]


def test_along_the_forks_alone_every_other_millimetre_is_looked_at() -> None:
    strikes, swings = looked_at(relaxed(0.007, 0.0))
    assert strikes == pytest.approx([0.0, 0.002, 0.004, 0.006, 0.007])
    assert not swings.any()
    assert looked_at(relaxed(0.004, 0.0))[0] == pytest.approx([0.0, 0.002, 0.004])


def test_leaning_alone_is_looked_at_in_rings_of_five_degrees() -> None:
    task = relaxed(0.0, 12 * DEGREE)
    strikes, swings = looked_at(task)
    assert not strikes.any()
    rings = [one for tilt in (5, 10, 12) for one in ring(task, tilt * DEGREE)]
    np.testing.assert_allclose(swings, [np.zeros(3), *rings], atol=1e-15)


def test_with_both_the_two_alone_come_first_and_then_pairs_that_double() -> None:
    task = relaxed(0.012, 6 * DEGREE)
    strikes, swings = looked_at(task)
    alone = [0.002, 0.004, 0.006, 0.008, 0.010, 0.012]
    rings = [one for tilt in (5, 6) for one in ring(task, tilt * DEGREE)]
    pairs = [
        (strike, one)
        for strike in (0.005, 0.010, 0.012)
        for tilt in (2.5, 5.0, 6.0)
        for one in ring(task, tilt * DEGREE)
    ]
    expected = [(0.0, np.zeros(3)), *((strike, np.zeros(3)) for strike in alone)]
    expected += [(0.0, one) for one in rings] + pairs
    np.testing.assert_allclose(strikes, [strike for strike, _ in expected], atol=1e-15)
    np.testing.assert_allclose(swings, [swing for _, swing in expected], atol=1e-15)
