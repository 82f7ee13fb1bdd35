"""What every method keeps, whichever file it is in: run over the registry."""

from dataclasses import replace

import pytest

from solver import Options, Problem, Robot, Target, solve
from solver.approach.task.candidate import Candidate
from solver.approach.task.frame import signed_angle
from solver.approach.task.task import approach_task
from solver.methods.registry import METHODS
from solver.problem.options import MethodName
from solver.problem.solution import REASON_CODES, Reason
from tests.solver.problems import random_targets


def targets_for(method: MethodName, seed: int, count: int) -> list[Target]:
    """Random targets; for `fixed_z` with branches normal to the x axis, as it takes no others."""
    targets = random_targets(seed, count)
    if method != "fixed_z":
        return targets
    return [
        replace(target, branch_direction=(0.0, *target.branch_direction[1:])) for target in targets
    ]


@pytest.mark.parametrize("name", METHODS)
def test_answers_are_candidates_or_reasons(tabletop: Robot, name: MethodName) -> None:
    problem = Problem(tabletop, targets_for(name, seed=51, count=30), options=Options(method=name))
    candidates = reasons = 0
    for target in problem.targets:
        outcome = METHODS[name].solve(approach_task(problem, target, problem.start))
        if isinstance(outcome, Reason):
            assert outcome.code in REASON_CODES
            assert outcome.detail
            reasons += 1
            continue
        assert isinstance(outcome, Candidate)
        assert outcome.approach_angle_rad == signed_angle(outcome.approach_angle_rad)
        assert outcome.branch in range(8)
        assert outcome.tool_side == 1
        assert outcome.status
        candidates += 1
    assert candidates >= 5
    assert reasons >= 5


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("tool", ["laser", "scaffold"])
def test_symmetric_tools_and_both_tools_are_planned(
    tabletop: Robot, name: MethodName, tool: str
) -> None:
    options = Options(method=name, symmetric_tool=True, norm="l2")
    targets = targets_for(name, seed=52, count=24)
    plan = solve(Problem(tabletop, targets, tool=tool, options=options))
    assert plan.planned >= 2
    assert all(a.reason is None or a.reason.code != "solver_failed" for a in plan.approaches)


def test_rows_are_named_after_themselves() -> None:
    assert all(name == row.name and row.summary for name, row in METHODS.items())
