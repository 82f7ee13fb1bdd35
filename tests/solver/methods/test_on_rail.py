"""`ncos` on a rail between the programme's slide and the search's, on answers that are told."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.kinematics.families.family import Rail
from solver.kinematics.families.on_rail import split_rail
from solver.kinematics.forward import forward_kinematics
from solver.methods import on_rail
from solver.methods.nlp.instance import Instance, ProgrammeResult
from solver.methods.on_rail import _standing_at, solve_on_rail
from solver.methods.rail import at_rail, rail_effort
from solver.methods.semi_analytic import solve_ssas
from solver.problem.solution import Reason
from tests.solver.methods.on_rail import TARGETS, task_of

TASK = task_of(TARGETS[0])
_FOUND = split_rail(TASK.robot)
assert _FOUND is not None
RAIL: Rail = _FOUND
KEPT = 0.2


def run(
    monkeypatch: pytest.MonkeyPatch,
    effort: Callable[[float], float | None],
    slide: float = KEPT,
    success: bool = True,
) -> tuple[Candidate | Reason, list[Instance]]:
    """With the effort of each position, and where the programme puts the slide."""
    given: list[Instance] = []

    def solve(robot: object, instance: Instance, options: object) -> ProgrammeResult:
        given.append(instance)
        x = instance.x0.copy()
        x[0] = slide
        return ProgrammeResult(success, "told", 100, x)

    def standing(task: object, rail: object, position: float) -> Candidate | Reason:
        cost = effort(position)
        if cost is None:
            return Reason("joint_limit", f"at {position}")
        joints = solve_ssas(at_rail(TASK, RAIL, KEPT))
        assert isinstance(joints, Candidate)
        return replace(
            joints, thinning_joints=(position, *joints.thinning_joints), effort=cost, iterations=1
        )

    monkeypatch.setattr(on_rail, "cheapest_position", lambda *_: (KEPT, 10))
    monkeypatch.setattr(on_rail, "_standing_at", standing)
    monkeypatch.setattr(on_rail, "solve_instance", solve)
    return solve_on_rail(TASK, RAIL), given


def test_the_slide_goes_where_the_programme_puts_it(monkeypatch: pytest.MonkeyPatch) -> None:
    answer, given = run(monkeypatch, lambda place: 3.0 - place, slide=0.25)
    assert isinstance(answer, Candidate)
    assert (answer.status, answer.iterations) == ("solved", 111)
    assert answer.thinning_joints[0] == 0.25
    # It starts where the search put it, straight in front of its standby.
    assert given[0].x0[0] == KEPT
    assert given[0].x0[7] == pytest.approx(KEPT)


@pytest.mark.parametrize("effort", [lambda place: 3.0 + place, lambda place: 3.0])
def test_a_slide_that_gains_nothing_stays(
    monkeypatch: pytest.MonkeyPatch, effort: Callable[[float], float]
) -> None:
    answer, _ = run(monkeypatch, effort, slide=0.25)
    assert isinstance(answer, Candidate)
    assert (answer.status, answer.iterations) == ("solved_warm_start_as_good", 110)
    assert answer.thinning_joints[0] == KEPT


def test_where_there_is_no_approach_it_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    answer, _ = run(monkeypatch, lambda place: 3.0 if place == KEPT else None, slide=0.25)
    assert isinstance(answer, Candidate)
    assert (answer.status, answer.iterations) == ("solved_warm_start_as_good", 110)
    reason, given = run(monkeypatch, lambda place: None)
    assert reason == Reason("joint_limit", f"at {KEPT}")
    assert given == []


def test_a_programme_that_fails_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    answer, _ = run(monkeypatch, lambda place: 3.0 - place, slide=0.25, success=False)
    assert isinstance(answer, Candidate)
    assert (answer.status, answer.iterations) == ("warm_start_after_told", 110)
    assert answer.thinning_joints[0] == KEPT


@pytest.mark.parametrize(("slide", "place"), [(9.0, TASK.upper[0]), (-9.0, TASK.lower[0])])
def test_the_slide_stays_on_its_rail(
    monkeypatch: pytest.MonkeyPatch, slide: float, place: float
) -> None:
    answer, _ = run(monkeypatch, lambda at: 3.0 if at == KEPT else 2.0, slide=slide)
    assert isinstance(answer, Candidate)
    assert answer.thinning_joints[0] == place


def test_where_no_position_has_an_approach_the_rail_s_reason_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(on_rail, "cheapest_position", lambda *_: None)
    monkeypatch.setattr(on_rail, "over_rail", lambda task, rail, solve: (task, rail, solve))
    given: Any = solve_on_rail(TASK, RAIL)
    assert given == (TASK, RAIL, solve_ssas)


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_standing_at_a_position_counts_the_slide_s_travel(norm: str) -> None:
    task: ApproachTask = task_of(TARGETS[0], norm=norm)
    found, alone = _standing_at(task, RAIL, 0.3), solve_ssas(at_rail(task, RAIL, 0.3))
    assert isinstance(found, Candidate)
    assert isinstance(alone, Candidate)
    assert found.thinning_joints == (0.3, *alone.thinning_joints)
    assert found.effort == pytest.approx(alone.effort + rail_effort(task, 0.3))
    pose = forward_kinematics(task.robot, task.tool, np.asarray(found.thinning_joints))
    assert pose[:3, 3] == pytest.approx(task.target.position_m, abs=1e-9)
    nowhere = _standing_at(task_of(TARGETS[2]), RAIL, 0.3)
    assert isinstance(nowhere, Reason)
