"""`ncos` without a closed form: which start's answer is taken, on answers that are told."""

from typing import Any

import numpy as np
import pytest

from solver import Options, Problem
from solver.approach.numerical.warm_start import NumericalStart
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask, approach_task
from solver.methods import other_arm
from solver.methods.nlp.instance import Instance, ProgrammeResult
from solver.methods.other_arm import _from_start, solve_other_arm
from solver.problem.effort import posture_effort
from solver.problem.solution import Reason
from tests.solver.kinematics.arms import ur5
from tests.solver.problems import reachable_targets

ROBOT = ur5()
TARGET = reachable_targets(ROBOT, seed=5, count=1)[0]


def task_of(**options: object) -> ApproachTask:
    chosen = Options(include=("path",), **options)  # type: ignore[arg-type]
    problem = Problem(ROBOT, [TARGET], options=chosen)
    return approach_task(problem, TARGET, problem.start)


TASK = task_of()
START = NumericalStart(0.5, 1, np.linspace(-1.0, 1.0, 6), 4.0)


def candidate(effort: float, iterations: int, status: str = "solved") -> Candidate:
    return Candidate(0.1, 1, None, (0.0,) * 6, effort, iterations, status)


def solved(
    monkeypatch: pytest.MonkeyPatch, efforts: list[float], answers: list[Candidate]
) -> Candidate | Reason:
    starts = tuple(NumericalStart(0.5, 1, np.full(6, effort), effort) for effort in efforts)
    left = iter(answers)

    def warm_starts(task: object, most: int) -> tuple[NumericalStart, ...]:
        assert most == 2
        return starts

    monkeypatch.setattr(other_arm, "numerical_warm_starts", warm_starts)
    monkeypatch.setattr(other_arm, "_from_start", lambda *_: next(left))
    return solve_other_arm(TASK)


def test_the_cheapest_that_was_solved_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    answers = [candidate(3.5, 10), candidate(3.0, 5), candidate(1.0, 1, "failed")]
    answer = solved(monkeypatch, [4.0, 5.0, 6.0], answers)
    assert answer == candidate(3.0, 16)
    assert solved(monkeypatch, [3.0, 5.0, 6.0], answers) == candidate(3.0, 16)


@pytest.mark.parametrize(
    "answers",
    [
        [candidate(4.5, 10, "as told"), candidate(4.2, 5)],
        [candidate(3.5, 10, "as told"), candidate(3.0, 5, "failed")],
    ],
)
def test_where_none_is_as_cheap_as_the_first_start_that_is_kept(
    monkeypatch: pytest.MonkeyPatch, answers: list[Candidate]
) -> None:
    answer = solved(monkeypatch, [4.0, 5.0], answers)
    assert answer == Candidate(0.5, 1, None, (4.0,) * 6, 4.0, 15, "as told")


def test_without_a_start_the_reason_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    reason = Reason("out_of_reach", "too far")
    monkeypatch.setattr(other_arm, "numerical_warm_starts", lambda *_: reason)
    assert solve_other_arm(TASK) is reason


def from_start(
    monkeypatch: pytest.MonkeyPatch,
    polished: np.ndarray | None,
    success: bool = True,
    angle: float = 4.0,
) -> tuple[Candidate, Instance, list[Any]]:
    given: list[Instance] = []
    asked: list[Any] = []

    def solve(robot: object, instance: Instance, options: object) -> ProgrammeResult:
        given.append(instance)
        x = instance.x0.copy()
        x[0], x[12] = 99.0, angle
        return ProgrammeResult(success, "told", 12, x)

    def polish(task: object, *rest: Any) -> np.ndarray | None:
        asked.extend(rest)
        return polished

    monkeypatch.setattr(other_arm, "solve_instance", solve)
    monkeypatch.setattr(other_arm, "polished_thinning", polish)
    return _from_start(TASK, START), given[0], asked


def test_a_programme_that_fails_leaves_its_start(monkeypatch: pytest.MonkeyPatch) -> None:
    answer, instance, _ = from_start(monkeypatch, None, success=False)
    assert (answer.status, answer.iterations) == ("warm_start_after_told", 12)
    assert answer.thinning_joints == tuple(START.thinning_joints)
    assert (answer.effort, answer.approach_angle_rad, answer.branch) == (4.0, 0.5, None)
    assert instance.x0[:6] == pytest.approx(START.thinning_joints)


def test_a_cut_in_that_breaks_leaves_its_start(monkeypatch: pytest.MonkeyPatch) -> None:
    answer, _, asked = from_start(monkeypatch, None)
    assert (answer.status, answer.iterations) == ("warm_start_kept_cut_in_breaks", 12)
    assert answer.effort == 4.0
    angle, side, near = asked
    assert (angle, side) == (pytest.approx(4.0 - 2 * np.pi), 1)
    assert near[0] == TASK.upper[0]
    assert near[1:] == pytest.approx(START.thinning_joints[1:])


@pytest.mark.parametrize("beyond", [-0.5, 0.0, 0.5])
def test_the_polished_posture_is_taken_unless_it_is_dearer(
    monkeypatch: pytest.MonkeyPatch, beyond: float
) -> None:
    polished = np.array(TASK.reference)
    polished[2] += START.effort + beyond
    cost = posture_effort(polished, TASK.reference, TASK.joint_weights, "l1")
    monkeypatch.setattr(other_arm, "posture_effort", lambda *_: round(cost, 9))
    answer, _, _ = from_start(monkeypatch, polished)
    if beyond > 0:
        assert (answer.status, answer.iterations) == ("solved_warm_start_as_good", 12)
        assert answer.effort == 4.0
        return
    assert (answer.status, answer.iterations) == ("solved", 12)
    assert answer.effort == pytest.approx(4.0 + beyond)
    assert answer.thinning_joints == tuple(polished)
    assert answer.approach_angle_rad == pytest.approx(4.0 - 2 * np.pi)
