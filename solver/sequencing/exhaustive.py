"""Kernels: the cheapest orders of a few targets, exactly on given nodes (Held and Karp, 1962).

Backwards, from sets that lack one target to those that lack one more, the least effort of the rest
of the way is known for every node. Partial orders are then opened best first, with that as
the exact cost of what is left, so that the cheapest orders come out one after the other.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.compiled import kernel
from solver.sequencing.min_plus import relax
from solver.sequencing.tolerances import EXACT_OPEN


@kernel
def remaining_costs(nodes):
    """Least effort from the standby of a node through all targets not in a set.

    Shape (2^targets, nodes); a set has bit k for target k, and holds the node's own target.
    """
    n = len(nodes.first) - 1
    count = nodes.thinning.shape[1]
    costs = np.full((1 << n, count), math.inf)
    full = (1 << n) - 1
    costs[full] = 0.0
    for visited in range(full - 1, 0, -1):
        for k in range(n):
            if visited >> k & 1:
                continue
            after = visited | (1 << k)
            for m in range(nodes.first[k], nodes.first[k + 1]):
                for j in range(n):
                    if visited >> j & 1:
                        relax(
                            costs[visited], nodes.thinning, m, costs[after, m], nodes.standby,
                            nodes.first[j], nodes.first[j + 1], nodes.squared,
                        )  # fmt: skip
    return costs


@kernel
def cheapest_orders(nodes, most):
    """The cheapest orders on the nodes, cheapest first, shape (orders, targets).

    Partial orders with their least effort at every node of the last target are opened best first
    (their exact effort so far, plus the exact least effort of the rest), until `most` are whole.
    """
    n = len(nodes.first) - 1
    count = nodes.thinning.shape[1]
    rest = remaining_costs(nodes)
    most_open = EXACT_OPEN * most * n
    bounds = np.full(most_open, math.inf)
    values = np.full((most_open, count), math.inf)
    orders = np.zeros((most_open, n), dtype=np.int64)
    lengths = np.zeros(most_open, dtype=np.int64)
    found = np.empty((most, n), dtype=np.int64)
    whole = 0
    bounds[0] = 0.0
    used = 1
    while whole < most:
        best = int(np.argmin(bounds[:used]))
        if bounds[best] == math.inf:
            break
        bounds[best] = math.inf
        length = lengths[best]
        if length == n:
            found[whole] = orders[best]
            whole += 1
            continue
        visited = 0
        for p in range(length):
            visited |= 1 << orders[best, p]
        for k in range(n):
            if visited >> k & 1 or used == most_open:
                continue
            begin, end = nodes.first[k], nodes.first[k + 1]
            own = values[used]
            if length == 0:
                relax(own, nodes.start, 0, 0.0, nodes.thinning, begin, end, nodes.squared)
            else:
                j = orders[best, length - 1]
                for i in range(nodes.first[j], nodes.first[j + 1]):
                    relax(
                        own, nodes.standby, i, values[best, i], nodes.thinning, begin, end,
                        nodes.squared,
                    )  # fmt: skip
            bounds[used] = (own[begin:end] + rest[visited | (1 << k), begin:end]).min()
            orders[used, :length] = orders[best, :length]
            orders[used, length] = k
            lengths[used] = length + 1
            used += 1
    return found[:whole]
