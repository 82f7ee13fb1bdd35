"""`ncos` between the programme's answer and its warm start, on answers that are told."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.approach.optimum.on_arcs import ArcOptimum, best_on_arcs
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.methods import ncos
from solver.methods.coupling import Coupling
from solver.methods.ncos import _bears_less, improved, improved_in_chain, solve_ncos
from solver.methods.nlp.instance import Instance, ProgrammeResult
from solver.problem.solution import Reason
from tests.solver.kinematics.arms import ur5
from tests.solver.methods.on_rail import TARGETS, task_of
from tests.solver.methods.synthetic import small_task

FOLLOWING = (0.4, 0.9, -1.0, 0.3, 1.2, -0.2)
TASK = small_task(0)


def start_of(task: ApproachTask = TASK) -> ArcOptimum:
    best = best_on_arcs(task)
    assert best is not None
    return best


def ends_at(monkeypatch: pytest.MonkeyPatch, angle: float, success: bool = True) -> list[Instance]:
    given: list[Instance] = []

    def solve(robot: object, instance: Instance, options: object) -> ProgrammeResult:
        given.append(instance)
        x = instance.x0.copy()
        x[12] = angle
        return ProgrammeResult(success, "told", 11, x)

    monkeypatch.setattr(ncos, "solve_instance", solve)
    return given


def at(task: ApproachTask, start: ArcOptimum, angle: float) -> Candidate:
    return ncos._at_angle(task, start, angle)


def test_a_failed_programme_leaves_the_warm_start(monkeypatch: pytest.MonkeyPatch) -> None:
    ends_at(monkeypatch, 0.0, success=False)
    start = start_of()
    answer = improved(TASK, start)
    assert (answer.status, answer.iterations) == ("warm_start_after_told", 11)
    assert answer.approach_angle_rad == pytest.approx(start.angle_rad)
    assert answer.effort == pytest.approx(start.effort)


def test_what_is_dearer_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    start = start_of()
    ends_at(monkeypatch, start.angle_rad + 0.1)
    answer = improved(TASK, start)
    assert (answer.status, answer.iterations) == ("solved_warm_start_as_good", 11)
    assert answer.approach_angle_rad == pytest.approx(start.angle_rad)


def test_what_is_cheaper_is_taken_and_polished(monkeypatch: pytest.MonkeyPatch) -> None:
    best = start_of()
    ends_at(monkeypatch, best.angle_rad)
    answer = improved(TASK, replace(best, angle_rad=best.angle_rad + 0.1))
    assert (answer.status, answer.iterations) == ("solved", 11)
    assert answer.thinning_joints == TASK.thinning_joints(best.angle_rad, 1, best.arc.branch)
    # As dear is as good as solved.
    assert improved(TASK, best).status == "solved"


@pytest.mark.parametrize("end", ["lower_rad", "upper_rad"])
def test_the_answer_is_on_the_start_s_arc(monkeypatch: pytest.MonkeyPatch, end: str) -> None:
    best = start_of()
    edge = getattr(best.arc, end)
    beyond = edge + (0.3 if end == "upper_rad" else -0.3)
    ends_at(monkeypatch, beyond)
    monkeypatch.setattr(Coupling, "cost", lambda self, candidate: 0.0)
    assert improved(TASK, best).approach_angle_rad == pytest.approx(edge)


def test_with_a_next_target_the_batch_s_cost_decides(monkeypatch: pytest.MonkeyPatch) -> None:
    best = start_of()
    costs = {
        beside: Coupling(TASK, FOLLOWING).cost(at(TASK, best, best.angle_rad + beside))
        for beside in (-0.1, 0.0, 0.1)
    }
    cheaper = min(costs, key=lambda beside: costs[beside])
    assert cheaper != 0.0
    given = ends_at(monkeypatch, best.angle_rad + cheaper)
    answer = improved(TASK, best, FOLLOWING)
    assert (answer.status, answer.iterations) == ("solved", 11)
    assert answer.effort > best.effort
    assert given[0].programme.shape.coupled
    assert given[0].parameters[18:24].tolist() == list(FOLLOWING)
    assert improved(TASK, best).status == "solved_warm_start_as_good"
    assert not given[1].programme.shape.coupled


def test_what_bears_less_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    best = start_of()
    asked: list[Any] = []
    ends_at(monkeypatch, best.angle_rad)

    def first(task: object, places: Any) -> int:
        asked.append(places)
        return 1

    monkeypatch.setattr(ncos, "first_at_level", first)
    start = replace(best, angle_rad=best.angle_rad + 0.1)
    assert improved(TASK, start).status == "solved_warm_start_as_good"
    found, kept = asked[0]
    assert found == (pytest.approx(best.angle_rad), 1, best.arc.branch)
    assert kept == (pytest.approx(best.angle_rad + 0.1), 1, best.arc.branch)
    monkeypatch.setattr(ncos, "first_at_level", lambda *_: None)
    assert improved(TASK, start).status == "solved_warm_start_as_good"


def test_places_without_a_branch_count_as_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def first(task: object, places: Any) -> int:
        asked.append(places)
        return 0

    monkeypatch.setattr(ncos, "first_at_level", first)
    one = Candidate(0.25, 1, None, (), 1.0, 1, "")
    two = Candidate(0.5, -1, 6, (), 1.0, 1, "")
    assert not _bears_less(TASK, one, two)
    assert asked == [[(0.25, 1, 0), (0.5, -1, 6)]]


def test_the_programme_starts_on_the_arc_unrelaxed(monkeypatch: pytest.MonkeyPatch) -> None:
    task = small_task(0, strike_zone_m=0.02, tilt_tolerance_rad=0.2, norm="l2")
    best = start_of()
    (given,) = [ends_at(monkeypatch, best.angle_rad)]
    ncos.solve_on_arc(task, best)
    (instance,) = given
    shape = instance.programme.shape
    assert (shape.norm, shape.strike, shape.tilt, shape.rows) == ("l2", False, False, 0)
    arc = best.arc
    assert instance.x0[12] == pytest.approx(best.angle_rad)
    assert (instance.lower[12], instance.upper[12]) == (arc.lower_rad, arc.upper_rad)
    rows = task.postures(best.angle_rad, 1, arc.branch, np.array([0.04, 0.0]))
    assert instance.x0[:12].reshape(2, 6) == pytest.approx(rows[::-1])
    assert instance.parameters[30:32].tolist() == [0.0, 0.04]


def test_in_a_chain_relaxed_stops_go_another_way(monkeypatch: pytest.MonkeyPatch) -> None:
    best = start_of()
    monkeypatch.setattr(ncos, "improved", lambda *given: given)
    monkeypatch.setattr(ncos, "between_neighbours", lambda *given: given)
    plain: Any = improved_in_chain(TASK, best, FOLLOWING)
    assert plain == (TASK, best, FOLLOWING)
    relaxed = small_task(0, strike_zone_m=0.02)
    given: Any = improved_in_chain(relaxed, best, FOLLOWING)
    task, kept, coupling = given
    assert task is relaxed
    assert kept == at(relaxed, best, best.angle_rad)
    assert coupling == Coupling(relaxed, FOLLOWING)


def test_each_family_of_arms_goes_its_way(monkeypatch: pytest.MonkeyPatch) -> None:
    reason = Reason("out_of_reach", "")
    for name in ("solve_on_rail", "solve_other_arm", "solve_relaxed", "diagnose", "improved"):
        monkeypatch.setattr(ncos, name, lambda *given, name=name: (name, given[0]))
    solve: Any = solve_ncos
    rail = task_of(TARGETS[0])
    assert solve(rail) == ("solve_on_rail", rail)
    other = replace(TASK, robot=ur5(), tool=ur5().tools[0])
    assert solve(other) == ("solve_other_arm", other)
    relaxed = small_task(0, strike_zone_m=0.02)
    assert solve(relaxed) == ("solve_relaxed", relaxed)
    monkeypatch.setattr(ncos, "best_on_arcs", lambda _: None)
    assert solve(TASK) == ("diagnose", TASK)
    monkeypatch.setattr(ncos, "best_on_arcs", lambda _: reason)
    assert solve(TASK) == ("improved", TASK)
