"""Batches: the ladder graph, its refinement, the order chosen; against plain searches."""

import itertools

import numpy as np
import pytest

from bench.order_references import even_ladder_effort, greedy_effort
from solver import Options, Problem, Robot, Target
from solver.approach.arcs.of_problem import feasible_arcs
from solver.approach.task.packing import packed_problem
from solver.sequencing.batch import Batch
from solver.sequencing.gather import gather
from solver.sequencing.ladder_graph import refined_ladder
from solver.sequencing.ordering import coarse_nodes
from solver.sequencing.polish import polished
from solver.sequencing.sequence import least_chain, least_order, sequence
from tests.solver.problems import DATA_SET_3, random_targets


def batch_of(robot: Robot, targets: list[Target], **options: object) -> tuple[Batch, list[Target]]:
    """The batch of those targets that have an arc, and those targets."""
    problem = Problem(robot, targets, options=Options(**options))  # type: ignore[arg-type]
    found = feasible_arcs(problem)
    reached = [k for k, target in enumerate(targets) if found[target.id]]
    arcs = [found[targets[k].id] for k in reached]
    batch = gather(problem, packed_problem(problem)[:, reached], arcs)
    return batch, [targets[k] for k in reached]


def plain_ladder(batch: Batch, order: list[int], step: float) -> float:
    """The ladder of even angles written out with NumPy."""
    nodes = coarse_nodes(batch, step)
    reached, before = np.zeros(1), nodes.start
    for k in order:
        own = slice(nodes.first[k], nodes.first[k + 1])
        change = np.abs(nodes.thinning[:, None, own] - before[:, :, None])
        efforts = (change**2 if nodes.squared else change).sum(axis=0)
        reached, before = (reached[:, None] + efforts).min(axis=0), nodes.standby[:, own]
    return float(reached.min())


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_unrefined_ladder_is_the_cheapest_of_all_chains(tabletop: Robot, norm: str) -> None:
    batch, targets = batch_of(tabletop, random_targets(seed=61, count=12), norm=norm)
    order = np.arange(min(3, len(targets)))
    nodes = coarse_nodes(batch, 0.5)
    layers = [range(nodes.first[k], nodes.first[k + 1]) for k in order]
    best = np.inf
    for chain in itertools.product(*layers):
        before, total = nodes.start[:, 0], 0.0
        for n in chain:
            change = np.abs(nodes.thinning[:, n] - before)
            total += float((change**2 if nodes.squared else change).sum())
            before = nodes.standby[:, n]
        best = min(best, total)
    assert len(order) == 3
    _, _, effort = refined_ladder(batch, order, 0.5, 16, 0)
    assert effort == pytest.approx(best, rel=1e-12)


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
def test_every_round_and_the_polish_only_gain(tabletop: Robot, norm: str) -> None:
    batch, targets = batch_of(tabletop, random_targets(seed=65, count=60), norm=norm)
    order = np.arange(len(targets))
    efforts = []
    for rounds in range(4):
        arcs, angles, effort = refined_ladder(batch, order, 0.1, 8, rounds)
        efforts.append(effort)
    assert efforts == sorted(efforts, reverse=True)
    moved, gained = polished(batch, arcs, angles)
    assert gained < efforts[-1]
    assert np.all((batch.arc_lower[arcs] <= moved) & (moved <= batch.arc_upper[arcs]))


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
