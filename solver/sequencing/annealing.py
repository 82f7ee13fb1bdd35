"""Kernels: order and approaches of a batch changed together, by simulated annealing.

A move takes a short run of targets elsewhere, with approaches chosen anew for the run, or turns a
run about where it is, so that a target comes behind one from which it is cheap to reach. Where a
move was accepted, the approaches beside it are chosen anew by the exact dynamic programme of the
ladder graph.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.compiled import kernel
from solver.problem.effort import joint_cost
from solver.sequencing.min_plus import relax
from solver.sequencing.tolerances import (
    ANNEAL_COLD,
    ANNEAL_COOLED_TRIALS,
    ANNEAL_HOT,
    ANNEAL_LONGEST_RUN,
    ANNEAL_LONGEST_TURN,
    ANNEAL_TURN_SHARE,
    ANNEAL_WINDOW,
)


@kernel
def stage_effort(nodes, before, node):
    """Effort of the thinning posture of a node from the standby of another, or the start (-1)."""
    total = 0.0
    for i in range(6):
        other = nodes.start[i, 0] if before < 0 else nodes.standby_rows[before, i]
        total += joint_cost(nodes.thinning_rows[node, i] - other, nodes.squared)
    return total


@kernel
def total_effort(nodes, chosen):
    """Effort of a sequence of nodes."""
    total = 0.0
    for p in range(len(chosen)):
        total += stage_effort(nodes, chosen[p - 1] if p > 0 else -1, chosen[p])
    return total


@kernel
def _random(state):
    """The next number in [0, 1) of a generator (splitmix64) with its state in an array of one."""
    state[0] += np.uint64(0x9E3779B97F4A7C15)
    z = state[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return float(z >> np.uint64(11)) / 9007199254740992.0


@kernel
def _below(state, n):
    """A random whole number from 0 to n - 1."""
    return min(int(_random(state) * n), n - 1)


@kernel
def _choose_run(nodes, before, run, after, chosen, values):
    """Chooses the nodes of a run of targets between two nodes exactly; returns their effort.

    `before` is -1 for the start posture, `after` -1 where the sequence ends.
    """
    first = nodes.first
    for p in range(len(run)):
        begin, end = first[run[p]], first[run[p] + 1]
        values[begin:end] = math.inf
        if p > 0:
            k = run[p - 1]
            for i in range(first[k], first[k + 1]):
                relax(
                    values, nodes.standby, i, values[i], nodes.thinning, begin, end, nodes.squared
                )
        elif before < 0:
            relax(values, nodes.start, 0, 0.0, nodes.thinning, begin, end, nodes.squared)
        else:
            relax(values, nodes.standby, before, 0.0, nodes.thinning, begin, end, nodes.squared)
    effort = 0.0
    for p in range(len(run) - 1, -1, -1):
        best, best_cost = -1, math.inf
        for i in range(first[run[p]], first[run[p] + 1]):
            cost = values[i] + (stage_effort(nodes, i, after) if after >= 0 else 0.0)
            if cost < best_cost:
                best, best_cost = i, cost
        chosen[p] = after = best
        if p == len(run) - 1:
            effort = best_cost
    return effort


@kernel
def choose_between(nodes, order, chosen, low, high, values):
    """Chooses the nodes at places low to high anew, exactly, those around them staying."""
    before = chosen[low - 1] if low > 0 else -1
    after = chosen[high + 1] if high + 1 < len(order) else -1
    _choose_run(nodes, before, order[low : high + 1], after, chosen[low : high + 1], values)


@kernel
def _stages(nodes, chosen, low, high):
    """Effort of reaching the places low to high, as far as they are in the sequence."""
    total = 0.0
    for p in range(max(low, 0), min(high, len(chosen) - 1) + 1):
        total += stage_effort(nodes, chosen[p - 1] if p > 0 else -1, chosen[p])
    return total


@kernel
def anneal(nodes, order, chosen, neighbours, trials, seed):
    """A better order with its nodes; never a dearer one than was given.

    Args:
        nodes: the approaches to choose from, see `solver.sequencing.ordering.Nodes`.
        order: targets, shape (n,), two at least.
        chosen: their nodes, shape (n,).
        neighbours: targets from which each target is cheap to reach, shape (targets, m).
        trials: moves tried.
        seed: of the random numbers.

    Returns:
        Order, nodes and effort.
    """
    n = len(order)
    state = np.array([seed], dtype=np.uint64)
    values = np.empty(nodes.thinning.shape[1])
    order, chosen = order.copy(), chosen.copy()
    place = np.empty(n, dtype=np.int64)
    place[order] = np.arange(n)
    longest = max(ANNEAL_LONGEST_RUN, ANNEAL_LONGEST_TURN)
    run, run_chosen = np.empty(longest, dtype=np.int64), np.empty(longest, dtype=np.int64)
    cost = total_effort(nodes, chosen)
    best_order, best_chosen, best_cost = order.copy(), chosen.copy(), cost
    unit = cost / n
    heat = 0.0
    for trial in range(trials):
        if trial % ANNEAL_COOLED_TRIALS == 0:
            heat = unit * ANNEAL_HOT * (ANNEAL_COLD / ANNEAL_HOT) ** (trial / trials)
        begin, end, to, turn = _proposal(state, order, place, neighbours)
        if begin < 0:
            continue
        length = end - begin + 1
        for j in range(length):
            run[j] = order[end - j] if turn else order[begin + j]
            run_chosen[j] = chosen[end - j] if turn else chosen[begin + j]
        before = chosen[to - 1] if to > 0 else -1
        next_place = end + 1 if to == begin else to
        after = chosen[next_place] if next_place < n else -1
        old = _stages(nodes, chosen, begin, end + 1)
        tolerated = -heat * math.log(1.0 - _random(state))
        if to == begin:
            new = stage_effort(nodes, before, run_chosen[0])
            new += _stages(nodes, run_chosen[:length], 1, length - 1)
            new += stage_effort(nodes, run_chosen[length - 1], after) if after >= 0 else 0.0
        else:
            old += _stages(nodes, chosen, to, to)
            new = 0.0
            if end + 1 < n:
                new = stage_effort(nodes, chosen[begin - 1] if begin > 0 else -1, chosen[end + 1])
            if new > old + tolerated:
                continue
            new += _choose_run(nodes, before, run[:length], after, run_chosen[:length], values)
        if new > old + tolerated:
            continue
        at = begin if to == begin else (to if to < begin else to - length)
        gap = begin if to >= begin else begin + length
        cost += new - old
        first, last = _put(order, run[:length], begin, end, to)
        _put(chosen, run_chosen[:length], begin, end, to)
        for p in range(first, last + 1):
            place[order[p]] = p
        for middle in (at, at + length, gap):
            low, high = max(middle - ANNEAL_WINDOW, 0), min(middle + ANNEAL_WINDOW - 1, n - 1)
            if low <= high:
                cost -= _stages(nodes, chosen, low, high + 1)
                choose_between(nodes, order, chosen, low, high, values)
                cost += _stages(nodes, chosen, low, high + 1)
        if cost < best_cost:
            best_order[:], best_chosen[:], best_cost = order, chosen, cost
    return best_order, best_chosen, total_effort(nodes, best_chosen)


@kernel
def _put(sequence, run, begin, end, to):
    """Moves places begin to end in front of place `to`, as `run`; returns the places touched."""
    length = end - begin + 1
    if to == begin:
        sequence[begin : end + 1] = run
        return begin, end
    if to > end:
        for p in range(begin, to - length):
            sequence[p] = sequence[p + length]
        sequence[to - length : to] = run
        return begin, to - 1
    for p in range(end, to + length - 1, -1):
        sequence[p] = sequence[p - length]
    sequence[to : to + length] = run
    return to, end


@kernel
def _proposal(state, order, place, neighbours):
    """A random move: first and last place of a run, where to, and whether it turns about.

    Either way a target comes behind one from which it is cheap to reach. A begin of -1 means none.
    """
    n = len(order)
    if _random(state) < ANNEAL_TURN_SHARE:
        end = _below(state, n)
        near = neighbours[order[end], _below(state, neighbours.shape[1])]
        begin = place[near] + 1
        if not 2 <= end - begin + 1 <= ANNEAL_LONGEST_TURN:
            return -1, -1, -1, False
        return begin, end, begin, True
    length = 1 + _below(state, min(ANNEAL_LONGEST_RUN, n - 1))
    begin = _below(state, n - length + 1)
    end = begin + length - 1
    turn = length > 1 and _random(state) < 0.5
    head = order[end] if turn else order[begin]
    to = place[neighbours[head, _below(state, neighbours.shape[1])]] + 1
    if _random(state) < 1.0 / n:
        to = 0
    if begin <= to <= end + 1:
        return -1, -1, -1, False
    return begin, end, to, turn
