"""Kernels: the smallest displacement of a refused target, sought from everywhere.

From each of many angles on each branch, with nothing left out for promising little, and then at
random among what is shorter than the best of all: whatever has an arc is a witness.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.arcs.roots import arc_scratch
from solver.approach.arcs.search import find_arcs
from solver.approach.arcs.splitting import ARC_COLUMNS, MOST_ARCS
from solver.approach.refusal.displacement_search import nearest_displacement
from solver.approach.refusal.tolerances import NEAREST_FOUND_SHARE, NEAREST_INSIDE_M
from solver.approach.task.packed import COLUMNS, PackedTask
from solver.compiled import kernel
from solver.kinematics.spherical_wrist import BRANCHES

_POSITION = COLUMNS["position"]


@kernel
def shortest_from_everywhere(task, angles):
    """The smallest displacement from no displacement at all on each branch at each angle [m].

    Infinity where none is found; `angles` of shape (n,) [rad].
    """
    rows, start = np.empty((len(task.retreats), 6)), np.zeros(4)
    known, shortest = np.full(4, np.inf), math.inf
    for branch in range(BRANCHES):
        for angle in angles:
            start[:3], start[3] = 0.0, angle
            feasible, x = nearest_displacement(
                task, branch, start, 0.0, NEAREST_INSIDE_M, known, math.inf,
                NEAREST_FOUND_SHARE, rows,
            )  # fmt: skip
            length = math.sqrt(x[0] ** 2 + x[1] ** 2 + x[2] ** 2)
            if feasible and length < shortest:
                shortest = length
    return shortest


@kernel
def shorter_at_random(packed, directions, lengths):
    """The shortest displacement of some, shape (n, 3) unit directions and (n,) [m], with an arc."""
    scratch, arcs = arc_scratch(len(packed.retreats)), np.empty((MOST_ARCS, ARC_COLUMNS))
    shortest, moved = math.inf, packed.numbers.copy()
    for n in range(len(lengths)):
        if lengths[n] >= shortest:
            continue
        for i in range(3):
            moved[_POSITION + i] = packed.numbers[_POSITION + i] + lengths[n] * directions[n, i]
        task = PackedTask(moved, packed.retreats, packed.cos_steps)
        if find_arcs(task, scratch, arcs) > 0:
            shortest = lengths[n]
    return shortest
