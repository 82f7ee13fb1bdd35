"""Batches: the ladder graph, its refinement, the order chosen; against plain searches."""

import itertools

import numpy as np
import pytest

from bench.order_references import even_ladder_effort, greedy_effort
from solver import Options, Problem, Robot, Target
from solver.sequencing.sequence import least_chain, least_order, sequence
from tests.solver.problems import DATA_SET_3, random_targets
from tests.solver.sequencing.batches import batch_of, plain_ladder


@pytest.mark.parametrize("norm", ["l1", "l2"])
@pytest.mark.parametrize("symmetric_tool", [False, True])
def test_no_dearer_than_a_ladder_of_1440_angles(
    tabletop: Robot, norm: str, symmetric_tool: bool
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
def test_given_is_never_dearer_than_greedy(tabletop: Robot, norm: str) -> None:
    gains = []
    for seed in (66, 67, 68):
        batch, targets = batch_of(tabletop, random_targets(seed, 40), norm=norm)
        given = least_chain(batch, np.arange(len(targets))).effort
        greedy = greedy_effort(Problem(tabletop, targets, options=Options(norm=norm)))
        assert given <= greedy * (1 + 1e-9)
        gains.append(given / greedy)
    assert min(gains) < 0.95


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_few_targets_are_ordered_as_by_exhaustive_search(tabletop: Robot, norm: str) -> None:
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
