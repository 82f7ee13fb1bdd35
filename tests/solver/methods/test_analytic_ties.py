"""Which arc `as` takes, of arcs that are told."""

import pytest

from solver import Arc
from solver.approach.task.candidate import Candidate
from solver.methods import analytic
from solver.methods.analytic import solve_as
from solver.problem.effort import posture_effort
from solver.problem.solution import Reason
from tests.solver.methods.synthetic import small_task


def chosen(monkeypatch: pytest.MonkeyPatch, *arcs: Arc) -> Candidate:
    monkeypatch.setattr(analytic, "task_arcs", lambda _: "all")
    monkeypatch.setattr(analytic, "arcs_at_level", lambda _, every: arcs if every == "all" else ())
    task = small_task(symmetric_tool=True, norm="l2")
    answer = solve_as(task)
    assert isinstance(answer, Candidate)
    joints = task.thinning_joints(answer.approach_angle_rad, answer.tool_side, answer.branch or 0)
    assert answer.thinning_joints == pytest.approx(joints)
    cost = posture_effort(answer.thinning_joints, task.reference, task.joint_weights, "l2")
    assert answer.effort == pytest.approx(cost)
    assert (answer.iterations, answer.status) == (len(arcs), "middle_of_widest_arc")
    return answer


def test_the_middle_of_the_widest(monkeypatch: pytest.MonkeyPatch) -> None:
    answer = chosen(monkeypatch, Arc(1, 2, -0.25, 0.25), Arc(1, 3, 0.0, 0.75), Arc(-1, 5, 1.0, 1.5))
    assert (answer.approach_angle_rad, answer.tool_side, answer.branch) == (0.375, 1, 3)
    beyond = chosen(monkeypatch, Arc(1, 2, 3.0, 4.0))
    assert beyond.approach_angle_rad == pytest.approx(3.5 - 6.283185307179586)


def test_ties_go_to_the_first_side_and_then_to_the_lower_branch(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    arcs = [Arc(-1, 0, 0.0, 0.5), Arc(1, 6, 0.0, 0.5), Arc(1, 4, 0.5, 1.0), Arc(1, 5, 0.0, 0.5)]
    answer = chosen(monkeypatch, *arcs)
    assert (answer.tool_side, answer.branch) == (1, 4)
    assert chosen(monkeypatch, *arcs[::-1]).branch == 4


def test_without_an_arc_there_is_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    reason = Reason("out_of_reach", "too far")
    monkeypatch.setattr(analytic, "task_arcs", lambda _: ())
    monkeypatch.setattr(analytic, "diagnose", lambda _: reason)
    assert solve_as(small_task()) is reason
