"""Targets that should be free to move: the level, least effort at it, and what it costs."""

from dataclasses import replace

import numpy as np
import pytest

from solver import InvalidProblem, Options, Problem, Robot, Target, solve, verify, verify_plan
from solver.approach.arcs.arcs import task_arcs
from solver.approach.task.task import ApproachTask, approach_task
from solver.approach.tolerances import UNCERTAINTY_DEVIATIONS
from solver.approach.uncertainty.levels import level_borne, margin_levels
from solver.approach.uncertainty.robustness import approach_margin
from solver.methods.registry import METHODS
from solver.problem.effort import posture_effort
from tests.solver.kinematics.arms import ur5
from tests.solver.problems import random_targets, targets_for

MARGIN_M = 0.001


def problem_of(robot: Robot, seed: int, count: int, **options: object) -> Problem:
    chosen = {"method": "ssas", "order": "independent", "include": ("path",)} | options
    targets = targets_for(str(chosen["method"]), seed, count)
    return Problem(robot, targets, options=Options(**chosen))  # type: ignore[arg-type]


def swept(task: ApproachTask, angles: int) -> list[tuple[float, float]]:
    """Displacement margin and effort at even angles of every feasible arc."""
    found = []
    for arc in task_arcs(task):
        for angle in np.linspace(arc.lower_rad, arc.upper_rad, angles):
            margin = approach_margin(task, float(angle), arc.tool_side, arc.branch)
            posture = task.thinning_joints(float(angle), arc.tool_side, arc.branch)
            options = task.options
            cost = posture_effort(posture, task.reference, task.joint_weights, options.norm)
            found.append((margin, cost))
    return found


def test_levels_are_the_option_its_parts_and_what_the_target_needs() -> None:
    target = Target("t", (0.2, 0.0, 0.3), (0, 1, 0))
    options = Options(position_margin_m=0.004)
    assert margin_levels(options, target) == (0.004, 0.002, 0.001, 0.0005, 0.0)
    vague = replace(target, position_std_m=0.0005)
    assert margin_levels(options, vague) == (0.004, 0.002, 0.0015)
    vaguer = replace(target, position_std_m=0.002)
    assert margin_levels(options, vaguer) == (0.006,)
    assert margin_levels(Options(position_margin_m=0.0), target) == (0.0,)
    assert level_borne((0.004, 0.002, 0.0), 0.003) == 0.002
    assert level_borne((0.006,), 0.003) is None


@pytest.mark.parametrize("changes", [{}, {"norm": "l2"}, {"symmetric_tool": True}])
def test_no_sampled_approach_bears_more_or_is_cheaper(
    tabletop: Robot, changes: dict[str, object]
) -> None:
    problem = problem_of(tabletop, 131, 30, position_margin_m=MARGIN_M, **changes)
    short, compared = 0, 0
    for target, approach in zip(problem.targets, solve(problem).approaches, strict=True):
        if approach.status != "planned":
            continue
        task = approach_task(problem, target, problem.start)
        levels, samples = margin_levels(problem.options, target), swept(task, 60)
        assert approach.position_margin_m is not None
        assert approach.displacement_margin_m is not None
        assert approach.effort is not None
        assert approach.displacement_margin_m >= approach.position_margin_m - 1e-6
        most = max((margin for margin, _ in samples), default=0.0)
        best = level_borne(levels, most)
        assert best is not None
        assert approach.position_margin_m >= best
        costs = [cost for margin, cost in samples if margin >= approach.position_margin_m + 1e-6]
        assert approach.effort <= min(costs, default=np.inf) + 1e-6
        assert (approach.margin_short or False) == (approach.position_margin_m < MARGIN_M)
        short += approach.margin_short or False
        compared += 1
    assert compared >= 8
    assert short < compared / 2


@pytest.mark.parametrize("order", ["independent", "given"])
@pytest.mark.parametrize("method", METHODS)
def test_every_method_plans_as_many_as_without(tabletop: Robot, method: str, order: str) -> None:
    exact = problem_of(tabletop, 132, 30, method=method, order=order, position_margin_m=0.0)
    free = replace(exact, options=replace(exact.options, position_margin_m=MARGIN_M))
    before, after = solve(exact), solve(free)
    assert before.planned == after.planned > 5
    assert all(verdict.accepted for verdict in verify_plan(after).values())
    levels, moved = [], 0
    for one, two in zip(before.approaches, after.approaches, strict=True):
        assert one.position_margin_m is None
        if two.status != "planned":
            continue
        assert two.position_margin_m is not None
        assert two.displacement_margin_m is not None
        levels.append(two.position_margin_m)
        if order == "independent" and (one.displacement_margin_m or 0.0) >= MARGIN_M:
            assert two.effort == pytest.approx(one.effort, rel=1e-9) or method == "as"
        moved += two.approach_angle_rad != one.approach_angle_rad
    assert np.mean(np.array(levels) == MARGIN_M) > 0.7 or method == "fixed_z"


def test_a_batch_is_what_its_targets_are_alone(tabletop: Robot) -> None:
    problem = problem_of(tabletop, 133, 60, position_margin_m=MARGIN_M)
    timed = replace(problem, options=replace(problem.options, include=None))
    compared = 0
    for one, two in zip(solve(problem).approaches, solve(timed).approaches, strict=True):
        assert one.status == two.status
        if one.status == "planned":
            assert one.effort == pytest.approx(two.effort, rel=1e-6)
            assert one.position_margin_m == two.position_margin_m
            compared += 1
    assert compared > 15


def test_an_uncertain_target_never_bears_less_than_it_needs(tabletop: Robot) -> None:
    targets = [replace(one, position_std_m=0.0005) for one in random_targets(134, 40)]
    options = Options(
        method="ssas", order="independent", include=("path",), position_margin_m=0.004
    )
    plan = solve(Problem(tabletop, targets, options=options))
    hard = solve(Problem(tabletop, targets, options=replace(options, position_margin_m=0.0)))
    assert plan.planned == hard.planned > 5
    for approach in plan.approaches:
        if approach.status == "planned":
            assert approach.position_margin_m in (0.004, 0.002, 0.0015)
            assert (approach.displacement_margin_m or 0.0) >= UNCERTAINTY_DEVIATIONS * 0.0005 - 1e-6


def test_levels_that_are_not_true_are_refused(tabletop: Robot) -> None:
    problem = problem_of(tabletop, 135, 20, position_margin_m=MARGIN_M)
    approach = next(one for one in solve(problem).approaches if one.status == "planned")
    assert verify(problem, approach, problem.start).accepted
    for wrong in (
        {"position_margin_m": None},
        {"position_margin_m": 0.0007},
        {"position_margin_m": 0.0005},
        {"margin_short": True},
        {"displacement_margin_m": 0.5 * MARGIN_M},
    ):
        spoiled = replace(approach, **wrong)
        assert not verify(problem, spoiled, problem.start).accepted
    exact = replace(problem, options=replace(problem.options, position_margin_m=0.0))
    assert not verify(exact, approach, problem.start).accepted


def test_arms_without_a_closed_form_have_no_margin() -> None:
    target = Target("t", (0.4, 0.1, 0.4), (0, 1, 0))
    assert Problem(ur5(), [target]).options.position_margin_m == 0.0
    Problem(ur5(), [target], options=Options(position_margin_m=0.0))
    with pytest.raises(InvalidProblem) as caught:
        Problem(ur5(), [target], options=Options(position_margin_m=MARGIN_M))
    assert [fault.path for fault in caught.value.faults] == [("options", "position_margin_m")]
