"""Batches with relaxations, in a given order: never dearer than without them."""

import math

import pytest

from solver import Options, Problem, Robot, Target, solve, verify_plan
from tests.solver.problems import data_set_3, random_targets

SMALL = {"strike_zone_m": 0.01, "tilt_tolerance_rad": math.radians(5)}
CHEAP = {"position_margin_m": 0.0}


def reachable(robot: Robot, seed: int, count: int) -> list[Target]:
    targets = random_targets(seed=seed, count=12 * count)
    options = Options(method="ssas", order="independent")
    plan = solve(Problem(robot, targets, options=options))
    planned = {a.target_id for a in plan.approaches if a.status == "planned"}
    found = [target for target in targets if target.id in planned][:count]
    assert len(found) == count
    return found


@pytest.mark.parametrize(
    "relaxed",
    [SMALL, {"strike_zone_m": 0.04}, {"tilt_tolerance_rad": 0.3, "norm": "l2"}],
    ids=["both", "strike", "tilt l2"],
)
def test_never_dearer_than_plain(tabletop: Robot, relaxed: dict[str, object]) -> None:
    """A greedy chain was, in 93 of 100 batches of six, by up to 31 per cent."""
    gained = 0
    for seed in range(91, 95):
        targets = reachable(tabletop, seed, 6)
        norm = relaxed.get("norm", "l1")
        without = Options(norm=norm, **CHEAP)  # type: ignore[arg-type]
        plain = solve(Problem(tabletop, targets, options=without))
        options = Options(**relaxed, **CHEAP)  # type: ignore[arg-type]
        plan = solve(Problem(tabletop, targets, options=options))
        assert plain.planned == plan.planned == 6
        assert plan.total_effort <= plain.total_effort * (1 + 1e-9)
        gained += plan.total_effort < 0.99 * plain.total_effort
        assert all(verified.accepted for verified in verify_plan(plan).values())
    assert gained >= 3


def test_data_set_3_with_a_strike_zone(tabletop: Robot) -> None:
    """10.917 was answered, against 10.833 without."""
    options = {"strike_zone_m": 0.04, "symmetric_tool": True, **CHEAP}
    problem = data_set_3(tabletop, **options)
    uncertain = [
        Target(t.id, t.position_m, t.branch_direction, position_std_m=0.001)
        for t in problem.targets
    ]
    plan = solve(Problem(tabletop, uncertain, options=problem.options))
    without = Options(symmetric_tool=True, **CHEAP)  # type: ignore[arg-type]
    plain = solve(Problem(tabletop, uncertain, options=without))
    assert plan.planned == plain.planned == 5
    assert plan.total_effort <= plain.total_effort * (1 + 1e-9)


def test_a_target_that_only_a_relaxation_rescues_is_planned_in_its_place(tabletop: Robot) -> None:
    targets = random_targets(seed=3, count=30)
    plain = solve(Problem(tabletop, targets, options=Options()))
    plan = solve(Problem(tabletop, targets, options=Options(**SMALL)))  # type: ignore[arg-type]
    planned = {a.target_id for a in plan.approaches if a.status == "planned"}
    before = {a.target_id for a in plain.approaches if a.status == "planned"}
    assert before < planned
    assert [a.target_id for a in plan.approaches] == [target.id for target in targets]
    assert all(verified.accepted for verified in verify_plan(plan).values())
