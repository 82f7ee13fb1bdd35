"""Numerical warm starts from arrivals that are told, and reasons where none holds."""

from typing import Any

import numpy as np
import pytest

from solver.approach.numerical import warm_start
from solver.approach.numerical.sweep import Arrival, Found
from solver.approach.numerical.warm_start import (
    NumericalStart,
    _cut_in_holds,
    _Stages,
    numerical_warm_starts,
    polished_thinning,
    same_side,
)
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.numerical import postures_behind
from solver.problem.solution import Reason
from tests.solver.approach.numerical.test_multi_start import ROBOTS, known, task_of

ROBOT = ROBOTS[0]
TASK = task_of(ROBOT)


def holding() -> tuple[Any, np.ndarray, float, np.ndarray]:
    """A task with a posture whose cut-in holds, its angle and its rows."""
    for k in range(12):
        task, q, angle = known(ROBOT, k)
        polished = polished_thinning(task, angle, 1, q)
        if polished is not None:
            rows = postures_behind(ROBOT, task.tool, polished, np.asarray(task.retreats_m))
            return task, polished, angle, rows
    raise AssertionError


HOLDS, POSTURE, ANGLE, ROWS = holding()


def test_a_polished_posture_is_at_its_angle() -> None:
    near = POSTURE + 1e-4
    found = polished_thinning(HOLDS, ANGLE, 1, near)
    assert found is not None
    pose = forward_kinematics(ROBOT, HOLDS.tool, found)
    assert pose[:3, 3] == pytest.approx(HOLDS.target.position_m, abs=1e-9)
    assert pose[:3, :3] == pytest.approx(HOLDS.frame.axes(ANGLE, 1), abs=1e-9)
    assert np.array_equal(near, POSTURE + 1e-4)


def test_a_cut_in_holds_or_breaks_at_one_thing() -> None:
    stages = _Stages()
    assert _cut_in_holds(HOLDS, ROWS, stages)
    inside = HOLDS.inside(ROWS).min(axis=-1)
    assert stages.standby
    assert stages.standby_margin == pytest.approx(inside[0])
    off = ROWS.copy()
    off[3, 1] += 1e-4
    assert not _cut_in_holds(HOLDS, off, _Stages())
    lost = _Stages()
    off = ROWS.copy()
    off[0, 1] += 1e-3
    assert not _cut_in_holds(HOLDS, off, lost)
    assert (lost.standby, lost.standby_margin) == (False, -np.inf)
    # A turn of the last joint moves nothing, but it is beyond its limits.
    turned = ROWS.copy()
    turned[:, 5] += 2 * np.pi * np.sign(-POSTURE[5] + 0.1)
    beyond = _Stages()
    expected = HOLDS.inside(turned).min() >= 0.0
    assert _cut_in_holds(HOLDS, turned, beyond) == expected


def test_rows_on_both_sides_of_a_singularity_are_told() -> None:
    assert same_side(ROBOT, HOLDS.tool, ROWS)
    flipped = ROWS.copy()
    flipped[0, 2] = -flipped[0, 2]
    flipped[0, 4] = flipped[0, 4]
    assert not same_side(ROBOT, HOLDS.tool, flipped)
    singular = ROWS.copy()
    singular[:, 4] = 0.0
    assert same_side(ROBOT, HOLDS.tool, singular) in (True, False)


def told(
    monkeypatch: pytest.MonkeyPatch, arrivals: list[Arrival], refined: list[Arrival],
    polished: Any = lambda q: q, whole: Any = lambda q: False,
) -> None:  # fmt: skip
    monkeypatch.setattr(warm_start, "arrivals_at", lambda _: tuple(arrivals))
    monkeypatch.setattr(warm_start, "refined", lambda task, given: refined)
    monkeypatch.setattr(warm_start, "polished_thinning", lambda task, angle, side, q: polished(q))
    monkeypatch.setattr(warm_start, "postures_behind", lambda robot, tool, q, retreats: q)
    monkeypatch.setattr(warm_start, "_cut_in_holds", lambda task, rows, stages: whole(rows))


def arrival(first: float, angle: float = 0.5, side: int = 1) -> Arrival:
    return Arrival(np.array([first, 0, 0, 0, 0, 0.0]) + TASK.reference, angle, side)


