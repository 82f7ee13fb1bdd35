"""Reasons from failures that are told, and nearest changes from offers that are."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver import Arc
from solver.approach.arcs.arcs import sample_angles_of, task_arcs
from solver.approach.refusal import diagnosis, nearest_change
from solver.approach.refusal.closest import Stage
from solver.approach.refusal.diagnosis import _stage_reason, diagnose
from solver.approach.refusal.nearest_change import (
    _on_an_arc,
    _same_direction,
    displaced,
    nearest_angle,
    nearest_displacement,
)
from solver.approach.task.frame import approach_frame
from solver.problem.solution import Nearest, Reason
from solver.tolerances import JOINT_RATE_RAD_M
from tests.solver.methods.synthetic import small_task

TASK = small_task(2)
NAME = TASK.robot.joints[3].name
BEHIND = f"{TASK.retreats_m[4] * 1000:.1f} mm before the target"


@pytest.mark.parametrize(
    ("stage", "margin", "code", "parts", "fields"),
    [
        (Stage.REACH_AT_THINNING, -0.0123, "out_of_reach", ["12.3 mm outside"], "m"),
        (Stage.LIMIT_AT_THINNING, -0.1, "joint_limit", [NAME, "5.73 degrees", "thinning"], "rad"),
        (Stage.REACH_AT_STANDBY, -0.02, "standby_infeasible", ["20.0 mm outside", "standby"], "m"),
        (Stage.LIMIT_AT_STANDBY, -0.2, "standby_infeasible", [NAME, "11.46 degrees"], "rad"),
        (Stage.REACH_IN_CUT_IN, -0.004, "cut_in_infeasible", ["4.0 mm outside", BEHIND], "m"),
        (Stage.LIMIT_IN_CUT_IN, -0.3, "cut_in_infeasible", [NAME, "17.19", BEHIND], "rad"),
        (Stage.JUMP_IN_CUT_IN, -100.0, "cut_in_infeasible", [NAME, "too fast", BEHIND], ""),
    ],
)
def test_every_stage_has_its_reason(
    stage: Stage, margin: float, code: str, parts: list[str], fields: str
) -> None:
    reason = _stage_reason(TASK, stage, margin, 3, 4)
    assert reason.code == code
    for part in parts:
        assert part in reason.detail
    assert reason.joint == (NAME if NAME in parts else None)
    assert reason.margin_m == (margin if fields == "m" else None)
    assert reason.margin_rad == (margin if fields == "rad" else None)


def test_how_fast_a_joint_turns_is_told_for_each_millimetre() -> None:
    reason = _stage_reason(TASK, Stage.JUMP_IN_CUT_IN, -100.0, 3, 4)
    assert f"by {math.degrees(JOINT_RATE_RAD_M + 100.0) / 1000:.1f} degrees" in reason.detail
    assert f"{math.degrees(JOINT_RATE_RAD_M) / 1000:.1f} degrees are allowed" in reason.detail
    swung = _stage_reason(TASK, Stage.JUMP_IN_CUT_IN, -9e3, 3, 4)
    assert "by half a turn for each" in swung.detail


def told(monkeypatch: pytest.MonkeyPatch, failures: dict[int, tuple[Any, ...]],
         arcs: tuple[Arc, ...] = ()) -> list[Any]:  # fmt: skip
    asked: list[Any] = []
    task = small_task(2, symmetric_tool=True)

    def closest(kernels: Any, angles: np.ndarray, between: bool) -> tuple[Any, ...]:
        side = next(
            s for s in (1, -1) if np.array_equal(kernels.y_axis, task.for_kernels(s).y_axis)
        )
        asked.append((side, len(angles), between))
        return failures[side]

    monkeypatch.setattr(diagnosis, "closest_failure", closest)
    monkeypatch.setattr(diagnosis, "task_arcs", lambda _: arcs)
    monkeypatch.setattr(diagnosis, "nearest_displacement", lambda _: "displaced")
    monkeypatch.setattr(diagnosis, "nearest_angle", lambda task, tried, arcs: ("angle", len(arcs)))
    return asked


FAR = (Stage.REACH_AT_THINNING, -0.1, 0, 15, 2, 0.3)
NEAR = (Stage.LIMIT_AT_THINNING, -0.2, 3, 15, 2, 0.3)


def test_the_closest_of_both_tool_sides_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    task = small_task(2, symmetric_tool=True)
    for failures in ({1: FAR, -1: NEAR}, {1: NEAR, -1: FAR}):
        asked = told(monkeypatch, failures)
        reason: Any = diagnose(task)
        assert (reason.code, reason.joint, reason.nearest) == ("joint_limit", NAME, "displaced")
        assert asked == [(1, 90, True), (-1, 90, True)]
    asked = told(monkeypatch, {1: FAR, -1: (*FAR[:1], -0.05, *FAR[2:])})
    reason = diagnose(task, np.array([0.1, 0.2]))
    assert reason.margin_m == -0.05
    assert asked == [(1, 2, False), (-1, 2, False)]
    assert reason.nearest == "displaced"


def test_where_there_are_arcs_beside_the_angles_tried_the_nearest_is_offered(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told(monkeypatch, {1: FAR, -1: NEAR}, (Arc(1, 2, 0.1, 0.2),))
    reason: Any = diagnose(small_task(2, symmetric_tool=True), np.array([0.5]))
    assert reason.nearest == ("angle", 1)


def test_a_target_that_is_too_uncertain_is_told_so() -> None:
    uncertain = replace(TASK, target=replace(TASK.target, position_std_m=0.05))
    reason = diagnosis._too_uncertain(uncertain, None)
    assert isinstance(reason, Reason)
    assert "150.0 mm away (3 standard deviations)" in reason.detail
    assert reason.margin_m is not None
    assert -0.15 < reason.margin_m < -0.1
    assert f"{(reason.margin_m + 0.15) * 1000:.1f} mm meets" in reason.detail
    borne = (reason.margin_m + 0.15) / 3 * 1000
    assert reason.detail.endswith(f"up to {borne:.2f} mm could be borne")
    tried = diagnosis._too_uncertain(uncertain, np.array([0.2, 2.5]))
    assert tried.margin_m is not None
    assert tried.margin_m <= reason.margin_m + 1e-9


@pytest.mark.parametrize("tried", [[0.5], [-2.0], [3.1, -3.0], [0.21, 2.0]])
def test_the_nearest_angle_is_a_hair_inside_the_end_of_an_arc(tried: list[float]) -> None:
    arcs = task_arcs(TASK)
    found = nearest_angle(TASK, np.array(tried), arcs)
    ends = [end for arc in arcs for end in (arc.lower_rad + 1e-6, arc.upper_rad - 1e-6)]
    away = [min(abs(math.remainder(end - one, 2 * math.pi)) for one in tried) for end in ends]
    assert found.approach_angle_rad == pytest.approx(
        math.remainder(ends[int(np.argmin(away))], 2 * math.pi)
    )
    assert found.kind == "angle"
    assert found.displacement_m == (0.0, 0.0, 0.0)
    assert found.verified
    narrow = replace(arcs[0], lower_rad=0.3, upper_rad=0.3 + 1e-7)
    middle = nearest_angle(TASK, np.array([0.0]), [narrow])
    assert middle.approach_angle_rad == pytest.approx(0.3 + 0.5e-7, abs=1e-12)


def test_spares_are_given_in_turn_until_one_verifies(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []
    offers = [
        None,
        Nearest("displacement", 0.1, (1, 2, 3), False),
        Nearest("displacement", 0.2, (1, 2, 3), True),
    ]

    def with_spare(task: Any, spread: float) -> Nearest | None:
        asked.append(spread)
        return offers[len(asked) - 1] if len(asked) <= len(offers) else None

    monkeypatch.setattr(nearest_change, "_nearest_with", with_spare)
    found = nearest_displacement(TASK)
    assert found is not None
    assert found.approach_angle_rad == 0.2
    assert asked == [0.0, 1e-4, 3e-4]
    asked.clear()
    offers[2] = None
    assert nearest_displacement(TASK) is None
    assert len(asked) == 4


@pytest.mark.parametrize("shift", [(0.01, 0.0, 0.0), (-0.05, 0.02, 0.03), (0.0, 0.0, -0.1)])
def test_an_approach_direction_keeps_where_it_points_when_the_target_moves(
    shift: tuple[float, float, float],
) -> None:
    moved = displaced(TASK, shift)
    place = np.asarray(TASK.target.position_m) + shift
    assert moved.target.position_m == pytest.approx(place)
    for angle in (-1.0, 0.4):
        other = _same_direction(TASK, tuple(place), angle)
        assert moved.frame.direction(other) == pytest.approx(TASK.frame.direction(angle))
    along = tuple(0.2 * TASK.frame.branch)
    upright = approach_frame(along, TASK.target.branch_direction)
    other = _same_direction(TASK, along, 0.4)
    assert upright.direction(other) == pytest.approx(TASK.frame.direction(0.4))


def test_an_angle_is_on_an_arc_of_its_own_branch_whatever_its_turn() -> None:
    for arc in task_arcs(TASK):
        middle = (arc.lower_rad + arc.upper_rad) / 2
        for turn in (-1, 0, 1):
            assert _on_an_arc(TASK, middle + 2 * math.pi * turn, 1, arc.branch)
        assert not _on_an_arc(TASK, middle, -1, arc.branch)
        assert not _on_an_arc(TASK, arc.upper_rad + 1e-6, 1, arc.branch)


def test_of_angles_tried_those_that_are_feasible_are_spots() -> None:
    task, tried = small_task(2, symmetric_tool=True), np.array([0.2, 2.5, 0.4])
    spots = diagnosis._tried_spots(task, tried)
    expected = []
    for side in (1, -1):
        margins, _ = sample_angles_of(task, side, tried)
        places = [(branch, k) for branch in range(8) for k in range(3)]
        expected += [
            (side, branch, float(tried[k])) for branch, k in places if margins[branch, k] >= 0.0
        ]
    assert [(spot.tool_side, spot.branch, spot.angle_rad) for spot in spots] == expected
    assert len(expected) >= 2


def test_eight_branches_of_both_sides_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(diagnosis, "trace", lambda *_: 0.0)
    spots = diagnosis._tried_spots(small_task(2, symmetric_tool=True), np.array([0.2, 2.5]))
    assert len(spots) == 2 * 8 * 2
    monkeypatch.setattr(diagnosis, "trace", lambda *_: -1e-9)
    assert diagnosis._tried_spots(TASK, np.array([0.2])) == []
