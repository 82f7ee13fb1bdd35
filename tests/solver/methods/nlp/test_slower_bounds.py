"""Bounds that slow a joint: which joint, to which side of it, and when there is none."""

import math

import numpy as np
import pytest

from solver.kinematics.spherical_wrist import wrist_geometry
from solver.kinematics.straight_rates import posture_rates
from solver.methods.nlp import slower
from solver.methods.nlp.slower import ELBOW, WRIST, slower_limits
from solver.tolerances import JOINT_RATE_RAD_M
from tests.solver.methods.synthetic import small_task

POSTURE = np.array([0.3, 0.7, -1.1, 0.4, 0.9, 0.2])
WIDE = np.array([[-30.0] * 6, [30.0] * 6])


def rates(monkeypatch: pytest.MonkeyPatch, values: list[float]) -> None:
    """As if the joints turned so many times as fast as they may."""

    def stand_in(_: object, posture: object, found: np.ndarray) -> None:
        found[:] = np.array(values) * JOINT_RATE_RAD_M

    monkeypatch.setattr(slower, "posture_rates", stand_in)


def bent(joint: int, angle: float) -> np.ndarray:
    """The posture with the elbow or the wrist off straight by an angle."""
    geometry = wrist_geometry(small_task().robot, small_task().tool)
    posture = POSTURE.copy()
    offset = geometry.offsets[joint] + (geometry.beta if joint == ELBOW else 0.0)
    posture[joint] = angle - offset
    return posture


@pytest.mark.parametrize("joint", [ELBOW, WRIST])
@pytest.mark.parametrize("angle", [0.2, -0.2, math.pi - 0.2, 0.2 - math.pi])
@pytest.mark.parametrize("turns", [-1, 0, 1])
def test_a_joint_is_kept_so_far_from_straight_or_folded_as_it_is_too_fast(
    monkeypatch: pytest.MonkeyPatch, joint: int, angle: float, turns: int
) -> None:
    """Its sine has to grow by as much, and three hundredths more."""
    values = [0.0] * 6
    values[joint - 1 if joint == ELBOW else joint + 1] = 2.5
    rates(monkeypatch, values)
    posture = bent(joint, angle)
    posture[joint] += 2 * math.pi * turns
    drawn = slower_limits(small_task(), posture, WIDE)
    assert drawn is not None
    needed = math.asin(math.sin(0.2) * 2.5 * 1.03)
    straight = abs(angle) < 1.0
    least = math.copysign(needed if straight else math.pi - needed, angle)
    expected = WIDE.copy()
    expected[0 if (angle > 0) == straight else 1, joint] = posture[joint] + least - angle
    assert drawn == pytest.approx(expected, abs=1e-12)
    assert WIDE[0, joint] == -30.0


@pytest.mark.parametrize(
    ("values", "joint"),
    [
        ([9.0, 1.5, 0.0, 0.0, 0.0, 1.4], ELBOW),
        ([0.0, 0.0, 1.5, 1.4, 0.0, 0.0], ELBOW),
        ([0.0, 1.5, 0.0, 1.5, 0.0, 0.0], ELBOW),
        ([0.0, 1.4, 0.0, 1.5, 0.0, 0.0], WRIST),
        ([0.0, 0.0, 1.4, 0.0, 9.0, 1.5], WRIST),
        ([9.0, 1.0, 1.0, 1.0, 9.0, 1.0], None),
        ([9.0, 0.5, 0.5, 0.5, 9.0, 0.5], None),
        ([0.0, 1.001, 0.5, 0.5, 9.0, 0.5], ELBOW),
    ],
)
def test_the_faster_of_elbow_and_wrist_is_slowed(
    monkeypatch: pytest.MonkeyPatch, values: list[float], joint: int | None
) -> None:
    """Joints 2 and 3 are the elbow's, 4 and 6 the wrist's; the waist no bound slows."""
    rates(monkeypatch, values)
    posture = np.where(np.arange(6) == WRIST, bent(WRIST, 0.3), bent(ELBOW, 0.3))
    drawn = slower_limits(small_task(), posture, WIDE)
    if joint is None:
        assert drawn is None
        return
    assert drawn is not None
    assert np.unique(np.argwhere(drawn != WIDE)[:, 1]).tolist() == [joint]


def test_no_bound_helps_where_the_sine_would_be_more_than_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for times, slowed in ((0.96 / math.sin(0.2), True), (0.98 / math.sin(0.2), False)):
        rates(monkeypatch, [0.0, times, 0.0, 0.0, 0.0, 0.0])
        found = slower_limits(small_task(), bent(ELBOW, 0.2), WIDE)
        assert (found is not None) == slowed


def test_limits_that_are_closer_stay_and_none_are_left_without_room(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rates(monkeypatch, [0.0, 1.5, 0.0, 0.0, 0.0, 0.0])
    for angle, side in ((0.2, 0), (-0.2, 1)):
        posture, limits = bent(ELBOW, angle), WIDE.copy()
        limits[side, ELBOW] = posture[ELBOW] + 10 * angle
        drawn = slower_limits(small_task(), posture, limits)
        assert drawn is not None
        assert np.array_equal(drawn, limits)
        shut = WIDE.copy()
        shut[1 - side, ELBOW] = posture[ELBOW] + 0.05 * angle
        assert slower_limits(small_task(), posture, shut) is None


def test_the_arm_s_own_rates_decide() -> None:
    task, found = small_task(), np.empty(6)
    posture = bent(WRIST, 1e-3)
    posture_rates(wrist_geometry(task.robot, task.tool), posture, found)
    assert found.max() > JOINT_RATE_RAD_M
    drawn = slower_limits(task, posture, WIDE)
    assert drawn is not None
    posture[WRIST] = drawn[0, WRIST]
    posture_rates(wrist_geometry(task.robot, task.tool), posture, found)
    assert found[[3, 5]].max() == pytest.approx(JOINT_RATE_RAD_M / 1.03, rel=0.01)
