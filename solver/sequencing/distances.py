"""Kernels: how far targets are from each other, whatever the approaches."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import numpy as np

from solver.compiled import kernel
from solver.sequencing.min_plus import relax


@kernel
def target_distances(nodes):
    """Least effort from any approach of a target to any of another, shape (targets + 1, targets).

    The last row counts from the start posture.
    """
    n = len(nodes.first) - 1
    distances = np.full((n + 1, n), np.inf)
    values = np.empty(nodes.thinning.shape[1])
    for j in range(n + 1):
        values[:] = np.inf
        if j == n:
            relax(values, nodes.start, 0, 0.0, nodes.thinning, 0, len(values), nodes.squared)
        else:
            for i in range(nodes.first[j], nodes.first[j + 1]):
                relax(values, nodes.standby, i, 0.0, nodes.thinning, 0, len(values), nodes.squared)
        for k in range(n):
            distances[j, k] = values[nodes.first[k] : nodes.first[k + 1]].min()
    return distances


@kernel
def nearest_next(distances):
    """Each time the nearest target that is left, from the start; ties to the first."""
    n = distances.shape[1]
    order = np.empty(n, dtype=np.int64)
    used = np.zeros(n, dtype=np.bool_)
    here = n
    for p in range(n):
        best = -1
        for k in range(n):
            if not used[k] and (best < 0 or distances[here, k] < distances[here, best]):
                best = k
        order[p], used[best], here = best, True, best
    return order
