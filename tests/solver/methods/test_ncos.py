from dataclasses import replace

import pytest

from solver import Options, Problem, Robot, solve
from solver.approach.task import approach_task
from solver.methods.candidate import Candidate
from solver.methods.ncos import solve_ncos
from solver.methods.semi_analytic import best_on_arcs
from solver.nlp import backends
from solver.nlp.backends import ProgrammeResult, solve_programme
from tests.solver.problems import data_set_3, random_targets


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_never_worse_than_its_warm_start_and_equal_to_1e_6(tabletop: Robot, norm: str) -> None:
    problem = Problem(tabletop, random_targets(seed=21, count=60), options=Options(norm=norm))
    solved = 0
    for target in problem.targets:
        task = approach_task(problem, target, problem.start)
        warm_start = best_on_arcs(task)
        answer = solve_ncos(task)
        if warm_start is None:
            assert not isinstance(answer, Candidate)
            continue
        assert isinstance(answer, Candidate)
        assert answer.effort <= warm_start.effort
        assert answer.effort == pytest.approx(warm_start.effort, rel=1e-6)
        solved += answer.status.startswith("solved")
    assert solved >= 15


def test_the_programme_finds_its_own_way_from_a_bad_start(tabletop: Robot) -> None:
    """It is an optimisation: started at the far end of the arc it comes to the same angle."""
    problem = data_set_3(tabletop, norm="l2")
    task = approach_task(problem, problem.targets[0], problem.start)
    best = best_on_arcs(task)
    assert best is not None
    start = replace(best, angle_rad=0.9 * best.arc.lower_rad + 0.1 * best.angle_rad)
    assert abs(start.angle_rad - best.angle_rad) > 0.3
    result = solve_programme(task, start)
    assert result.success
    assert result.approach_angle_rad == pytest.approx(best.angle_rad, abs=1e-5)


def test_a_failed_programme_returns_the_warm_start_and_says_so(
    tabletop: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = data_set_3(tabletop)
    monkeypatch.setattr(backends, "NLP_ITERATIONS", 0)
    backends._solver.cache_clear()
    try:
        plan = solve(problem)
    finally:
        backends._solver.cache_clear()
    ssas = solve(data_set_3(tabletop, method="ssas"))
    assert plan.planned == 5
    for approach, expected in zip(plan.approaches, ssas.approaches, strict=True):
        assert approach.solver.status == "warm_start_after_Maximum_Iterations_Exceeded"
        assert approach.effort == expected.effort


def test_result_carries_ipopt_account(tabletop: Robot) -> None:
    problem = data_set_3(tabletop)
    task = approach_task(problem, problem.targets[0], problem.start)
    best = best_on_arcs(task)
    assert best is not None
    result = solve_programme(task, best)
    assert isinstance(result, ProgrammeResult)
    assert result.status == "Solve_Succeeded"
    assert 0 < result.iterations < 50
