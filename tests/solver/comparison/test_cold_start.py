"""What the benchmark counts as solved without a warm start."""

import pytest

from solver import Robot
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.task import approach_task
from solver.comparison import cold_start
from solver.comparison.cold_start import cold_solve
from solver.methods.nlp import sqp
from solver.methods.nlp.backends import BACKENDS
from solver.problem.options import BackendName
from tests.solver.problems import data_set_3


@pytest.mark.parametrize("backend", BACKENDS)
def test_more_starts_solve_more_and_none_is_cheaper_than_the_optimum(
    tabletop: Robot, backend: BackendName
) -> None:
    problem = data_set_3(tabletop, norm="l2")
    solved = {1: 0, 8: 0}
    for target in problem.targets:
        task = approach_task(problem, target, problem.start)
        best = best_on_arcs(task)
        assert best is not None
        for starts in solved:
            success, elapsed_s, effort = cold_solve(task, backend, starts, seed=3)
            assert elapsed_s > 0
            assert not success or effort >= best.effort * (1 - 1e-6)
            solved[starts] += success
    assert solved[8] >= max(3, solved[1])


def test_same_seed_same_answer(tabletop: Robot) -> None:
    problem = data_set_3(tabletop)
    task = approach_task(problem, problem.targets[0], problem.start)
    first, second = (cold_solve(task, "sqp", 3, seed=1) for _ in range(2))
    assert (first.success, first.effort) == (second.success, second.effort)


def test_a_failure_is_none(tabletop: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = data_set_3(tabletop)
    task = approach_task(problem, problem.targets[0], problem.start)
    monkeypatch.setattr(sqp, "SQP_ITERATIONS", 0)
    assert not cold_solve(task, "sqp", 2, seed=1).success
    assert cold_start.ColdResult._fields[:2] == ("success", "elapsed_s")
