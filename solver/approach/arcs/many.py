"""Kernel: the feasible arcs of many targets: one loop, no Python between targets."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import numpy as np

from solver.approach.arcs.roots import arc_scratch
from solver.approach.arcs.search import find_arcs
from solver.approach.arcs.splitting import ARC_COLUMNS, MOST_ARCS
from solver.approach.task.packed import PackedTask
from solver.compiled import kernel


@kernel
def arcs_of_many(numbers, retreats, cos_steps):
    """Feasible arcs of many targets, shape (arcs, 2 + ARC_COLUMNS).

    Columns: target, tool side as its place in `numbers`, then those of one target's arcs.
    """
    scratch = arc_scratch(len(retreats))
    arcs = np.empty((MOST_ARCS, ARC_COLUMNS))
    table, count = np.empty((4 * numbers.shape[1] + MOST_ARCS, 2 + ARC_COLUMNS)), 0
    for k in range(numbers.shape[1]):
        for side in range(numbers.shape[0]):
            own = find_arcs(PackedTask(numbers[side, k], retreats, cos_steps), scratch, arcs)
            if count + own > len(table):
                table = np.concatenate((table, np.empty_like(table)))
            for i in range(own):
                table[count, 0], table[count, 1] = k, side
                table[count, 2:] = arcs[i]
                count += 1
    return table[:count].copy()
