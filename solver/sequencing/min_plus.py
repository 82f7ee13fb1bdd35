"""Kernels: least effort through the layers of a ladder graph (min-plus dynamic programme).

Postures are scaled (see `solver.sequencing.batch.Batch`), joints as rows, so that an effort is a
plain sum of |difference| or of squares, and the inner loops run over nodes and vectorise.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.compiled import kernel
from solver.problem.effort import joint_cost


@kernel
def relax(values, fixed, fixed_at, fixed_value, others, first, last, squared):
    """values[m] = min(values[m], fixed_value + effort between a fixed node and other node m).

    Args:
        values: shape (nodes,); those from `first` up to `last` are lowered.
        fixed: postures, shape (6, ...), whose column `fixed_at` is the fixed node.
        fixed_at: that column.
        fixed_value: what is added to each effort.
        others: postures of the other nodes, shape (6, nodes).
        first: the first node that is lowered.
        last: the node after the last one.
        squared: the norm is l2.
    """
    a, b, c = fixed[0, fixed_at], fixed[1, fixed_at], fixed[2, fixed_at]
    d, e, f = fixed[3, fixed_at], fixed[4, fixed_at], fixed[5, fixed_at]
    if squared:
        for m in range(first, last):
            u, v = joint_cost(others[0, m] - a, True), joint_cost(others[1, m] - b, True)
            w, x = joint_cost(others[2, m] - c, True), joint_cost(others[3, m] - d, True)
            y, z = joint_cost(others[4, m] - e, True), joint_cost(others[5, m] - f, True)
            values[m] = min(values[m], fixed_value + (u + v + w + x + y + z))
    else:
        for m in range(first, last):
            u, v = joint_cost(others[0, m] - a, False), joint_cost(others[1, m] - b, False)
            w, x = joint_cost(others[2, m] - c, False), joint_cost(others[3, m] - d, False)
            y, z = joint_cost(others[4, m] - e, False), joint_cost(others[5, m] - f, False)
            values[m] = min(values[m], fixed_value + (u + v + w + x + y + z))


@kernel
def costs_forward(start, thinning, standby, layers, squared, values):
    """values[n] = least effort from the start posture to the thinning posture of node n.

    Args:
        start: scaled start posture, shape (6, 1).
        thinning: scaled thinning postures, shape (6, nodes).
        standby: scaled standby postures, shape (6, nodes).
        layers: layer k has the nodes layers[k] up to layers[k + 1], shape (targets + 1,).
        squared: the norm is l2.
        values: written, shape (nodes,).
    """
    values[:] = math.inf
    relax(values, start, 0, 0.0, thinning, layers[0], layers[1], squared)
    for k in range(1, len(layers) - 1):
        for i in range(layers[k - 1], layers[k]):
            relax(values, standby, i, values[i], thinning, layers[k], layers[k + 1], squared)


@kernel
def costs_backward(thinning, standby, layers, squared, values):
    """values[n] = least effort from the standby posture of node n to the end of the batch."""
    values[:] = math.inf
    last = len(layers) - 2
    values[layers[last] : layers[last + 1]] = 0.0
    for k in range(last, 0, -1):
        for m in range(layers[k], layers[k + 1]):
            relax(values, thinning, m, values[m], standby, layers[k - 1], layers[k], squared)


@kernel
def cheapest_chain(start, thinning, standby, layers, squared, backward):
    """The nodes of a cheapest chain, one a layer, from the costs backward; ties to the first."""
    count = len(layers) - 1
    chain = np.empty(count, dtype=np.int64)
    costs = np.full(thinning.shape[1], math.inf)
    for k in range(count):
        first, last = layers[k], layers[k + 1]
        if k == 0:
            relax(costs, start, 0, 0.0, thinning, first, last, squared)
        else:
            relax(costs, standby, chain[k - 1], 0.0, thinning, first, last, squared)
        best = first
        for m in range(first, last):
            if costs[m] + backward[m] < costs[best] + backward[best]:
                best = m
        chain[k] = best
    return chain


@kernel
def chain_effort(start, thinning, standby, chain, squared):
    """The effort of one chain of nodes."""
    total = 0.0
    for k in range(len(chain)):
        for i in range(6):
            before = start[i, 0] if k == 0 else standby[i, chain[k - 1]]
            total += joint_cost(thinning[i, chain[k]] - before, squared)
    return total
