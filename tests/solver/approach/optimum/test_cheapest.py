"""The search that leaves cells out finds what the search of every arc finds."""

import numpy as np
import pytest

from solver import Options, Problem, Robot, Target, load_robot
from solver.approach.optimum.batch import closed_form_optima
from solver.approach.optimum.batch_search import NO_BRANCH
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.task import approach_task
from solver.problem.options import Norm
from solver.robots.model import Array
from solver.tolerances import EFFORT_ERROR_RELATIVE
from tests.solver.approach.targets import SETS
from tests.solver.problems import in_front_of, random_targets


def agreeing(problem: Problem, targets: list[Target], references: Array) -> int:
    """How many targets have an approach, after both searches agreed on each."""
    positions = np.array([target.position_m for target in targets], dtype=np.float64)
    directions = np.array([target.branch_direction for target in targets], dtype=np.float64)
    found = closed_form_optima(problem, positions, directions, references)
    for k, target in enumerate(targets):
        best = best_on_arcs(approach_task(problem, target, references[k]))
        assert (best is None) == (found.branches[k] == NO_BRANCH), target
        if best is not None:
            wanted = pytest.approx(best.effort, rel=EFFORT_ERROR_RELATIVE)
            assert found.efforts[k] == wanted, target
    return int(np.count_nonzero(found.branches != NO_BRANCH))


def drawn(robot: Robot, seed: int, count: int) -> Array:
    """Reference postures anywhere inside the limits, shape (count, 6) [rad]."""
    return np.random.default_rng(seed).uniform(robot.lower, robot.upper, (count, 6))


@pytest.mark.parametrize("norm", ["l1", "l2"])
@pytest.mark.parametrize("symmetric", [False, True])
def test_from_any_posture(tabletop: Robot, norm: Norm, symmetric: bool) -> None:
    targets = random_targets(71, 400)
    options = Options(norm=norm, symmetric_tool=symmetric, include=("path",), position_margin_m=0.0)
    problem = Problem(tabletop, targets, options=options)
    assert agreeing(problem, targets, drawn(tabletop, 72, 400)) > 100


@pytest.mark.parametrize("norm", ["l1", "l2"])
@pytest.mark.parametrize("kind", SETS)
def test_hard_targets(tabletop: Robot, kind: str, norm: Norm) -> None:
    targets = SETS[kind](tabletop, 40)
    problem = Problem(
        tabletop, targets, options=Options(norm=norm, include=("path",), position_margin_m=0.0)
    )
    found = agreeing(problem, targets, drawn(tabletop, 73, len(targets)))
    assert found >= 8, found


def test_joints_of_more_than_a_turn() -> None:
    puma = load_robot("puma560")
    targets = in_front_of(puma, random_targets(74, 150))
    problem = Problem(puma, targets, options=Options(include=("path",), position_margin_m=0.0))
    assert agreeing(problem, targets, drawn(puma, 75, len(targets))) > 30


def test_a_minimum_beside_the_edge_of_reach(tabletop: Robot) -> None:
    """There effort turns close to the end of an arc, far less than samples are apart."""
    position = (0.08501554904745329, -0.25740378765408517, 0.3328555039698048)
    target = Target("1", position, (-0.384055764187898, 0.08938640066787273, -0.3851992639362074))
    reference = (1.550165080431654, 0.40425184469010866, -0.39045001730204354,
                 -0.4896382694536503, -1.115273946733058, -2.3785641403629576)  # fmt: skip
    problem = Problem(
        tabletop, [target], options=Options(norm="l2", include=("path",), position_margin_m=0.0)
    )
    found = closed_form_optima(
        problem, np.array([position]), np.array([target.branch_direction]), np.array([reference])
    )
    assert found.efforts[0] == pytest.approx(16.14087928072037, rel=1e-9)
    assert agreeing(problem, [target], np.array([reference])) == 1
