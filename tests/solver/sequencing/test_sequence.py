"""Batches: the ladder graph, its refinement, the order chosen; against plain searches."""

import itertools

import numpy as np
import pytest

from bench.order_references import even_ladder_effort, greedy_effort
from solver import Options, Problem, Robot, Target
from solver.approach.cut_in.broken_between_rows import broken_between
from solver.approach.task.task import ApproachTask
from solver.problem.options import Norm
from solver.sequencing import sequence as module
from solver.sequencing.sequence import least_chain, least_order, sequence
from tests.solver.problems import DATA_SET_3, random_targets
from tests.solver.sequencing.batches import batch_of, plain_ladder


@pytest.mark.parametrize("norm", ["l1", "l2"])
@pytest.mark.parametrize("symmetric_tool", [False, True])
def test_no_dearer_than_a_ladder_of_1440_angles(
    tabletop: Robot, norm: Norm, symmetric_tool: bool
) -> None:
    for seed in (62, 63, 64):
        batch, targets = batch_of(
            tabletop, random_targets(seed, 60), norm=norm, symmetric_tool=symmetric_tool
        )
        order = list(range(len(targets)))
        assert len(order) >= 15
        fine = plain_ladder(batch, order, 2 * np.pi / 1440)
        assert least_chain(batch, np.array(order)).effort <= fine


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_given_is_never_dearer_than_greedy(tabletop: Robot, norm: Norm) -> None:
    gains = []
    for seed in (66, 67, 68):
        batch, targets = batch_of(tabletop, random_targets(seed, 40), norm=norm)
        given = least_chain(batch, np.arange(len(targets))).effort
        greedy = greedy_effort(Problem(tabletop, targets, options=Options(norm=norm)))
        assert given <= greedy * (1 + 1e-9)
        gains.append(given / greedy)
    assert min(gains) < 0.95


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_few_targets_are_ordered_as_by_exhaustive_search(tabletop: Robot, norm: Norm) -> None:
    for seed in (69, 70):
        _, reachable = batch_of(tabletop, random_targets(seed, 40), norm=norm)
        batch, targets = batch_of(tabletop, reachable[:5], norm=norm)
        orders = itertools.permutations(range(len(targets)))
        best = min(least_chain(batch, np.array(order)).effort for order in orders)
        found = least_order(batch, np.arange(len(targets)), seed=0)
        assert found.effort == pytest.approx(best, rel=1e-9)


def test_optimal_is_never_dearer_than_given_and_has_every_target(tabletop: Robot) -> None:
    batch, targets = batch_of(tabletop, random_targets(seed=71, count=60))
    order = np.arange(len(targets))
    found = least_order(batch, order, seed=0)
    assert len(targets) > 8
    assert sorted(found.order) == list(order)
    assert found.effort < 0.9 * least_chain(batch, order).effort


def test_sequence_leaves_out_what_has_no_arc_and_repeats_itself(tabletop: Robot) -> None:
    far = Target("far", (0.0, 2.0, 0.1), (0, 0, 1))
    mixed = (DATA_SET_3[0], far, *DATA_SET_3[1:])
    given = sequence(Problem(tabletop, mixed, options=Options(order="given")))
    assert [stop.task.target.id for stop in given] == ["1", "2", "3", "4", "5"]
    for stop in given:
        assert (stop.candidate.iterations, stop.candidate.status) == (0, "optimum_of_ladder")
        assert (stop.candidate.tool_side, stop.candidate.branch) == (1, stop.arc.branch)
        assert stop.arc.lower_rad <= stop.angle_rad <= stop.arc.upper_rad
    optimal = Problem(tabletop, mixed, options=Options(order="optimal"))
    found = sequence(optimal)
    assert found == sequence(optimal)
    backward = sequence(Problem(tabletop, mixed[::-1], options=Options(order="optimal")))
    ids = [stop.task.target.id for stop in found]
    assert sorted(ids) == ["1", "2", "3", "4", "5"]
    assert [stop.task.target.id for stop in backward] == ids
    total, total_given = (sum(s.candidate.effort for s in stops) for stops in (found, given))
    assert total <= total_given
    assert sequence(Problem(tabletop, [far])) == ()


def test_even_ladder_of_data_set_3_is_dearer_than_given(tabletop: Robot) -> None:
    problem = Problem(tabletop, DATA_SET_3)
    batch, targets = batch_of(tabletop, list(DATA_SET_3))
    given = least_chain(batch, np.arange(len(targets))).effort
    ladders, counts = zip(*(even_ladder_effort(problem, n) for n in (36, 72, 144)), strict=True)
    assert counts == (5, 5, 5)
    assert given < ladders[2] <= ladders[1] <= ladders[0] < 1.1 * given


def test_the_given_order_is_a_candidate_of_the_optimal(
    tabletop: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However bad the orders are that the search finds."""
    batch, targets = batch_of(tabletop, random_targets(seed=71, count=30))
    given = np.arange(len(targets))
    rng = np.random.default_rng(1)
    orders = [rng.permutation(given) for _ in range(6)]
    best, *_, worst = sorted(orders, key=lambda order: least_chain(batch, order).effort)
    assert least_chain(batch, best).effort < 0.99 * least_chain(batch, worst).effort
    monkeypatch.setattr(module, "orders_worth_refining", lambda batch, seed: [worst])
    assert least_order(batch, best, seed=0).effort == least_chain(batch, best).effort
    monkeypatch.setattr(module, "orders_worth_refining", lambda batch, seed: [best])
    assert least_order(batch, worst, seed=0).effort == least_chain(batch, best).effort


def test_rows_that_lie_unevenly_are_always_looked_at(
    tabletop: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The quick look between rows cannot judge those that were added to the even ones."""
    looked_at = []

    def look(task: ApproachTask, candidate: object) -> float | None:
        looked_at.append((task.target.id, len(task.retreats_m)))
        return broken_between(task, candidate)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "broken_between", look)
    problem = Problem(tabletop, random_targets(66, 300), Options(position_margin_m=0.0))
    stops = sequence(problem)
    regular = min(len(stop.task.retreats_m) for stop in stops)
    uneven = [stop for stop in stops if len(stop.task.retreats_m) > regular]
    assert uneven
    for stop in uneven:
        assert (stop.task.target.id, len(stop.task.retreats_m)) in looked_at
    assert len({target_id for target_id, _ in looked_at}) < len(stops) / 2
    assert all(broken_between(stop.task, stop.candidate) is None for stop in stops)
