"""Reference searches on the nodes of a ladder graph: every order of few targets, long for many."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import itertools
import math
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.reference import Ladder
from solver import Problem
from solver.compiled import kernel

Array = NDArray[np.float64]

HOT, COLD = 0.1, 0.004
"""Temperatures at the start and at the end, in efforts of a target on average."""

TRIALS = 20_000
"""Trials between two looks at the clock."""

NEAR = 12
"""Targets behind which a target is tried."""

TURNS, LONGEST_TURN = 0.2, 40
"""Share of trials that turn a run about, and its longest."""


def scaled_nodes(problem: Problem, ladder: Ladder) -> tuple[Array, Array, Array]:
    """Thinning and standby postures and the start, each joint times its weight."""
    weights = np.asarray(problem.joint_weights)
    return ladder.thinning * weights, ladder.standby * weights, np.asarray(problem.start) * weights


def efforts_of_orders(problem: Problem, ladder: Ladder) -> tuple[NDArray[np.int64], Array]:
    """Every order of a few targets, shape (n!, n), and its effort on the nodes, the best first."""
    count = len(ladder.layers) - 1
    orders = np.array(list(itertools.permutations(range(count))), dtype=np.int64)
    efforts = np.empty(len(orders))
    _efforts_of_orders(*scaled_nodes(problem, ladder), ladder.layers, orders, efforts)
    ranks = np.argsort(efforts, kind="stable")
    return orders[ranks], efforts[ranks]


def long_search(problem: Problem, ladder: Ladder, seconds: float, seed: int) -> list[int]:
    """An order by simulated annealing on the nodes, as good as it gets within a time."""
    thinning, standby, start = scaled_nodes(problem, ladder)
    layers = ladder.layers
    count = len(layers) - 1
    rng: Any = np.random.default_rng(seed)
    order = rng.permutation(count)
    nodes = layers[:-1].copy()
    cost = _cost(thinning, standby, start, order, nodes)
    best_cost, best = cost, order.copy()
    hot = HOT * cost / count
    near = _near(thinning, standby, layers, min(NEAR, count - 1))
    _anneal(thinning, standby, start, layers, near, order.copy(), nodes.copy(), 1.0, 1, 0)
    began = time.perf_counter()
    while (share := (time.perf_counter() - began) / seconds) < 1.0:
        temperature = hot * (COLD / HOT) ** share
        chance = int(rng.integers(2**31))
        cost = _anneal(
            thinning, standby, start, layers, near, order, nodes, temperature, TRIALS, chance
        )
        if cost < best_cost:
            best_cost, best = cost, order.copy()
    return [int(target) for target in best]


@kernel
def _between(a, b):
    total = 0.0
    for i in range(6):
        total += abs(a[i] - b[i])
    return total


@kernel
def _efforts_of_orders(thinning, standby, start, layers, orders, efforts):
    """Writes the least effort of every order, by the ladder graph's dynamic programme."""
    cost, before = np.empty(len(thinning)), -1
    for n in range(len(orders)):
        for p in range(orders.shape[1]):
            target = orders[n, p]
            for j in range(layers[target], layers[target + 1]):
                if p == 0:
                    cost[j] = _between(thinning[j], start)
                    continue
                least = np.inf
                for i in range(layers[before], layers[before + 1]):
                    least = min(least, cost[i] + _between(thinning[j], standby[i]))
                cost[j] = least
            before = target
        efforts[n] = cost[layers[before] : layers[before + 1]].min()


@kernel
def _edge(thinning, standby, start, nodes, before, after):
    """Effort from one target's standby, or the start (-1), to another's thinning posture."""
    if after < 0:
        return 0.0
    if before < 0:
        return _between(thinning[nodes[after]], start)
    return _between(thinning[nodes[after]], standby[nodes[before]])


@kernel
def _cost(thinning, standby, start, order, nodes):
    total, before = 0.0, -1
    for target in order:
        total += _edge(thinning, standby, start, nodes, before, target)
        before = target
    return total


@kernel
def _best_node(thinning, standby, start, layers, nodes, before, target, after):
    """The node of a target that is cheapest between two others."""
    least, best = np.inf, nodes[target]
    for n in range(layers[target], layers[target + 1]):
        cost = _between(thinning[n], start if before < 0 else standby[nodes[before]])
        if after >= 0:
            cost += _between(thinning[nodes[after]], standby[n])
        if cost < least:
            least, best = cost, n
    return best


@kernel
def _near(thinning, standby, layers, most):
    """For each target those from which it is reached most cheaply, shape (targets, most)."""
    count = len(layers) - 1
    near = np.empty((count, most), dtype=np.int64)
    for k in range(count):
        least = np.full(count, np.inf)
        for h in range(count):
            if h == k:
                continue
            for i in range(layers[h], layers[h + 1]):
                for j in range(layers[k], layers[k + 1]):
                    least[h] = min(least[h], _between(thinning[j], standby[i]))
        near[k] = np.argsort(least)[:most]
    return near


@kernel
def _window(thinning, standby, start, order, nodes, first, last):
    """Effort of the edges into the places first to last, as far as there are such places."""
    total = 0.0
    for p in range(max(first, 0), min(last + 1, len(order))):
        before = order[p - 1] if p else -1
        total += _edge(thinning, standby, start, nodes, before, order[p])
    return total


@kernel
def _anneal(thinning, standby, start, layers, near, order, nodes, temperature, trials, seed):
    """Trials at one temperature, in place: a target behind a near one, or a run turned about.

    The moved target, or the ends of the turned run, take the node that suits their new neighbours.
    Returns the effort.
    """
    np.random.seed(seed)
    n = len(order)
    tried, tried_nodes, place = order.copy(), nodes.copy(), np.argsort(order)
    for _ in range(trials):
        a = np.random.randint(n)
        c = place[near[order[a], np.random.randint(near.shape[1])]]
        b = c if a < c else c + 1
        if a == b:
            continue
        low, high = min(a, b), max(a, b)
        turn = high - low < LONGEST_TURN and np.random.random() < TURNS
        if turn:
            for p in range(low, high + 1):
                tried[p] = order[low + high - p]
        elif a < b:
            tried[a:b] = order[a + 1 : b + 1]
            tried[b] = order[a]
        else:
            tried[b + 1 : a + 1] = order[b:a]
            tried[b] = order[a]
        for p in (low, high, b):
            before, after = tried[p - 1] if p else -1, tried[p + 1] if p + 1 < n else -1
            tried_nodes[tried[p]] = _best_node(
                thinning, standby, start, layers, tried_nodes, before, tried[p], after
            )
        # A moved target leaves the edges in the middle as they are, one place further.
        old_gap, new_gap = (low + 3, low + 2) if a < b else (low + 2, low + 3)
        length = 0 if turn else max(high - low - 3, 0)
        gain = _window(thinning, standby, start, order, nodes, low, old_gap - 1)
        gain += _window(thinning, standby, start, order, nodes, old_gap + length, high + 1)
        gain -= _window(thinning, standby, start, tried, tried_nodes, low, new_gap - 1)
        gain -= _window(thinning, standby, start, tried, tried_nodes, new_gap + length, high + 1)
        if gain >= 0.0 or np.random.random() < math.exp(gain / temperature):
            for p in range(low, high + 1):
                order[p] = tried[p]
                place[order[p]] = p
            for p in (low, high, b):
                nodes[order[p]] = tried_nodes[order[p]]
        else:
            for p in (low, high, b):
                tried_nodes[tried[p]] = nodes[tried[p]]
            tried[low : high + 1] = order[low : high + 1]
    return _cost(thinning, standby, start, order, nodes)
