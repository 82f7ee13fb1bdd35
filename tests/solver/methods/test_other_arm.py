"""`ncos` without a closed form, against a random scatter of its own and against other seeds."""

import numpy as np
import pytest

from solver import Options, Problem, Robot, solve
from solver.approach.numerical.warm_start import polished_thinning
from solver.approach.task.task import ApproachTask, approach_task
from solver.kinematics.forward import jacobian
from solver.problem.effort import posture_effort
from solver.problem.options import Norm
from solver.robots.model import Array
from tests.solver.kinematics.arms import seven_joints, ur5
from tests.solver.problems import reachable_targets


def effort_of(task: ApproachTask, posture: Array) -> float:
    return posture_effort(posture, task.reference, task.joint_weights, task.options.norm)


def scattered(task: ApproachTask, rng: np.random.Generator, draws: int, steps: int) -> float:
    """The least effort of random postures led to the target, and of random steps from the best."""
    found = []
    for _ in range(draws):
        angle = rng.uniform(-np.pi, np.pi)
        posture = polished_thinning(task, angle, 1, rng.uniform(task.lower, task.upper))
        if posture is not None:
            found.append((effort_of(task, posture), angle, posture))
    best = np.inf
    for effort, angle, posture in sorted(found, key=lambda entry: entry[0])[:2]:
        step, least = 0.2, effort
        for _ in range(steps):
            columns = jacobian(task.robot, task.tool, posture[None])[0]
            columns = np.column_stack((columns, [0, 0, 0, *-task.frame.branch]))
            still = np.linalg.svd(columns)[2][6:]
            way = still.T @ rng.normal(size=len(still))
            way *= step / np.linalg.norm(way)
            there = polished_thinning(task, angle + way[-1], 1, posture + way[:-1])
            if there is not None and effort_of(task, there) < least:
                angle, posture, least = angle + way[-1], there, effort_of(task, there)
                step = min(1.5 * step, 0.5)
            else:
                step *= 0.85
        best = min(best, least)
    return best


@pytest.mark.parametrize("robot", [ur5(), seven_joints()], ids=lambda robot: robot.name)
@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_a_random_scatter_finds_nothing_cheaper(robot: Robot, norm: Norm) -> None:
    targets = reachable_targets(robot, seed=5, count=4)
    options = Options(norm=norm, order="independent", include=("path",))
    problem = Problem(robot, targets, options=options)
    rng = np.random.default_rng(6)
    found = 0
    for target, approach in zip(targets, solve(problem).approaches, strict=True):
        task = approach_task(problem, target, problem.start)
        least = scattered(task, rng, draws=100, steps=50)
        found += np.isfinite(least)
        assert approach.effort is not None
        assert approach.effort <= least * 1.001
    assert found >= 2


def test_no_other_seed_finds_anything_much_cheaper() -> None:
    """Refined from the cheapest arrival alone, two of these twelve are dearer by 10 % and 0.6 %."""
    robot = seven_joints()
    targets = reachable_targets(robot, seed=5, count=12)
    planned = []
    for seed in (0, 1):
        options = Options(order="independent", seed=seed, include=("path",))
        plan = solve(Problem(robot, targets, options=options))
        planned.append([approach.effort for approach in plan.approaches])
    efforts = np.array(planned, dtype=np.float64)
    assert (efforts <= efforts.min(axis=0) * 1.001).all()
