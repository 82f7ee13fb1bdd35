"""More room is never dearer: on the ladder, against no room at all, and nearly always elsewhere."""

import math

import numpy as np
import pytest

from solver import Options, Problem, Robot, Target, solve
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.task import ApproachTask, approach_task
from solver.methods.relaxed.search import Offers, relaxed_offers
from solver.methods.relaxed.tolerances import RUNG_STRIKE_M, RUNG_TILT_RAD
from tests.solver.problems import random_targets

STRETCHED = Target("a", (-0.1337, 0.0002, 0.391), (-0.135, -1.437, 0.288))
HIGH = Target("b", (-0.0498, -0.0188, 0.4114), (-0.654, 0.159, -0.576))


def offers_of(
    robot: Robot, target: Target, strike_m: float, tilt_rad: float, **options: object
) -> tuple[ApproachTask, Offers]:
    chosen = Options(
        strike_zone_m=strike_m,
        tilt_tolerance_rad=tilt_rad,
        **{"position_margin_m": 0.0, **options},  # type: ignore[arg-type]
    )
    problem = Problem(robot, [target], options=chosen)
    task = approach_task(problem, target, problem.start)
    return task, relaxed_offers(task)


def least(offers: Offers) -> float:
    return offers.points[0].effort if offers.points else math.inf


@pytest.mark.parametrize(
    ("target", "zones", "known"),
    [
        (HIGH, [(0.0, 0.5), (0.01, 0.5), (0.03, 0.5), (0.04, 0.5)], [4.5196, 4.2716]),
        (STRETCHED, [(0.01, 0.1745), (0.01, 0.22), (0.01, 0.5)], [2.4011]),
        (STRETCHED, [(0.01, 0.1745), (0.01, 0.22), (0.02, 0.3)], [2.4011]),
    ],
)
def test_efforts_fall_with_room(
    tabletop: Robot, target: Target, zones: list[tuple[float, float]], known: list[float]
) -> None:
    """They rose to 4.5224, 2.5757 and 2.9973, and the last one was no approach at all."""
    efforts = []
    for strike_m, tilt_rad in zones:
        options = Options(
            order="independent",
            strike_zone_m=strike_m,
            tilt_tolerance_rad=tilt_rad,
            position_margin_m=0.0,
        )
        (approach,) = solve(Problem(tabletop, [target], options=options)).approaches
        assert approach.effort is not None, approach.reason
        efforts.append(approach.effort)
    assert efforts == sorted(efforts, reverse=True)
    for effort, earlier in zip(efforts, known, strict=False):
        assert effort <= earlier * 1.003


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_never_dearer_on_the_ladder(tabletop: Robot, norm: str) -> None:
    cheaper = 0
    for target in random_targets(seed=81, count=25):
        efforts = {}
        for i, strike_m in enumerate((0.0, RUNG_STRIKE_M, 0.03)):
            for j, tilt_rad in enumerate((0.0, RUNG_TILT_RAD, 2 * RUNG_TILT_RAD)):
                task, offers = offers_of(tabletop, target, strike_m, tilt_rad, norm=norm)
                efforts[i, j] = least(offers)
                smaller = min(efforts.get((i - 1, j), math.inf), efforts.get((i, j - 1), math.inf))
                assert efforts[i, j] <= smaller
                if i == j == 0:
                    plain = best_on_arcs(task)
                    effort = math.inf if plain is None else plain.effort
                    assert efforts[0, 0] == pytest.approx(effort, rel=1e-12)
        cheaper += efforts[2, 2] < efforts[0, 0]
    assert cheaper >= 8


def test_all_but_never_dearer_elsewhere(tabletop: Robot) -> None:
    rng = np.random.default_rng(82)
    planned = dearer = 0
    for target in random_targets(seed=83, count=120):
        strike_m, tilt_rad = rng.uniform(0.002, 0.03), rng.uniform(0.02, 0.35)
        shares = np.maximum(rng.uniform(size=2), rng.integers(2, size=2))
        _, smaller = offers_of(tabletop, target, strike_m * shares[0], tilt_rad * shares[1])
        _, larger = offers_of(tabletop, target, strike_m, tilt_rad)
        planned += math.isfinite(least(smaller))
        dearer += least(larger) > least(smaller) * (1 + 1e-5)
        assert least(larger) <= least(smaller) * 1.01
    assert planned >= 30
    assert dearer == 0


def test_points_offered_are_inside_their_zone_and_different(tabletop: Robot) -> None:
    task, offers = offers_of(tabletop, HIGH, 0.02, 0.3, symmetric_tool=True)
    assert [point.effort for point in offers.points] == sorted(
        point.effort for point in offers.points
    )
    families = [(point.tool_side, point.branch) for point in offers.points]
    assert len(set(families)) == len(families) > 1
    for point in offers.points:
        assert 0.0 <= point.placement.strike_m <= task.options.strike_zone_m
        assert point.placement.tilt_rad <= task.options.tilt_tolerance_rad * (1 + 1e-12)


def test_uncertain_targets_bear_their_uncertainty_in_their_zone(tabletop: Robot) -> None:
    target = Target("a", (0.2, 0.1, 0.35), (0.2, 1.0, 0.1), position_std_m=0.001)
    options = Options(order="independent", strike_zone_m=0.01, tilt_tolerance_rad=0.1)
    (approach,) = solve(Problem(tabletop, [target], options=options)).approaches
    assert approach.status == "planned"
    assert approach.displacement_margin_m is not None
    assert approach.displacement_margin_m >= 0.003 - 1e-6


def test_more_room_never_bears_less(tabletop: Robot) -> None:
    """What a target may move counts before effort, as without relaxations."""
    raised = 0
    for target in random_targets(seed=83, count=40):
        _, plain = offers_of(tabletop, target, 0.0, 0.0, position_margin_m=0.002)
        _, relaxed = offers_of(tabletop, target, 0.02, 0.1, position_margin_m=0.002)
        if plain.points:
            assert relaxed.points[0].rank <= plain.points[0].rank
            raised += relaxed.points[0].level_m > plain.points[0].level_m
    assert raised >= 2
