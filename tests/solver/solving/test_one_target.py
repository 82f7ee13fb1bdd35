from dataclasses import replace

import pytest

from solver import Robot
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.methods.registry import METHODS
from solver.methods.semi_analytic import solve_ssas
from solver.problem.solution import INFEASIBLE, PLANNED
from solver.solving import one_target
from solver.solving.one_target import plan_target
from tests.solver.problems import data_set_3


def turned(candidate: Candidate) -> Candidate:
    """The candidate beside its target: nothing that verifies."""
    joints = tuple(value + 0.01 for value in candidate.thinning_joints)
    return replace(candidate, thinning_joints=joints)


@pytest.mark.parametrize("whole", [0, 1, 2, None])
def test_a_candidate_that_does_not_verify_makes_way(
    tabletop: Robot, monkeypatch: pytest.MonkeyPatch, whole: int | None
) -> None:
    problem = data_set_3(tabletop, method="ssas")

    def solve(task: ApproachTask) -> Candidate:
        found = solve_ssas(task)
        assert isinstance(found, Candidate)
        first, *others = (found if k == whole else turned(found) for k in range(3))
        return replace(first, others=tuple(others))

    methods = {"ssas": replace(METHODS["ssas"], solve=solve)}
    monkeypatch.setattr(one_target, "METHODS", methods)
    monkeypatch.setattr(one_target, "broken_between", lambda task, candidate: None)
    approach = plan_target(problem, problem.targets[0], problem.start)
    if whole is None:
        assert approach.status == INFEASIBLE
        assert approach.reason is not None
        assert approach.reason.code == "solver_failed"
    else:
        assert approach.status == PLANNED
