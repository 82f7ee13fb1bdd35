"""The cheapest orders, against all orders and chains written out."""

import itertools

import numpy as np
import pytest

from solver.sequencing.exhaustive import cheapest_orders, remaining_costs
from tests.solver.sequencing.synthetic import best, chains, effort, layer, nodes

SIZES = (2, 1, 2, 1)


@pytest.mark.parametrize("squared", [False, True])
@pytest.mark.parametrize("most", [1, 5, 24])
def test_orders_come_cheapest_first(squared: bool, most: int) -> None:
    of = nodes(5, SIZES, squared=squared)
    every = {order: best(of, order) for order in itertools.permutations(range(4))}
    cheapest = sorted(every, key=lambda order: every[order])
    found = [tuple(order.tolist()) for order in cheapest_orders(of, most)]
    assert found == cheapest[:most]


def test_more_orders_than_there_are_come_once() -> None:
    of = nodes(6, (1, 2, 1))
    found = cheapest_orders(of, 10)
    assert {tuple(order.tolist()) for order in found} == set(itertools.permutations(range(3)))
    assert len(found) == 6


@pytest.mark.parametrize("squared", [False, True])
def test_what_remains_is_the_least_through_all_others(squared: bool) -> None:
    of = nodes(7, (2, 1, 2), squared=squared)
    rest = remaining_costs(of)
    assert rest.shape == (8, 5)
    for k in range(3):
        for node in layer(of, k):
            for others in itertools.chain.from_iterable(
                itertools.combinations({0, 1, 2} - {k}, count) for count in range(3)
            ):
                visited = sum(1 << j for j in range(3) if j not in others)
                least = min(
                    effort(of, (node, *chain)) - effort(of, (node,))
                    for order in itertools.permutations(others)
                    for chain in chains(of, order)
                )
                assert rest[visited, node] == pytest.approx(least, rel=1e-12, abs=1e-12)
    assert np.all(rest[7] == 0.0)
