"""The nearest point of a limit: on it, and no direction meets the limit sooner."""

import math

import numpy as np
import pytest

from solver import Robot
from solver.approach.task.constraints import LIMITS, REACH
from solver.approach.uncertainty.nearest_limit import (
    LOWER_5,
    UPPER_5,
    behind,
    first_order,
    limit_distance,
    step_inside,
    straight_wrist_distance,
    straight_wrists,
)
from solver.approach.uncertainty.sensitivity import joint_rates, shifted
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.robots.model import Array
from tests.solver.approach.uncertainty.test_sensitivity_shifts import ARMS, placed

CASES = [(arm, seed) for arm in ARMS for seed in (0, 3)]
IDS = [f"{arm.name} {seed}" for arm, seed in CASES]


def tangents(normal: np.ndarray) -> np.ndarray:
    """Two directions normal to another, shape (2, 3)."""
    return np.asarray(np.linalg.svd(normal[None])[2][1:])


@pytest.mark.parametrize(("arm", "seed"), CASES, ids=IDS)
@pytest.mark.parametrize("kind", [*range(6), REACH])
@pytest.mark.parametrize("off", [-0.01, 0.008])
def test_the_nearest_shift_that_meets_a_limit(arm, seed: int, kind: int, off: float) -> None:  # type: ignore[no-untyped-def]
    """It meets it, and goes along the gradient there: nothing nearer does, to first order."""
    geometry = wrist_geometry(arm, arm.tools[0])
    position, axes, branch, q = placed(arm, seed)
    at, delta = np.empty(6), np.zeros(3)
    limit = 0.0 if kind == REACH else q[kind] + off
    length = limit_distance(geometry, position, axes, branch, q, kind, limit, delta)
    assert length == pytest.approx(np.linalg.norm(delta))
    assert length > 0.0
    reach = shifted(geometry, position, delta, axes, branch, q, at)
    if kind == REACH:
        # From inside: the search does not leave the reach.
        assert -1e-9 <= reach < 5e-3
        return
    if reach < 1e-6:
        return
    assert at[kind] == pytest.approx(limit, abs=1e-6)
    rates, reach_rates = np.empty((6, 4)), np.empty(4)
    joint_rates(geometry, at, axes, 0.0, np.zeros(3), rates, reach_rates)
    across = tangents(rates[kind, :3]) @ delta
    assert across == pytest.approx(np.zeros(2), abs=2e-3 * length)


def bent(
    arm: Robot, position: Array, axes: Array, branch: int, q: Array, shift: Array
) -> tuple[float, Array]:
    """What is zero where the wrist is straight."""
    geometry, at = wrist_geometry(arm, arm.tools[0]), np.empty(6)
    reach = shifted(geometry, position, shift, axes, branch, q, at)
    turn4, turn5 = at[3] + geometry.offsets[3], at[4] + geometry.offsets[4]
    sine = math.sin(turn5)
    return reach, np.array([sine * math.cos(turn4), sine * math.sin(turn4)])


def test_the_nearest_straight_wrist() -> None:
    """Two equations: the shift lies in the plane of both gradients."""
    checked = 0
    for arm, seed in [(arm, seed) for arm in ARMS for seed in range(6)]:
        geometry = wrist_geometry(arm, arm.tools[0])
        position, axes, branch, q = placed(arm, seed)
        delta = np.zeros(3)
        length = straight_wrist_distance(geometry, position, axes, branch, q, delta)
        assert length == pytest.approx(np.linalg.norm(delta))
        reach, left = bent(arm, position, axes, branch, q, delta)
        if reach < 0.02 or length > 0.06:
            continue
        assert np.linalg.norm(left) < 1e-4
        # By differences about a point a hair beside, on the near side.
        near, slopes = delta * (1 - 1e-3), np.empty((2, 3))
        for k, step in enumerate(1e-6 * length * np.eye(3)):
            ends = [bent(arm, position, axes, branch, q, near + s * step)[1] for s in (-1, 1)]
            slopes[:, k] = ends[1] - ends[0]
        along = np.linalg.svd(slopes)[2][2]
        assert abs(along @ delta) < 4e-3 * length
        checked += 1
    assert checked >= 3


