"""The approach that comes closest, and what it fails at, stage by stage."""

import math
from typing import Any

import numpy as np
import pytest

from solver.approach.refusal import closest as module
from solver.approach.refusal.closest import Stage, closer, closest_failure, failure, wrist_reach
from solver.approach.task.feasibility import (
    CutInTask,
    fastest_joint,
    limit_margin,
    posture,
    tool_axes,
)
from solver.tolerances import JOINT_RATE_RAD_M
from tests.solver.interpreted import interpret, interpreted
from tests.solver.methods.synthetic import small_task

SMALL = small_task(2)
TASK = SMALL.for_kernels(1)
ANGLE, BRANCH = 0.2, 2
ROWS = SMALL.postures(ANGLE, 1, BRANCH, TASK.retreats)
LAST = len(TASK.retreats) - 1


def failed(task: CutInTask, angle: float = ANGLE, branch: int = BRANCH) -> tuple[Any, ...]:
    stage, margin, joint, row = failure(task, angle, branch, np.empty((len(task.retreats), 6)))
    return Stage(stage), float(margin), int(joint), int(row)


def drawn_in(joint: int, low: float, high: float) -> CutInTask:
    lower, upper = TASK.lower.copy(), TASK.upper.copy()
    lower[joint], upper[joint] = low, high
    return TASK._replace(lower=lower, upper=upper)


def test_a_feasible_approach_fails_at_nothing() -> None:
    assert failed(TASK) == (Stage.FEASIBLE, 0.0, 0, 0)


@pytest.mark.parametrize("joint", range(6))
def test_limits_at_thinning_come_before_all_others(joint: int) -> None:
    value = ROWS[-1, joint]
    assert failed(drawn_in(joint, value - 1.0, value - 0.01)) == (
        Stage.LIMIT_AT_THINNING, pytest.approx(-0.01), joint, LAST,
    )  # fmt: skip
    assert failed(drawn_in(joint, value + 0.02, value + 1.0))[:2] == (
        Stage.LIMIT_AT_THINNING, pytest.approx(-0.02),
    )  # fmt: skip


@pytest.mark.parametrize("joint", [1, 2, 4])
def test_limits_at_standby_come_next(joint: int) -> None:
    first, last = ROWS[0, joint], ROWS[-1, joint]
    between = (first + last) / 2
    ends = (between, last + 1.0) if last > first else (last - 1.0, between)
    stage, margin, which, row = failed(drawn_in(joint, *ends))
    assert (stage, which, row) == (Stage.LIMIT_AT_STANDBY, joint, 0)
    assert margin == pytest.approx(-abs(first - between))


def test_reach_at_thinning_and_at_standby() -> None:
    far = TASK._replace(position=3 * TASK.position)
    stage, margin, joint, row = failed(far)
    assert (stage, joint, row) == (Stage.REACH_AT_THINNING, 0, LAST)
    axes, q = np.empty((3, 3)), np.empty(6)
    tool_axes(far, ANGLE, axes)
    assert margin == pytest.approx(posture(far, axes, 0.0, BRANCH, q))
    long = TASK._replace(retreats=np.array([0.6, 0.3, 0.0]))
    stage, margin, joint, row = failed(long)
    assert (stage, joint, row) == (Stage.REACH_AT_STANDBY, 0, 0)
    assert margin == pytest.approx(posture(TASK, axes_of(), 0.6, BRANCH, q))


def axes_of() -> np.ndarray:
    axes = np.empty((3, 3))
    tool_axes(TASK, ANGLE, axes)
    return axes


def told(monkeypatch: pytest.MonkeyPatch, rows: np.ndarray, reaches: dict[float, float],
         rate: tuple[float, int, int] = (0.0, 0, 0)) -> None:  # fmt: skip
    """Rows of the cut-in, reaches by retreat, and the fastest joint, as they are told."""

    def stand_in(task: Any, axes: Any, retreat: float, branch: int, q: np.ndarray) -> float:
        q[:] = ROWS[0 if retreat else -1]
        return reaches.get(float(retreat), 1.0)

    def trace(task: Any, angle: float, branch: int, retreats: Any, into: np.ndarray) -> float:
        into[:] = rows
        return 0.0

    interpret(monkeypatch, module, posture=stand_in, trace=trace, fastest_joint=lambda *_: rate)


def told_failure() -> tuple[Any, ...]:
    stage, *rest = interpreted(failure)(TASK, ANGLE, BRANCH, np.empty((LAST + 1, 6)))
    return (Stage(stage), *rest)


