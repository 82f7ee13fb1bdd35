"""Sizes and quotients of intervals, and boxes that are too fast, on four arms."""

import numpy as np
import pytest

from solver import Robot
from solver.approach.bounds.rates import exceeds, least_size, most_size, quotient, too_fast
from solver.approach.bounds.tolerances import ACCEPTED_RATE_RAD_M
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.kinematics.straight_rates import posture_rate_room
from tests.solver.kinematics.arms import arms


@pytest.mark.parametrize(
    ("interval", "least", "most"),
    [((1.0, 2.0), 1.0, 2.0), ((-2.0, -1.0), 1.0, 2.0), ((-1.0, 3.0), 0.0, 3.0),
     ((-3.0, 1.0), 0.0, 3.0), ((0.0, 0.0), 0.0, 0.0)],
)  # fmt: skip
def test_sizes_of_an_interval(interval: tuple[float, float], least: float, most: float) -> None:
    assert (least_size(interval), most_size(interval)) == (least, most)


@pytest.mark.parametrize("divisor", [(2.0, 4.0), (-4.0, -2.0)])
@pytest.mark.parametrize("a", [(1.0, 3.0), (-3.0, -1.0), (-1.0, 3.0)])
def test_a_quotient_holds_all_quotients_and_little_more(
    a: tuple[float, float], divisor: tuple[float, float]
) -> None:
    low, high = quotient(a, divisor)
    values = [x / y for x in a for y in divisor]
    assert low <= min(values)
    assert max(values) <= high
    assert (low, high) == (pytest.approx(min(values)), pytest.approx(max(values)))


@pytest.mark.parametrize("divisor", [(-1.0, 1.0), (0.0, 1.0), (-1.0, 0.0)])
def test_by_what_may_be_zero_it_is_unbounded(divisor: tuple[float, float]) -> None:
    low, high = quotient((1.0, 2.0), divisor)
    assert low < -1e20
    assert high > 1e20


def test_a_rate_exceeds_what_is_accepted_where_it_does_so_for_certain() -> None:
    most = ACCEPTED_RATE_RAD_M
    assert exceeds((1.1 * most, 2 * most), (-1.0, 0.5))
    assert exceeds((-2 * most, -1.1 * most), (0.5, 1.0))
    assert not exceeds((0.9 * most, 2 * most), (0.5, 1.0))
    assert not exceeds((1.1 * most, 2 * most), (0.5, 1.2))


@pytest.mark.parametrize("arm", [arms()[k] for k in (0, 1, 2, 8)], ids=lambda arm: arm.name)
def test_a_box_is_refused_only_if_all_its_postures_are_too_fast(arm: Robot) -> None:
    """A point is refused just where its posture is too fast."""
    geometry = wrist_geometry(arm, arm.tools[0])
    rng, refused, agreed = np.random.default_rng(5), 0, 0
    for k in range(60):
        q = rng.uniform(arm.lower, arm.upper)
        joint = (2, 4)[k % 2]
        offset = geometry.offsets[joint] + (geometry.beta if joint == 2 else 0.0)
        q[joint] = rng.choice((-1, 1)) * 10.0 ** rng.uniform(-4, -0.5) - offset
        room = posture_rate_room(geometry, q)
        if abs(room) > 1e-4:
            point = np.column_stack((q - 1e-9, q + 1e-9))
            assert too_fast(geometry, point) == (room < 0)
            agreed += 1
        box = np.column_stack((q - 1e-3, q + 1e-3))
        if too_fast(geometry, box):
            refused += 1
            inside = rng.uniform(box[:, 0], box[:, 1], (6, 6))
            assert max(posture_rate_room(geometry, one) for one in inside) < 0
    assert refused > 5
    assert agreed > 40
