import numpy as np
import pytest

from solver import Options, Problem, Robot
from solver.approach.optimum.batch import closed_form_optima
from solver.approach.optimum.batch_search import NO_BRANCH
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.task import approach_task
from solver.problem.options import Norm
from solver.problem.retreats import even_retreats
from tests.solver.problems import random_targets


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_a_batch_has_the_optima_of_its_targets(tabletop: Robot, norm: Norm) -> None:
    targets = random_targets(51, 60)
    options = Options(
        norm=norm, symmetric_tool=norm == "l2", include=("path",), position_margin_m=0.0
    )
    problem = Problem(tabletop, targets, options=options)
    positions = np.array([target.position_m for target in targets])
    directions = np.array([target.branch_direction for target in targets])
    starts = np.random.default_rng(51).uniform(tabletop.lower, tabletop.upper, (60, 6))
    optima = closed_form_optima(problem, positions, directions, starts)
    shuffled = np.random.default_rng(52).permutation(60)
    again = closed_form_optima(problem, positions[shuffled], directions[shuffled], starts[shuffled])
    assert np.array_equal(again.efforts, optima.efforts[shuffled])
    found = 0
    for k, target in enumerate(targets):
        task = approach_task(problem, target, starts[k])
        alone = best_on_arcs(task)
        if alone is None:
            assert optima.branches[k] == NO_BRANCH
            assert np.isnan(optima.paths[k]).all()
            continue
        found += 1
        assert optima.efforts[k] == pytest.approx(alone.effort, rel=1e-12)
        rows = task.postures(
            float(optima.angles_rad[k]),
            int(optima.tool_sides[k]),
            int(optima.branches[k]),
            even_retreats(task.options),
        )
        assert optima.paths[k] == pytest.approx(rows, abs=1e-9)
    assert found >= 20