def test_distances_to_first_order_are_rooms_over_slopes() -> None:
    for arm, seed in CASES:
        geometry = wrist_geometry(arm, arm.tools[0])
        _, axes, _, q = placed(arm, seed)
        lower, upper = q - np.linspace(0.1, 0.35, 6), q + np.linspace(0.4, 0.15, 6)
        lower[1] = q[1] + 0.05
        rates, reach_rates = np.empty((6, 4)), np.empty(4)
        reach = joint_rates(geometry, q, axes, 0.0, axes[:, 1].copy(), rates, reach_rates)
        slopes = np.linalg.norm(rates[:, :3], axis=1)
        found = np.full(LIMITS, np.nan)
        first_order(geometry, lower, upper, q, axes, np.empty((6, 4)), np.empty(4), found)
        below, above = straight_wrists(geometry, q)
        expected = np.column_stack(((q - lower) / slopes, (upper - q) / slopes)).ravel()
        square = rates[4, :3] @ rates[4, :3]
        both = rates[4, :3] @ rates[3, :3]
        normal = math.sqrt(square - both**2 / (rates[3, :3] @ rates[3, :3]))
        if below > lower[4]:
            expected[LOWER_5] = (q[4] - below) / normal
        if above < upper[4]:
            expected[UPPER_5] = (above - q[4]) / normal
        assert found[:12] == pytest.approx(expected)
        assert found[2] < 0.0
        assert found[2 * REACH] == pytest.approx(reach / np.linalg.norm(reach_rates[:3]))


@pytest.mark.parametrize("wide", [False, True])
def test_a_straight_wrist_stands_before_limits_of_joint_five(wide: bool) -> None:
    arm = ARMS[0]
    geometry = wrist_geometry(arm, arm.tools[0])
    _, axes, _, q = placed(arm, 0)
    below, above = straight_wrists(geometry, q)
    beyond = 0.1 if wide else -0.1
    lower, upper = q - 1.0, q + 1.0
    lower[4], upper[4] = below - beyond, above + beyond
    rates, found = np.empty((6, 4)), np.empty(LIMITS)
    first_order(geometry, lower, upper, q, axes, rates, np.empty(4), found)
    slope = np.linalg.norm(rates[4, :3])
    plain = (q[4] - lower[4]) / slope, (upper[4] - q[4]) / slope
    if wide:
        assert found[LOWER_5] != pytest.approx(plain[0])
        assert found[UPPER_5] != pytest.approx(plain[1])
        ratio = found[UPPER_5] / found[LOWER_5]
        assert ratio == pytest.approx((above - q[4]) / (q[4] - below))
        # The way there is normal to joint 4's gradient.
        fifth, fourth = rates[4, :3], rates[3, :3]
        across = fifth - (fifth @ fourth) / (fourth @ fourth) * fourth
        assert found[LOWER_5] == pytest.approx((q[4] - below) / np.linalg.norm(across))
    else:
        assert (found[LOWER_5], found[UPPER_5]) == pytest.approx(plain)
    exactly = lower.copy()
    exactly[4] = below
    first_order(geometry, exactly, upper, q, axes, rates, np.empty(4), found)
    assert found[LOWER_5] == pytest.approx((q[4] - below) / slope)


@pytest.mark.parametrize("q5", [-3.0, -0.5, 0.0, 0.5, 3.0, 3.5])
def test_straight_wrists_are_half_a_turn_apart_around_a_posture(q5: float) -> None:
    arm = ARMS[2]
    geometry = wrist_geometry(arm, arm.tools[0])._replace(offsets=(0.0, 0.0, 0.0, 0.0, 0.2, 0.0))
    below, above = straight_wrists(geometry, np.array([0, 0, 0, 0, q5, 0.0]))
    assert above - below == pytest.approx(math.pi)
    assert below <= q5 < above
    assert math.sin(below + 0.2) == pytest.approx(0.0, abs=1e-12)


def test_a_place_behind_a_pose() -> None:
    pose = np.arange(16.0).reshape(4, 4)
    place = np.full(3, np.nan)
    behind(pose, 0.5, place)
    assert place.tolist() == [3.0 - 1.0, 7.0 - 3.0, 11.0 - 5.0]


def test_a_step_stays_inside_the_reach() -> None:
    """It is halved as long as it leads out, and told by its squares."""
    arm = ARMS[0]
    geometry = wrist_geometry(arm, arm.tools[0])
    position, axes, branch, q = placed(arm, 0)
    at, delta, new = np.empty(6), np.zeros(3), np.array([0.001, 0.002, -0.002])
    change, length = step_inside(geometry, position, axes, branch, q, delta, new.copy(), at)
    assert delta == pytest.approx(new)
    assert (change, length) == (pytest.approx(9e-6), pytest.approx(9e-6))
    change, length = step_inside(geometry, position, axes, branch, q, delta, 2 * new, at)
    assert (change, length) == (pytest.approx(9e-6), pytest.approx(36e-6))
    outward = position / np.linalg.norm(position)
    start = np.array([0.0, 0.0, 0.0])
    change, length = step_inside(geometry, position, axes, branch, q, start, 4.0 * outward, at)
    assert shifted(geometry, position, start, axes, branch, q, np.empty(6)) >= 0.0
    # As often halved as it takes: a share of the step that is a power of a half.
    share = np.linalg.norm(start) / 4.0
    assert math.log2(share) == pytest.approx(round(math.log2(share)))
    assert share < 0.5
    assert length == pytest.approx(16 * share**2)
    assert change == pytest.approx(length)
    assert shifted(geometry, position, 2 * start, axes, branch, q, np.empty(6)) < 0.0
