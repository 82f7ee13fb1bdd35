"""Where the slide of a rail stands, against a dense sweep of it."""

import math

import numpy as np
import pytest

from solver import Options, Problem, Target, solve, verify_plan
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.task import ApproachTask, approach_task
from solver.kinematics.families.on_rail import split_rail
from solver.kinematics.forward import forward_kinematics
from solver.methods.rail import at_rail, rail_effort, rail_positions
from solver.methods.slide import cheapest_position
from solver.problem.options import Norm
from tests.solver.methods.on_rail import ROBOT, TARGETS, task_of

# Its effort falls between two positions of the grid up to where an arc ends.
BESIDE_AN_END = Target(
    "beside an end",
    (-0.70516568138473, 0.8738588726852132, 0.24285874026961785),
    (-0.06829307727893304, -0.08603010404413526, -0.6207581522927077),
)


def reachable_targets(seed: int, count: int) -> list[Target]:
    """Where the tool is in random postures, with the branch across it."""
    drawn = np.random.default_rng(seed).uniform(ROBOT.lower, ROBOT.upper, (count, 7))
    poses = forward_kinematics(ROBOT, ROBOT.tools[0], drawn)
    return [
        Target(str(k), pose[:3, 3].tolist(), pose[:3, 1].tolist()) for k, pose in enumerate(poses)
    ]


def effort_at(task: ApproachTask, place: float) -> float:
    rail = split_rail(task.robot)
    assert rail is not None
    best = best_on_arcs(at_rail(task, rail, place))
    return math.inf if best is None else best.effort + rail_effort(task, place)


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_no_position_of_a_dense_sweep_is_cheaper(norm: Norm) -> None:
    targets = [BESIDE_AN_END, *reachable_targets(seed=7, count=5)]
    problem = Problem(
        ROBOT, targets, options=Options(norm=norm, order="independent", include=("path",))
    )
    plan = solve(problem)
    assert all(result.accepted for result in verify_plan(plan).values())
    for target, approach in zip(targets, plan.approaches, strict=True):
        task = approach_task(problem, target, problem.start)
        sweep = np.linspace(ROBOT.lower[0], ROBOT.upper[0], 61)
        near = approach.thinning_joints[0] if approach.thinning_joints is not None else 0.0
        beside = np.clip(near + np.linspace(-0.01, 0.01, 21), *sweep[[0, -1]])
        least = min(effort_at(task, float(place)) for place in (*sweep, *beside))
        if approach.effort is None:
            assert math.isinf(least)
            continue
        assert approach.effort <= least * (1 + 1e-5)


def test_the_slide_stands_at_a_minimum_that_the_grid_does_not_have() -> None:
    task = task_of(BESIDE_AN_END)
    rail = split_rail(task.robot)
    assert rail is not None
    found = cheapest_position(task, rail)
    assert found is not None
    place, _ = found
    effort = effort_at(task, place)
    assert effort < min(effort_at(task, float(other)) for other in rail_positions(task)) - 1e-4
    for step in (1e-6, 1e-4, 1e-3):
        assert effort <= min(effort_at(task, place - step), effort_at(task, place + step)) + 1e-9


def test_no_position_where_there_is_no_approach() -> None:
    task = task_of(TARGETS[2])
    rail = split_rail(task.robot)
    assert rail is not None
    assert cheapest_position(task, rail) is None
