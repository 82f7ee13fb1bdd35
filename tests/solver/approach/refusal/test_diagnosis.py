"""Every refusal says what limits, by how much, and a nearest change that is true."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from solver import Options, Problem, Reason, Robot, Target, solve
from solver.approach.arcs.arcs import sample_angles, sample_task, task_arcs
from solver.approach.refusal.closest import Stage, closest_failure
from solver.approach.refusal.diagnosis import diagnose
from solver.approach.refusal.nearest_change import displaced
from solver.approach.refusal.tolerances import DIAGNOSED_ANGLES
from solver.approach.task.task import ApproachTask, approach_task
from tests.solver.problems import random_targets


def refused(
    robot: Robot, seed: int, count: int, **options: object
) -> Iterator[tuple[ApproachTask, Reason]]:
    """Random targets that no angle reaches, with the reason."""
    problem = Problem(
        robot,
        random_targets(seed, count),
        options=Options(method="ssas", **options),  # type: ignore[arg-type]
    )
    for target in problem.targets:
        task = approach_task(problem, target, problem.start)
        if not task_arcs(task):
            yield task, diagnose(task)


def assert_names_its_limit(reason: Reason) -> None:
    assert (reason.joint is None) == (reason.margin_rad is None)
    assert (reason.margin_rad is None) != (reason.margin_m is None)
    margin = reason.margin_m if reason.margin_rad is None else reason.margin_rad
    assert margin is not None
    assert margin < 0


@pytest.mark.parametrize("symmetric", [False, True])
def test_the_displaced_target_is_planned_there(tabletop: Robot, symmetric: bool) -> None:
    seen, counted = set(), 0
    for task, reason in refused(tabletop, 71, 40, symmetric_tool=symmetric):
        assert_names_its_limit(reason)
        nearest = reason.nearest
        assert nearest is not None
        assert (nearest.kind, nearest.verified) == ("displacement", True)
        moved = displaced(task, nearest.displacement_m)
        plan = solve(Problem(tabletop, [moved.target], options=task.options))
        assert plan.planned == 1, (task.target, nearest)
        angles = np.array([nearest.approach_angle_rad])
        failures = [closest_failure(moved.for_kernels(s), angles, False) for s in moved.tool_sides]
        assert max(failure[0] for failure in failures) == Stage.FEASIBLE
        seen.add(reason.code)
        counted += 1
    assert counted > 10
    assert seen >= {"out_of_reach", "joint_limit"}


def test_of_two_tool_sides_the_closer_one_is_told(tabletop: Robot) -> None:
    """Which is now the one, now the other."""
    told = set()
    for task, reason in refused(tabletop, 72, 120, symmetric_tool=True):
        angles = sample_angles(DIAGNOSED_ANGLES)
        stages = {
            side: closest_failure(task.for_kernels(side), angles, True)[:2]
            for side in task.tool_sides
        }
        closer = max(stages, key=lambda side: stages[side])
        if stages[1] == stages[-1]:
            continue
        margin = reason.margin_m if reason.margin_rad is None else reason.margin_rad
        assert margin == pytest.approx(stages[closer][1])
        told.add(closer)
    assert told == {1, -1}


def test_no_direction_leads_nearer(tabletop: Robot) -> None:
    """Displacements a little shorter than the one told, in many directions: none is feasible.

    Half of the directions are around the one told, where a nearer one would be likeliest.
    """
    rng = np.random.default_rng(72)
    compared = 0
    for task, reason in refused(tabletop, 73, 24):
        assert reason.nearest is not None
        told = np.asarray(reason.nearest.displacement_m)
        length = np.linalg.norm(told)
        directions = rng.normal(size=(60, 3))
        directions[30:] = told / length + 0.3 * directions[30:]
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        for direction in directions:
            shorter = 0.95 * length * direction
            moved = displaced(task, (float(shorter[0]), float(shorter[1]), float(shorter[2])))
            assert sample_task(moved, 1, 180)[1].max() < 0, (task.target, told, shorter)
        compared += 1
    assert compared >= 8


def test_a_far_target_is_told_the_way_into_reach(tabletop: Robot) -> None:
    target = Target("far", (0.0, 2.0, 0.1), (0, 0, 1))
    problem = Problem(tabletop, [target], options=Options(method="ssas"))
    task = approach_task(problem, target, problem.start)
    nearest = diagnose(task).nearest
    assert nearest is not None
    assert nearest.verified
    # Straight out the arm reaches a1 + sqrt((a2 + d4)^2 - (z - d1)^2) + the tool's length.
    outermost = 0.0135 + np.sqrt(0.28**2 - 0.014**2) + 0.104
    assert nearest.displacement_m[1] == pytest.approx(outermost - 2.0, abs=2e-3)
    assert nearest.displacement_m[0] == pytest.approx(0.0, abs=1e-2)


def test_an_uncertain_target_is_moved_to_where_it_bears_it(tabletop: Robot) -> None:
    moved_ones = 0
    for target in random_targets(seed=74, count=25):
        problem = Problem(
            tabletop,
            [replace(target, position_std_m=0.002)],
            options=Options(method="ssas", include=("path",)),
        )
        approach = solve(problem).approaches[0]
        if approach.reason is None or approach.reason.nearest is None:
            continue
        if approach.reason.nearest.verified:
            position = np.asarray(target.position_m) + approach.reason.nearest.displacement_m
            there = replace(problem.targets[0], position_m=tuple(position))
            assert solve(replace(problem, targets=(there,))).planned == 1
            moved_ones += 1
    assert moved_ones >= 5


def test_few_samples_that_all_fail_are_told_a_feasible_angle(tabletop: Robot) -> None:
    told = 0
    for target in random_targets(seed=75, count=40):
        problem = Problem(tabletop, [target], options=Options(method="floating_z", samples=3))
        approach = solve(problem).approaches[0]
        task = approach_task(problem, target, problem.start)
        arcs = task_arcs(task)
        if approach.reason is None or not arcs:
            continue
        assert_names_its_limit(approach.reason)
        nearest = approach.reason.nearest
        assert nearest is not None
        assert (nearest.kind, nearest.verified) == ("angle", True)
        assert nearest.displacement_m == (0.0, 0.0, 0.0)
        tried = -np.pi + 2 * np.pi * np.arange(3) / 3

        def away(angle: float, tried: np.ndarray = tried) -> float:
            return float(np.abs(np.remainder(tried - angle + np.pi, 2 * np.pi) - np.pi).min())

        inside = np.concatenate([np.linspace(a.lower_rad, a.upper_rad, 200) for a in arcs])
        assert away(nearest.approach_angle_rad) <= min(map(away, inside)) + 1e-5
        told += 1
    assert told >= 3


def test_a_broken_cut_in_names_its_joint(tabletop: Robot) -> None:
    """Single angles whose ends are feasible and whose cut-in is not, of a long cut-in.

    At the usual 4 cm one in forty thousand is; at 12 cm one in fifteen hundred, for joint 3 turns
    back where the wrist centre passes the shoulder.
    """
    rng = np.random.default_rng(76)
    options = Options(method="ssas", standoff_m=0.12)
    problem = Problem(tabletop, random_targets(77, 400), options=options)
    stages = set()
    for target in problem.targets:
        task = approach_task(problem, target, problem.start)
        for angle in rng.uniform(-np.pi, np.pi, 25):
            tried = np.array([angle])
            stage = closest_failure(task.for_kernels(1), tried, False)[0]
            if stage not in (4, 5, 6) or stage in stages:
                continue
            reason = diagnose(task, tried)
            assert reason.code == "cut_in_infeasible"
            assert_names_its_limit(reason)
            assert "before the target" in reason.detail
            assert reason.nearest is not None
            stages.add(stage)
    assert stages >= {5}
