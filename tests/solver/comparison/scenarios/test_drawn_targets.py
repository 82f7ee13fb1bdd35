"""`workspace`, `near-limits`, `fixed-or-floating`: other seeds and sizes keep what they promise."""

import pytest

from solver import Problem, feasible_arcs
from solver.comparison.scenarios.fixed_or_floating import fixed_or_floating_problem
from solver.comparison.scenarios.near_limits import NARROW_RAD, near_limits_problem
from solver.comparison.scenarios.workspace import workspace_problem


def widest(problem: Problem) -> list[float]:
    return [
        max((arc.upper_rad - arc.lower_rad for arc in arcs), default=-1.0)
        for arcs in feasible_arcs(problem).values()
    ]


def test_workspace_targets_have_arcs() -> None:
    assert workspace_problem(3, 20).targets != workspace_problem(4, 20).targets
    found = widest(workspace_problem(3, 20))
    assert len(found) == 20
    assert min(found) > 0


def test_near_limits_targets_have_narrow_arcs_only() -> None:
    found = widest(near_limits_problem(3, 20))
    assert len(found) == 20
    assert min(found) > 0
    assert max(found) <= NARROW_RAD


def test_too_few_targets_are_no_scenario(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("solver.comparison.scenarios.near_limits.NARROW_RAD", 1e-9)
    with pytest.raises(ValueError, match="narrow"):
        near_limits_problem(3, 20)


def test_branches_suit_the_fixed_z_axis() -> None:
    problem = fixed_or_floating_problem(3, 20)
    assert len(problem.targets) == 20
    assert all(target.branch_direction[0] == 0.0 for target in problem.targets)
