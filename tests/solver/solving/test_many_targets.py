from dataclasses import replace

import numpy as np
import pytest

from solver import Options, Problem, Robot, Target, load_robot, solve, verify
from solver.approach.optimum.batch import closed_form_optima
from solver.comparison.targets import as_targets, drawn_at_edges
from solver.problem.options import Norm
from solver.problem.solution import PLANNED
from solver.solving.many_targets import plan_many, plan_stops, plans_together
from solver.solving.one_target import plan_target
from solver.solving.staged import choose, next_reference
from tests.solver.problems import random_targets

SAME = 1e-9
SAME_AT_LEVEL = 1e-6


def edge_targets(robot: Robot, count: int) -> list[Target]:
    tool = robot.tool(robot.default_tool)
    assert tool is not None
    return list(as_targets(*drawn_at_edges(robot, tool, 0.005, 91, count), range(count)))


@pytest.mark.parametrize("norm", ["l1", "l2"])
@pytest.mark.parametrize("symmetric", [False, True])
@pytest.mark.parametrize("name", ["tabletop", "puma560"])
@pytest.mark.parametrize("margin_m", [0.0, 0.001])
def test_together_is_as_one_by_one(name: str, symmetric: bool, norm: Norm, margin_m: float) -> None:
    robot = load_robot(name)
    options = Options(
        method="ssas", order="independent", norm=norm, symmetric_tool=symmetric,
        include=("path",), position_margin_m=margin_m,
    )  # fmt: skip
    # Parts of arcs that bear a margin end within 1e-8 m of it.
    same = SAME if margin_m == 0.0 else SAME_AT_LEVEL
    targets = [*random_targets(seed=90, count=40)]
    targets += [
        Target(f"e{t.id}", t.position_m, t.branch_direction) for t in edge_targets(robot, 30)
    ]
    problem = Problem(robot, targets, options=options)
    assert plans_together(problem)
    together = plan_many(problem, problem.targets)
    planned = compared = 0
    for target in problem.targets:
        alone = plan_target(problem, target, problem.start)
        planned += alone.status == PLANNED
        found = together.get(target.id)
        if found is None:
            continue
        assert verify(problem, found, problem.start).accepted
        assert alone.status == PLANNED
        assert found.effort == pytest.approx(alone.effort, abs=same)
        assert found.position_margin_m == alone.position_margin_m
        # Where effort is flat the two may choose angles apart, of the same effort.
        angles = found.approach_angle_rad, alone.approach_angle_rad
        if (found.branch, found.tool_side, angles[0]) == pytest.approx(
            (alone.branch, alone.tool_side, angles[1]), abs=1e-8
        ):
            compared += 1
            assert found.path_deviation_m == pytest.approx(alone.path_deviation_m, abs=same)
            assert found.margin_rad == pytest.approx(alone.margin_rad, abs=1e-6)
            # Its search goes from row to row and may end at another one of nearly the same margin.
            room = pytest.approx(alone.displacement_margin_m, rel=1e-3, abs=1e-6)
            assert found.displacement_margin_m == room
            assert found.path_joints is not None
            assert alone.path_joints is not None
            assert np.abs(found.path_joints - alone.path_joints).max() < 1e-6
    # Those at the edges that leave between their rows are solved again, and stay in the batch.
    # Only one whose displacement margin the verifier refutes goes on alone, to claim less.
    assert planned > 20
    assert planned - len(together) <= 1
    assert compared > 0.7 * len(together)


def test_what_leaves_between_rows_is_solved_again_in_its_batch(tabletop: Robot) -> None:
    options = Options(method="ssas", order="independent", include=("path",), position_margin_m=0.0)
    problem = Problem(tabletop, random_targets(seed=97, count=400), options=options)
    positions = np.array([target.position_m for target in problem.targets])
    directions = np.array([target.branch_direction for target in problem.targets])
    optima = closed_form_optima(problem, positions, directions, np.asarray(problem.start))
    together = plan_many(problem, problem.targets)
    dearer = 0
    for k in np.flatnonzero(optima.suspicious & np.isfinite(optima.efforts)).tolist():
        target = problem.targets[k]
        alone = plan_target(problem, target, problem.start)
        assert (alone.status == PLANNED) == (target.id in together)
        if alone.status == PLANNED:
            found = together[target.id]
            assert verify(problem, found, problem.start).accepted
            assert found.effort == pytest.approx(alone.effort, abs=SAME)
            assert found.effort is not None
            dearer += found.effort > optima.efforts[k] + SAME
    assert dearer >= 3


