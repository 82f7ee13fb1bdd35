"""How far a target may move: against the closed form, displaced in many directions."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from solver import Options, Problem, Robot, Target, load_robot, solve, verify_plan
from solver.approach.arcs.arcs import task_arcs
from solver.approach.task.task import ApproachTask, approach_task
from solver.approach.tolerances import UNCERTAINTY_DEVIATIONS
from solver.approach.uncertainty.displacement import displacement_margin
from solver.approach.uncertainty.robustness import needed_margin, path_displacement_margin
from solver.kinematics.spherical_wrist import inverse_kinematics
from solver.problem.options import MethodName
from solver.problem.solution import Arc
from solver.robots.model import Array
from tests.solver.kinematics.arms import arms
from tests.solver.problems import random_targets

ARMS = [load_robot("tabletop"), arms()[5], arms()[12]]


def approaches(robot: Robot, seed: int, count: int) -> Iterator[tuple[ApproachTask, Arc, float]]:
    """Tasks with an angle in each of their arcs: close to an end, and further inside."""
    problem = Problem(robot, random_targets(seed, count), options=Options(method="ssas"))
    for k, target in enumerate(problem.targets):
        task = approach_task(problem, target, problem.start)
        for arc in task_arcs(task):
            share = (0.02, 0.3, 0.6)[k % 3]
            yield task, arc, arc.lower_rad + share * (arc.upper_rad - arc.lower_rad)


def displaced_inside(
    task: ApproachTask, arc: Arc, angle: float, rows: Array, shifts: Array
) -> tuple[Array, Array]:
    """Smallest limit or reach margin of all rows, and smallest |sin q5|, at each shift (n, 3)."""
    axes = task.frame.axes(angle, arc.tool_side)
    retreats = np.asarray(task.retreats_m)
    poses = np.tile(np.eye(4), (len(shifts), len(retreats), 1, 1))
    poses[..., :3, :3] = axes
    places = np.asarray(task.target.position_m) - np.outer(retreats, axes[:, 2])
    poses[..., :3, 3] = places + shifts[:, None]
    found = inverse_kinematics(task.robot, task.tool, poses.reshape(-1, 4, 4))
    joints = found.joints[:, arc.branch].reshape(len(shifts), len(retreats), 6)
    joints = rows + np.remainder(joints - rows + np.pi, 2 * np.pi) - np.pi
    reach = found.reach_margin_m[:, arc.branch // 2].reshape(len(shifts), -1)
    inside = np.minimum(joints - task.lower, task.upper - joints).min(axis=(1, 2))
    sines = np.abs(np.sin(joints[..., 4] + task.robot.joints[4].offset_rad)).min(axis=1)
    return np.minimum(inside, reach.min(axis=1)), sines


def _directions(rng: np.random.Generator, count: int) -> Array:
    found = rng.normal(size=(count, 3))
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def _slopes(task: ApproachTask, arc: Arc, angle: float, rows: Array) -> Array:
    """Directions in which each joint of each row changes fastest, by differences, (n, 3)."""
    step = 1e-6
    axes = task.frame.axes(angle, arc.tool_side)
    poses = np.tile(np.eye(4), (3, 2, len(rows), 1, 1))
    poses[..., :3, :3] = axes
    poses[..., :3, 3] = np.asarray(task.target.position_m) - np.outer(task.retreats_m, axes[:, 2])
    for k in range(3):
        poses[k, 0, :, k, 3] += step
        poses[k, 1, :, k, 3] -= step
    found = inverse_kinematics(task.robot, task.tool, poses.reshape(-1, 4, 4))
    joints = found.joints[:, arc.branch].reshape(3, 2, len(rows), 6)
    change = np.remainder(joints[:, 0] - joints[:, 1] + np.pi, 2 * np.pi) - np.pi
    slopes = change.reshape(3, -1).T
    return np.asarray(slopes / np.maximum(np.linalg.norm(slopes, axis=1, keepdims=True), 1e-12))


@pytest.mark.parametrize("robot", ARMS, ids=lambda robot: robot.name)
def test_margin_is_kept_in_every_direction_and_not_beyond(robot: Robot) -> None:
    rng = np.random.default_rng(62)
    checked, straight = 0, 0
    for task, arc, angle in approaches(robot, seed=63, count=40):
        rows = np.empty((len(task.retreats_m), 6))
        margin, _, _ = displacement_margin(task.for_kernels(arc.tool_side), angle, arc.branch, rows)
        assert margin >= 0
        slopes = _slopes(task, arc, angle, rows)
        directions = np.concatenate((_directions(rng, 200), slopes, -slopes))
        inside, _ = displaced_inside(task, arc, angle, rows, 0.99 * margin * directions)
        assert inside.min() >= -1e-9, (task.target, angle, arc.branch)
        # Beyond it something breaks, or a wrist is straight: found by going on in the worst
        # directions.
        best, beyond = directions, np.inf
        for spread in (0.3, 0.1, 0.03, 0.01):
            inside, sines = displaced_inside(task, arc, angle, rows, 1.1 * margin * best)
            beyond = min(beyond, float(inside.min()))
            if beyond < 0 or sines.min() < 0.02:
                break
            worst = best[np.minimum(inside, sines).argsort()[:10]]
            best = (worst[:, None] + spread * rng.normal(size=(10, 60, 3))).reshape(-1, 3)
            best /= np.linalg.norm(best, axis=1, keepdims=True)
        assert beyond < 0 or sines.min() < 0.02, (task.target, angle, arc.branch)
        checked += 1
        straight += beyond >= 0
    assert checked >= 20
    assert straight <= checked / 10


def test_margin_of_a_path_is_that_of_its_approach(tabletop: Robot) -> None:
    compared = 0
    for task, arc, angle in approaches(tabletop, seed=64, count=15):
        rows = np.empty((len(task.retreats_m), 6))
        margin, _, _ = displacement_margin(task.for_kernels(arc.tool_side), angle, arc.branch, rows)
        again = path_displacement_margin(tabletop, task.tool, task.options, arc.branch, rows[-1])
        assert again == pytest.approx(margin, abs=1e-7)
        compared += 1
    assert compared > 15


def test_robust_arcs_are_where_the_margin_is_enough(tabletop: Robot) -> None:
    compared, narrower = 0, 0
    for task, arc, _ in approaches(tabletop, seed=65, count=12):
        uncertain = replace(task, target=replace(task.target, position_std_m=0.0015))
        needed = needed_margin(uncertain.target)
        robust = [
            part
            for part in task_arcs(uncertain)
            if (part.tool_side, part.branch) == (arc.tool_side, arc.branch)
        ]
        rows = np.empty((len(task.retreats_m), 6))
        for angle in np.linspace(arc.lower_rad, arc.upper_rad, 60):
            margin, _, _ = displacement_margin(
                task.for_kernels(arc.tool_side), angle, arc.branch, rows
            )
            inside = any(part.lower_rad <= angle <= part.upper_rad for part in robust)
            if abs(margin - needed) > 1e-7:
                assert inside == (margin > needed)
                compared += 1
                narrower += not inside
    assert narrower > 50
    assert compared - narrower > 50


@pytest.mark.parametrize("method", ["floating_z", "ssas", "ncos"])
def test_planned_answers_bear_their_uncertainty(tabletop: Robot, method: MethodName) -> None:
    targets = random_targets(seed=66, count=25)
    planned = []
    for std in (None, 0.0, 0.001, 0.004):
        uncertain = [replace(target, position_std_m=std) for target in targets]
        options = Options(method=method, order="independent", include=("path",))
        plan = solve(Problem(tabletop, uncertain, options=options))
        assert all(result.accepted for result in verify_plan(plan).values())
        for approach in plan.approaches:
            if approach.status == "planned":
                assert approach.displacement_margin_m is not None
                assert approach.displacement_margin_m >= UNCERTAINTY_DEVIATIONS * (std or 0) - 1e-6
            elif approach.reason is not None:
                assert approach.reason.code != "solver_failed", approach.reason
        planned.append(plan.planned)
    assert planned[0] == planned[1] >= planned[2] > planned[3] > 0


def test_only_the_uncertainty_in_the_way_is_said(tabletop: Robot) -> None:
    """A target planned when known exactly, and how uncertain it may be is true."""
    told = 0
    for target in random_targets(seed=67, count=30):
        options = Options(method="ssas", include=("path",))
        exact = solve(Problem(tabletop, [target], options=options)).approaches[0]
        vague = replace(target, position_std_m=0.006)
        approach = solve(Problem(tabletop, [vague], options=options)).approaches[0]
        if exact.status != "planned" or approach.status == "planned":
            continue
        reason = approach.reason
        assert reason is not None
        assert "feasible if the target is where it was seen" in reason.detail
        assert reason.margin_m is not None
        assert reason.margin_m < 0
        assert reason.joint is not None or "the reach" in reason.detail
        borne = (needed_margin(vague) + reason.margin_m) / UNCERTAINTY_DEVIATIONS
        better = replace(target, position_std_m=0.99 * borne)
        assert solve(Problem(tabletop, [better], options=options)).planned == 1
        told += 1
    assert told >= 3


def test_a_target_of_an_exact_position_needs_no_margin() -> None:
    assert needed_margin(Target("t", (0.2, 0.0, 0.3), (0, 1, 0))) == 0.0
