import math

import pytest

from solver import Options, Problem, Robot
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.task import approach_task
from solver.problem.options import Norm
from tests.solver.methods.brute_force import least_effort_of_sweep
from tests.solver.problems import random_targets

ANGLES = 65_536


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_not_worse_than_a_sweep(tabletop: Robot, norm: Norm) -> None:
    targets = random_targets(seed=11, count=50 if norm == "l1" else 10)
    problem = Problem(tabletop, targets, options=Options(norm=norm, position_margin_m=0.0))
    solved = 0
    for target in targets:
        task = approach_task(problem, target, problem.start)
        sweep = least_effort_of_sweep(task, ANGLES)
        best = best_on_arcs(task)
        if best is None:
            assert sweep == math.inf, f"target {target.id} was missed"
            continue
        solved += 1
        assert best.effort <= sweep * (1 + 1e-9), f"target {target.id} is dearer than the sweep"
    assert solved >= len(targets) // 4


def test_a_symmetric_tool_is_never_dearer(tabletop: Robot) -> None:
    targets = random_targets(seed=12, count=40)
    plain = Problem(tabletop, targets)
    symmetric = Problem(tabletop, targets, options=Options(symmetric_tool=True))
    gains = 0
    for target in targets:
        one = best_on_arcs(approach_task(plain, target, plain.start))
        two = best_on_arcs(approach_task(symmetric, target, plain.start))
        if one is not None:
            assert two is not None
            assert two.effort <= one.effort
            gains += two.effort < one.effort
    assert gains > 0