@pytest.mark.parametrize(
    "changes",
    [
        {"method": "ncos"},
        {"include": ("path", "transfer")},
        {"include": ("path", "arcs")},
        {"certify": True},
    ],
)
def test_what_needs_more_goes_one_by_one(tabletop: Robot, changes: dict[str, object]) -> None:
    options = {"method": "ssas", "order": "independent", "include": ("path",), **changes}
    problem = Problem(tabletop, random_targets(seed=90, count=3), options=Options(**options))  # type: ignore[arg-type]
    assert not plans_together(problem)


@pytest.mark.parametrize("symmetric", [False, True])
def test_a_chain_together_is_as_one_by_one(tabletop: Robot, symmetric: bool) -> None:
    options = Options(method="ssas", symmetric_tool=symmetric, include=("path",))
    problem = Problem(tabletop, random_targets(seed=93, count=40), options=options)
    choice = choose(problem)
    stops = [choice.stops[id] for id in choice.order if id in choice.stops]
    together = plan_stops(problem, stops, problem.start)
    assert len(together) == len(stops) > 15
    reference = problem.start
    for stop in stops:
        alone = plan_target(problem, stop.task.target, reference, stop)
        found = together[stop.task.target.id]
        assert verify(problem, found, reference).accepted
        assert found.effort == pytest.approx(alone.effort, abs=SAME)
        assert (found.branch, found.tool_side) == (alone.branch, alone.tool_side)
        assert found.approach_angle_rad == alone.approach_angle_rad
        reference = next_reference(problem, (found,), reference)


def test_a_chain_ends_where_one_fails(tabletop: Robot) -> None:
    options = Options(method="ssas", include=("path",))
    problem = Problem(tabletop, random_targets(seed=93, count=40), options=options)
    choice = choose(problem)
    stops = [choice.stops[id] for id in choice.order if id in choice.stops]
    wrong = replace(stops[5], angle_rad=stops[5].angle_rad + 0.01)
    broken = [*stops[:5], wrong, *stops[6:]]
    assert list(plan_stops(problem, broken, problem.start)) == [
        stop.task.target.id for stop in stops[:5]
    ]


def test_rail_goes_one_by_one_and_uncertain_targets_stay(tabletop: Robot) -> None:
    options = Options(method="ssas", order="independent", include=("path",))
    rail = load_robot("puma560_rail")
    assert not plans_together(Problem(rail, random_targets(seed=90, count=3), options=options))
    uncertain = [
        Target(target.id, target.position_m, target.branch_direction, 0.001)
        for target in random_targets(seed=90, count=20)
    ]
    problem = Problem(tabletop, uncertain, options=options)
    together = plan_many(problem, uncertain)
    assert len(together) > 5
    for target in uncertain:
        alone = plan_target(problem, target, problem.start)
        if target.id in together:
            found = together[target.id]
            assert verify(problem, found, problem.start).accepted
            assert found.effort == pytest.approx(alone.effort, abs=SAME_AT_LEVEL)


def test_targets_that_bear_less_than_wished_for_stay_in_the_batch(tabletop: Robot) -> None:
    """Their optimum without a margin may bear the next level as it is."""
    targets = random_targets(seed=95, count=150)
    options = Options(method="ssas", order="independent", position_margin_m=0.02)
    plan = solve(Problem(tabletop, targets, options=options))
    short = {a.target_id for a in plan.approaches if a.margin_short}
    untimed = Problem(tabletop, targets, options=replace(options, include=("path",)))
    together = plan_many(untimed, untimed.targets)
    assert len(short) >= 20
    assert len(short - set(together)) <= 1
    for approach in plan.approaches:
        if approach.target_id in together:
            other = together[approach.target_id]
            assert other.position_margin_m == approach.position_margin_m
            assert other.effort == pytest.approx(approach.effort, rel=1e-6)
