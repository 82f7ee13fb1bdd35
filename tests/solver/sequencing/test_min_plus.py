"""The dynamic programme, against all chains written out."""

import numpy as np
import pytest

from solver.sequencing.min_plus import (
    chain_effort,
    cheapest_chain,
    costs_backward,
    costs_forward,
    relax,
)
from tests.solver.sequencing.synthetic import best, chains, cost, effort, layer, nodes

SIZES = (2, 3, 1, 2)


@pytest.mark.parametrize("squared", [False, True])
def test_relaxing_lowers_what_is_dearer(squared: bool) -> None:
    of = nodes(1, SIZES, squared=squared)
    before = np.random.default_rng(2).uniform(0.0, 12.0, 8)
    values = before.copy()
    relax(values, of.standby, 2, 0.5, of.thinning, 3, 7, squared)
    lowered = 0
    for m in range(8):
        reached = 0.5 + cost(of.thinning[:, m] - of.standby[:, 2], squared=squared)
        expected = min(before[m], reached) if 3 <= m < 7 else before[m]
        assert values[m] == pytest.approx(expected, rel=1e-14)
        lowered += values[m] < before[m]
    assert 0 < lowered < 4


@pytest.mark.parametrize("squared", [False, True])
def test_costs_and_chain_are_the_least_of_all(squared: bool) -> None:
    of = nodes(3, SIZES, squared=squared)
    forward, backward = np.empty(8), np.empty(8)
    costs_forward(of.start, of.thinning, of.standby, of.first, squared, forward)
    costs_backward(of.thinning, of.standby, of.first, squared, backward)
    every = list(chains(of, range(4)))
    for k in range(4):
        for node in layer(of, k):
            through = [chain for chain in every if chain[k] == node]
            least = min(effort(of, chain[: k + 1]) for chain in through)
            assert forward[node] == pytest.approx(least, rel=1e-13)
            rest = min(effort(of, chain) - effort(of, chain[: k + 1]) for chain in through)
            assert backward[node] == pytest.approx(rest, rel=1e-12, abs=1e-12)
    chain = cheapest_chain(of.start, of.thinning, of.standby, of.first, squared, backward)
    assert effort(of, chain.tolist()) == pytest.approx(best(of, range(4)), rel=1e-13)
    found = chain_effort(of.start, of.thinning, of.standby, chain, squared)
    assert found == pytest.approx(effort(of, chain.tolist()), rel=1e-14)


def test_of_equals_the_first_is_taken() -> None:
    of = nodes(4, (3, 2))
    same = of._replace(thinning=of.thinning[:, [0, 0, 0, 3, 3]], standby=of.standby[:, [0] * 5])
    backward = np.empty(5)
    costs_backward(same.thinning, same.standby, of.first, False, backward)
    chain = cheapest_chain(of.start, same.thinning, same.standby, of.first, False, backward)
    assert chain.tolist() == [0, 3]