def test_in_the_cut_in_the_worst_row_counts_reach_before_limits_before_rates(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The ends are looked at before."""
    retreats, rows = TASK.retreats, ROWS.copy()
    told(monkeypatch, rows, {}, (JOINT_RATE_RAD_M + 5.0, 3, 7))
    assert told_failure() == (Stage.JUMP_IN_CUT_IN, pytest.approx(-5.0), 3, 7)
    rows[4, 1], rows[9, 2] = TASK.upper[1] + 0.1, TASK.lower[2] - 0.3
    rows[0, 3] = rows[-1, 3] = TASK.upper[3] + 5.0
    assert told_failure() == (Stage.LIMIT_IN_CUT_IN, pytest.approx(-0.3), 2, 9)
    told(monkeypatch, rows, {float(retreats[3]): -0.1, float(retreats[6]): -0.2})
    assert told_failure() == (Stage.REACH_IN_CUT_IN, -0.2, 0, 6)
    told(monkeypatch, ROWS, {}, (JOINT_RATE_RAD_M, 3, 7))
    assert told_failure() == (Stage.FEASIBLE, 0.0, 0, 0)


def test_the_fastest_joint_is_told_with_its_row() -> None:
    rate, joint, row = fastest_joint(TASK.geometry, TASK.retreats, ROWS)
    apart = np.abs(np.diff(ROWS, axis=0)) / -np.diff(TASK.retreats)[:, None]
    assert rate >= apart.max() - 1e-9
    assert 0 <= joint < 6
    assert 0 <= row <= LAST
    assert limit_margin(TASK, ROWS[-1])[0] >= 0.0


@pytest.mark.parametrize("arm", range(4))
def test_the_reach_alone_is_that_of_a_posture(arm: int) -> None:
    for angle in (0.2, -1.0, 2.5):
        axes, q = np.empty((3, 3)), np.empty(6)
        tool_axes(TASK, angle, axes)
        for wrist in range(2):
            reach = posture(TASK, axes, 0.0, 2 * arm + wrist, q)
            assert wrist_reach(TASK, axes, arm) == pytest.approx(reach, abs=1e-12)


def test_a_later_stage_is_closer_and_then_a_larger_margin() -> None:
    assert closer(3, -9.0, 2, -0.1)
    assert not closer(2, -0.1, 3, -9.0)
    assert closer(2, -0.1, 2, -0.2)
    assert not closer(2, -0.2, 2, -0.2)


@pytest.mark.parametrize("scale", [1.0, 1.4, 3.0])
def test_the_closest_of_all_branches_and_angles(scale: float) -> None:
    task = TASK._replace(position=scale * TASK.position)
    angles = -np.pi + 2 * np.pi * np.arange(10) / 10
    every = [
        (*failed(task, float(angle), branch), branch, float(angle))
        for branch in range(8)
        for angle in angles
    ]
    best = max(every, key=lambda one: one[:2])
    stage, margin, joint, row, branch, angle = closest_failure(task, angles, False)
    assert (stage, margin) == best[:2]
    assert failed(task, angle, branch) == (stage, margin, joint, row)
    assert angle in angles
    refined = closest_failure(task, angles, True)
    assert refined[:2] >= (stage, margin)
    if stage < Stage.FEASIBLE:
        assert failed(task, refined[5], int(refined[4]))[:2] == (
            refined[0], pytest.approx(refined[1], abs=1e-12),
        )  # fmt: skip
        assert abs(refined[5] - angle) <= 2 * math.pi / 10


@pytest.mark.parametrize("best", [0, 5, 7])
def test_beside_the_best_of_even_angles_a_better_one_is_closed_in_on(
    monkeypatch: pytest.MonkeyPatch, best: int
) -> None:
    """To 1e-10; one that is feasible after all is none of its kind."""

    def stand_in(task: Any, angle: float, branch: int, rows: Any) -> Any:
        assert 0 <= branch < 8
        margin = -0.1 - abs(angle - 0.777) - 0.1 * abs(branch - best)
        return Stage.LIMIT_AT_THINNING, margin, 3, 1

    interpret(
        monkeypatch, module, failure=stand_in, wrist_reach=lambda *_: 1.0,
        tool_axes=lambda *_: None,
    )  # fmt: skip
    angles = -np.pi + 2 * np.pi * np.arange(12) / 12
    found = interpreted(closest_failure)(TASK, angles, True)
    assert found[:4] == (Stage.LIMIT_AT_THINNING, pytest.approx(-0.1, abs=1e-9), 3, 1)
    assert found[4:] == (best, pytest.approx(0.777, abs=1e-9))
    coarse = interpreted(closest_failure)(TASK, angles, False)
    assert coarse[5] in angles


def test_angles_out_of_reach_are_passed_over_where_others_came_closer(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    looked: list[tuple[float, int]] = []

    def stand_in(task: Any, angle: float, branch: int, rows: Any) -> Any:
        looked.append((angle, branch))
        return Stage.REACH_AT_THINNING, -0.5 + angle / 10, 0, 4

    reach = {"now": [-0.5, -0.3, -0.4, 0.1]}
    interpret(
        monkeypatch, module, failure=stand_in, tool_axes=lambda *_: None,
        wrist_reach=lambda task, axes, arm: reach["now"][len(looked) % 4],
    )  # fmt: skip
    interpreted(closest_failure)(TASK, np.array([1.0, 2.0]), False)
    assert looked[0] == (1.0, 0)
    assert {branch for _, branch in looked} <= set(range(8))


@pytest.mark.parametrize("turns", [-1, 0, 1])
def test_limits_are_those_of_the_turn_next_to_the_reference(turns: int) -> None:
    """Of a joint that may turn further than once, and not of the closed form's own."""
    value = ROWS[-1, 5] + 2 * math.pi * turns
    # A range of more than a turn that the closed form's own value is outside of.
    ends = (value - 5.9, value + 0.5) if turns >= 0 else (value - 0.5, value + 5.9)
    moved = drawn_in(5, *ends)
    stage, *_ = failed(moved._replace(reference=np.append(TASK.reference[:5], value)))
    assert stage == Stage.FEASIBLE
