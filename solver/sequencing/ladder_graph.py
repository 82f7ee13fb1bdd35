"""Kernels: a ladder graph over feasible arcs, refined from coarse to fine.

Each target is a layer, each angle on one of its arcs a node. Every arc is divided evenly, ends
included. In every round the dynamic programme gives the least effort of a chain through each node;
nodes whose through-cost is among the lowest of their target are kept, and halves are put beside
them. Divisions are nested, so no round's chain is dearer than the last one's.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.compiled import kernel
from solver.sequencing.batch import arc_postures
from solver.sequencing.min_plus import (
    chain_effort,
    cheapest_chain,
    costs_backward,
    costs_forward,
)


@kernel
def even_nodes(batch, order, step):
    """Nodes of the targets in an order, every arc divided into even pieces of `step` at most [rad].

    Returns layers, shape (targets + 1,), and of each node its arc, its place on the arc and the
    number of pieces of the arc. An arc without length has one node.
    """
    count = 0
    for k in order:
        for arc in range(batch.first_arc[k], batch.first_arc[k + 1]):
            count += _pieces(batch, arc, step) + 1
    arcs = np.empty(count, dtype=np.int64)
    places = np.empty(count, dtype=np.int64)
    pieces = np.empty(count, dtype=np.int64)
    layers = np.empty(len(order) + 1, dtype=np.int64)
    n = 0
    for position, k in enumerate(order):
        layers[position] = n
        for arc in range(batch.first_arc[k], batch.first_arc[k + 1]):
            number = _pieces(batch, arc, step)
            for place in range(number + 1):
                arcs[n], places[n], pieces[n] = arc, place, number
                n += 1
    layers[len(order)] = n
    return layers, arcs, places, pieces


@kernel
def _pieces(batch, arc, step):
    length = batch.arc_upper[arc] - batch.arc_lower[arc]
    if length <= 0.0:
        return 0
    return max(2, math.ceil(length / step))


@kernel
def node_angle(batch, arc, place, pieces):
    """The approach angle of a node [rad]."""
    lower, upper = batch.arc_lower[arc], batch.arc_upper[arc]
    if place == pieces:
        return upper
    return lower + (upper - lower) * (place / pieces)


@kernel
def node_angles(batch, arcs, places, pieces):
    """The approach angles of nodes, shape (nodes,) [rad]."""
    angles = np.empty(len(arcs))
    for n in range(len(arcs)):
        angles[n] = node_angle(batch, arcs[n], places[n], pieces[n])
    return angles


@kernel
def kept_nodes(through, layers, most):
    """Which nodes are among the `most` cheapest of their layer; shape (nodes,), ties are kept."""
    kept = np.empty(len(through), dtype=np.bool_)
    for k in range(len(layers) - 1):
        costs = through[layers[k] : layers[k + 1]]
        limit = math.inf if len(costs) <= most else np.partition(costs, most - 1)[most - 1]
        for n in range(layers[k], layers[k + 1]):
            kept[n] = through[n] <= limit
    return kept


@kernel
def halved(kept, layers, arcs, places, pieces):
    """The kept nodes with the middles beside them, on arcs of twice as many pieces.

    Returns layers, arcs, places, pieces as `even_nodes` does, and for each node the node it was
    before, or -1.
    """
    most = 3 * kept.sum()
    new_layers = np.empty(len(layers), dtype=np.int64)
    new_arcs = np.empty(most, dtype=np.int64)
    new_places = np.empty(most, dtype=np.int64)
    new_pieces = np.empty(most, dtype=np.int64)
    origins = np.empty(most, dtype=np.int64)
    n = 0
    for k in range(len(layers) - 1):
        new_layers[k] = n
        for old in range(layers[k], layers[k + 1]):
            if not kept[old]:
                continue
            for place in range(2 * places[old] - 1, 2 * places[old] + 2):
                if place < 0 or place > 2 * pieces[old]:
                    continue
                if (
                    n > new_layers[k]
                    and new_arcs[n - 1] == arcs[old]
                    and new_places[n - 1] >= place
                ):
                    continue
                new_arcs[n], new_places[n], new_pieces[n] = arcs[old], place, 2 * pieces[old]
                origins[n] = old if place == 2 * places[old] else -1
                n += 1
    new_layers[len(layers) - 1] = n
    return new_layers, new_arcs[:n], new_places[:n], new_pieces[:n], origins[:n]


@kernel
def refined_ladder(batch, order, step, most, rounds):
    """A cheapest chain through the refined ladder graph of targets in an order.

    Args:
        batch: the targets; each of `order` has an arc at least.
        order: indices of targets, shape (n,).
        step: distance of the first angles at most [rad].
        most: nodes a target that are kept in a round.
        rounds: how often the distance is halved.

    Returns:
        Arcs and angles of the chain, shape (n,) each, and its effort.
    """
    layers, arcs, places, pieces = even_nodes(batch, order, step)
    start = batch.start.reshape(6, 1)
    squared = batch.squared
    angles = node_angles(batch, arcs, places, pieces)
    thinning, standby = np.empty((6, len(arcs))), np.empty((6, len(arcs)))
    arc_postures(batch, arcs, angles, thinning, standby)
    for _ in range(rounds):
        through, backward = np.empty(len(arcs)), np.empty(len(arcs))
        costs_forward(start, thinning, standby, layers, squared, through)
        costs_backward(thinning, standby, layers, squared, backward)
        through += backward
        kept = kept_nodes(through, layers, most)
        layers, arcs, places, pieces, origins = halved(kept, layers, arcs, places, pieces)
        angles = node_angles(batch, arcs, places, pieces)
        thinning, standby = _carried(batch, arcs, angles, origins, thinning, standby)
    backward = np.empty(len(arcs))
    costs_backward(thinning, standby, layers, squared, backward)
    chain = cheapest_chain(start, thinning, standby, layers, squared, backward)
    total = chain_effort(start, thinning, standby, chain, squared)
    return arcs[chain], angles[chain], total


@kernel
def _carried(batch, arcs, angles, origins, thinning, standby):
    """Postures of nodes: those there were before are copied, the others computed."""
    fresh = np.flatnonzero(origins < 0)
    new_thinning, new_standby = np.empty((6, len(fresh))), np.empty((6, len(fresh)))
    arc_postures(batch, arcs[fresh], angles[fresh], new_thinning, new_standby)
    all_thinning, all_standby = np.empty((6, len(arcs))), np.empty((6, len(arcs)))
    f = 0
    for n in range(len(arcs)):
        old = origins[n]
        for i in range(6):
            all_thinning[i, n] = new_thinning[i, f] if old < 0 else thinning[i, old]
            all_standby[i, n] = new_standby[i, f] if old < 0 else standby[i, old]
        if old < 0:
            f += 1
    return all_thinning, all_standby
