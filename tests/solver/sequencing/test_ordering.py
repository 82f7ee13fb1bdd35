"""Which orders are worth refining, and what the search is given."""

import itertools
from typing import Any

import numpy as np
import pytest

from solver.sequencing import ordering
from solver.sequencing.distances import nearest_next, target_distances
from solver.sequencing.ordering import coarse_nodes, orders_worth_refining, searched_order
from solver.sequencing.tolerances import EXACT_ORDERS_KEPT, EXACT_STEP_RAD
from tests.solver.sequencing.synthetic import batch, best, nodes


def test_few_targets_have_their_cheapest_orders() -> None:
    of = batch(count=3)
    found = [tuple(order.tolist()) for order in orders_worth_refining(of, seed=0)]
    coarse = coarse_nodes(of, EXACT_STEP_RAD)
    every = sorted(itertools.permutations(range(3)), key=lambda order: best(coarse, order))
    assert found == every[:EXACT_ORDERS_KEPT]
    assert [order.tolist() for order in orders_worth_refining(batch(count=1), 0)] == [[0]]


def test_nodes_are_scaled_postures_of_every_arc() -> None:
    of = coarse_nodes(batch(count=2), 0.06)
    assert of.first.tolist() == [0, 6, 12]
    assert np.array_equal(of.thinning_rows, of.thinning.T)
    assert np.array_equal(of.standby_rows, of.standby.T)
    assert of.start.shape == (6, 1)
    assert not of.squared
    assert coarse_nodes(batch("l2"), 0.06).squared


def test_a_search_begins_at_the_nearest_and_looks_at_neighbours(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    of = nodes(14, (2, 1, 2, 1, 2, 1))
    given: dict[str, Any] = {}

    def anneal(nodes: Any, order: Any, chosen: Any, neighbours: Any, trials: int, seed: int) -> Any:
        given.update(order=order, chosen=chosen, neighbours=neighbours, trials=trials, seed=seed)
        return order[::-1], chosen, 0.0

    monkeypatch.setattr(ordering, "anneal", anneal)
    monkeypatch.setattr(ordering, "ANNEAL_NEIGHBOURS", 3)
    distances = target_distances(of)
    found = searched_order(of, 6, seed=7, trials_a_target=11)
    assert given["order"].tolist() == nearest_next(distances).tolist()
    assert found.tolist() == given["order"][::-1].tolist()
    assert (given["trials"], given["seed"]) == (66, 7)
    for target in range(6):
        near = sorted((k for k in range(6) if k != target), key=lambda k: distances[k, target])
        assert given["neighbours"][target].tolist() == near[:3]
    for target, node in zip(given["order"], given["chosen"], strict=True):
        assert of.first[target] <= node < of.first[target + 1]
    monkeypatch.setattr(ordering, "ANNEAL_NEIGHBOURS", 30)
    searched_order(of, 6, seed=7)
    assert given["neighbours"].shape == (6, 5)
