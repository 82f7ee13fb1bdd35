"""The sequential quadratic programme: what it ends in, and what helps it there."""

import numpy as np
import pytest

from solver import Options, Problem, Robot
from solver.approach.optimum.on_arcs import ArcOptimum, best_on_arcs
from solver.approach.task.task import ApproachTask, approach_task
from solver.methods.ncos import solve_on_arc
from solver.methods.nlp import sqp
from tests.solver.problems import random_targets


def starts(robot: Robot) -> list[tuple[ApproachTask, ArcOptimum]]:
    """Tasks with an arc, and a start in its middle, away from the optimum."""
    problem = Problem(robot, random_targets(88, 60), Options(norm="l2", position_margin_m=0.0))
    found = []
    for target in problem.targets:
        task = approach_task(problem, target, problem.start)
        best = best_on_arcs(task)
        if best is not None:
            middle = (best.arc.lower_rad + best.arc.upper_rad) / 2
            found.append((task, ArcOptimum(best.arc, middle, best.effort, 0)))
    return found


def iterations(robot: Robot) -> list[int]:
    counts = []
    for task, start in starts(robot):
        result = solve_on_arc(task, start)
        assert result.success, result.status
        counts.append(result.iterations)
    assert len(counts) >= 15
    return counts


def test_second_order_corrections_save_iterations(
    tabletop: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without them steps along the bent equations are halved (Nocedal and Wright, 15.6)."""
    with_them = np.array(iterations(tabletop))
    monkeypatch.setattr(sqp, "SQP_CORRECTIONS", 0)
    without = np.array(iterations(tabletop))
    assert with_them.sum() < without.sum()
    assert with_them.max() < without.max()
