"""Annealing: its pieces against lists and brute force, and that it never ends dearer."""

import itertools
from collections.abc import Iterator

import numpy as np
import pytest

from solver.sequencing.annealing import (
    _proposal,
    _put,
    _random,
    _stages,
    anneal,
    choose_between,
    stage_effort,
    total_effort,
)
from solver.sequencing.tolerances import ANNEAL_LONGEST_RUN, ANNEAL_LONGEST_TURN
from tests.solver.sequencing.synthetic import best, chains, effort, nodes, stage


@pytest.fixture(autouse=True)
def whole_numbers_run_over() -> Iterator[None]:
    """As those of the generator are meant to; interpreted, NumPy warns of it."""
    with np.errstate(over="ignore"):
        yield


def test_the_generator_is_splitmix64() -> None:
    """Against the first numbers of the published one from 0."""
    state = np.array([0], dtype=np.uint64)
    published = (0xE220A8397B1DCDAF, 0x6E789E6AA1B965F4, 0x06C45D188009454F)
    for number in published:
        assert _random(state) == (number >> 11) / 2**53


@pytest.mark.parametrize("squared", [False, True])
def test_efforts_are_sums_of_stages(squared: bool) -> None:
    of = nodes(9, (2, 2, 2, 1), squared=squared)
    chain = np.array([1, 2, 5, 6])
    assert total_effort(of, chain) == pytest.approx(effort(of, chain.tolist()), rel=1e-14)
    assert stage_effort(of, -1, 3) == pytest.approx(stage(of, -1, 3), rel=1e-14)
    assert stage_effort(of, 4, 3) == pytest.approx(stage(of, 4, 3), rel=1e-14)
    inner = stage(of, 1, 2) + stage(of, 2, 5)
    assert _stages(of, chain, 1, 2) == pytest.approx(inner, rel=1e-14)
    assert _stages(of, chain, -3, 9) == pytest.approx(effort(of, chain.tolist()), rel=1e-14)


@pytest.mark.parametrize("squared", [False, True])
@pytest.mark.parametrize(("low", "high"), [(0, 3), (0, 1), (1, 2), (2, 3), (2, 2)])
def test_nodes_between_others_are_chosen_exactly(squared: bool, low: int, high: int) -> None:
    of = nodes(10, (3, 2, 3, 2), squared=squared)
    order, chosen = np.array([2, 0, 3, 1]), np.array([5, 0, 8, 3])
    found = chosen.copy()
    choose_between(of, order, found, low, high, np.empty(10))
    least = min(
        effort(of, (*chosen[:low].tolist(), *inner, *chosen[high + 1 :].tolist()))
        for inner in chains(of, order[low : high + 1].tolist())
    )
    assert effort(of, found.tolist()) == pytest.approx(least, rel=1e-13)
    assert found[:low].tolist() == chosen[:low].tolist()
    assert found[high + 1 :].tolist() == chosen[high + 1 :].tolist()


@pytest.mark.parametrize(
    ("begin", "end", "to"),
    [(b, e, t) for b in range(6) for e in range(b, min(b + 3, 6)) for t in range(7)
     if t == b or t < b or t > e + 1],
)  # fmt: skip
def test_a_run_is_put_elsewhere_as_in_a_list(begin: int, end: int, to: int) -> None:
    sequence = np.arange(6)
    run = sequence[begin : end + 1][::-1].copy()
    left = [k for k in range(6) if not begin <= k <= end]
    place = begin if to == begin else sum(k < to for k in left)
    expected = [*left[:place], *run.tolist(), *left[place:]]
    first, last = _put(sequence, run, begin, end, to)
    assert sequence.tolist() == expected
    touched = [k for k in range(6) if expected[k] != k]
    assert all(first <= k <= last for k in touched)
    assert 0 <= first <= last <= 5


def test_moves_bring_a_target_behind_one_that_is_near() -> None:
    n = 9
    rng = np.random.default_rng(11)
    order = rng.permutation(n)
    place = np.argsort(order)
    neighbours = np.stack([rng.permutation([k for k in range(n) if k != t])[:3] for t in range(n)])
    state = np.array([5], dtype=np.uint64)
    kinds: set[object] = set()
    for _ in range(2000):
        begin, end, to, turn = _proposal(state, order, place, neighbours)
        if begin < 0:
            kinds.add("none")
            continue
        assert 0 <= begin <= end < n
        if to == begin:
            kinds.add("turned")
            assert turn
            assert 2 <= end - begin + 1 <= ANNEAL_LONGEST_TURN
            assert order[begin - 1] in neighbours[order[end]]
            continue
        kinds.add(("moved", bool(turn)))
        assert end - begin + 1 <= ANNEAL_LONGEST_RUN
        assert to < begin or to > end + 1
        head = order[end] if turn else order[begin]
        if to > 0:
            kinds.add("behind")
            assert order[to - 1] in neighbours[head]
        else:
            kinds.add("first")
    assert kinds == {"none", "turned", ("moved", False), ("moved", True), "behind", "first"}


@pytest.mark.parametrize("squared", [False, True])
@pytest.mark.parametrize("seed", [1, 2])
def test_it_finds_the_best_of_few_and_tells_its_effort(squared: bool, seed: int) -> None:
    of = nodes(12, (2, 1, 2, 1, 2), squared=squared)
    order = np.arange(5)
    chosen = of.first[order].copy()
    neighbours = np.stack([[k for k in range(5) if k != t] for t in range(5)])
    found, its_nodes, its_effort = anneal(of, order, chosen, neighbours, 400, seed)
    assert sorted(found.tolist()) == list(range(5))
    assert its_effort == pytest.approx(effort(of, its_nodes.tolist()), rel=1e-13)
    least = min(best(of, one) for one in itertools.permutations(range(5)))
    assert its_effort == pytest.approx(least, rel=1e-12)
    for target, node in zip(found.tolist(), its_nodes.tolist(), strict=True):
        assert of.first[target] <= node < of.first[target + 1]
    again, *_ = anneal(of, order, chosen, neighbours, 400, seed)
    assert again.tolist() == found.tolist()


def test_it_never_ends_dearer_than_it_began() -> None:
    of = nodes(13, (2,) * 6)
    neighbours = np.stack([[k for k in range(6) if k != t] for t in range(6)])
    for seed in range(6):
        order = np.random.default_rng(seed).permutation(6)
        chosen = of.first[order].copy()
        *_, found = anneal(of, order, chosen, neighbours, 10, seed)
        assert found <= effort(of, chosen.tolist()) + 1e-12