def firsts(found: Any) -> list[float]:
    assert isinstance(found, tuple)
    return [round(float(one.thinning_joints[0] - TASK.reference[0]), 9) for one in found]


def test_the_cheapest_few_that_differ_are_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    every = [arrival(0.3, 4.0), arrival(0.305), arrival(0.2), arrival(0.6), arrival(0.1)]
    told(monkeypatch, every, every)
    found = numerical_warm_starts(TASK, 3)
    assert firsts(found) == [0.2, 0.3, 0.6]
    assert isinstance(found, tuple)
    assert isinstance(found[1], NumericalStart)
    assert found[1].approach_angle_rad == pytest.approx(4.0 - 2 * np.pi)
    assert (found[1].tool_side, round(found[1].effort, 9)) == (1, 0.3)
    assert firsts(numerical_warm_starts(TASK, 1)) == [0.3]
    assert firsts(numerical_warm_starts(TASK, 9)) == [0.1, 0.2, 0.3, 0.6]


def test_those_whose_cut_in_breaks_are_passed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    every = [arrival(0.3), arrival(0.305), arrival(0.6)]
    broken = every[0].posture
    told(monkeypatch, every, every, lambda q: None if np.array_equal(q, broken) else q)
    assert firsts(numerical_warm_starts(TASK, 3)) == [0.305, 0.6]


def test_where_none_is_polished_the_first_arrival_that_holds_is_taken(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    every = [arrival(0.1), arrival(0.4), arrival(0.6)]
    whole = every[1].posture
    told(monkeypatch, every, every, lambda q: None, lambda q: np.array_equal(q, whole))
    assert firsts(numerical_warm_starts(TASK, 3)) == [0.4]


def test_reasons_tell_how_far_the_starts_came(monkeypatch: pytest.MonkeyPatch) -> None:
    every = [arrival(0.1)]
    told(monkeypatch, every, [], whole=lambda q: False)
    reason = numerical_warm_starts(TASK, 2)
    assert isinstance(reason, Reason)
    assert (reason.code, reason.margin_rad) == ("standby_infeasible", None)

    def came(task: Any, rows: Any, stages: Any) -> bool:
        stages.standby, stages.standby_margin = True, 0.1
        return False

    monkeypatch.setattr(warm_start, "_cut_in_holds", came)
    reason = numerical_warm_starts(TASK, 2)
    assert isinstance(reason, Reason)
    assert reason.code == "cut_in_infeasible"

    def short(task: Any, rows: Any, stages: Any) -> bool:
        stages.standby_margin = -0.2
        return False

    monkeypatch.setattr(warm_start, "_cut_in_holds", short)
    reason = numerical_warm_starts(TASK, 2)
    assert isinstance(reason, Reason)
    assert (reason.code, reason.margin_rad) == ("standby_infeasible", -0.2)


@pytest.mark.parametrize("reached", [True, False])
def test_without_limits_reach_is_told_from_limits(
    monkeypatch: pytest.MonkeyPatch, reached: bool
) -> None:
    told(monkeypatch, [], [])
    outside = np.array([TASK.reference, TASK.reference])
    outside[0, 3], outside[1, 2] = TASK.upper[3] + 0.5, TASK.lower[2] - 0.25

    def starts(task: Any, lower: np.ndarray, upper: np.ndarray) -> list[Found]:
        assert np.isinf(lower).all()
        assert np.isinf(upper).all()
        return [Found(1, outside, np.zeros(2), np.full(2, 0.0 if reached else 0.1))]

    monkeypatch.setattr(warm_start, "from_all_starts", starts)
    reason = numerical_warm_starts(TASK, 2)
    assert isinstance(reason, Reason)
    if reached:
        name = ROBOT.joints[2].name
        assert (reason.code, reason.joint) == ("joint_limit", name)
        assert reason.margin_rad == pytest.approx(-0.25)
        return
    places = forward_kinematics(ROBOT, TASK.tool, outside)[:, :3, 3]
    away = np.linalg.norm(places - TASK.target.position_m, axis=1).min()
    assert reason.code == "out_of_reach"
    assert reason.margin_m == pytest.approx(-away)
    assert f"{away * 1000:.1f} mm" in reason.detail
