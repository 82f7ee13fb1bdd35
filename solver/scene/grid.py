"""A grid over many obstacles: which are in a cell, and how far it is to the next cell with any.

A link's axis is gone along in steps as long as nothing can be near ("sphere tracing"); what is near
is looked at one by one.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.compiled import inlined, kernel
from solver.robots.model import Array
from solver.scene.distances import squared_between
from solver.scene.tolerances import GRID_CELLS

HALF_DIAGONAL = math.sqrt(3.0) / 2.0
"""Of a cell of unit length."""


class Grid(NamedTuple):
    """Cells in a box, numbered with z fastest.

    Attributes:
        origin: the box's lowest corner, shape (3,) [m].
        cell: length of a cell's edges [m].
        counts: cells along x, y and z, shape (3,).
        starts: where each cell's items begin, shape (cells + 1,).
        items: numbers of capsules, cell after cell, shape (starts[-1],).
        gaps: least distance of a place in each cell to whatever is in another cell, and 0 in cells
            that have something, shape (cells,) [m].
        nearest: the cell with something whose centre is nearest to that of each, shape (cells,).
    """

    origin: Array
    cell: float
    counts: NDArray[np.int64]
    starts: NDArray[np.int32]
    items: NDArray[np.int32]
    gaps: NDArray[np.float32]
    nearest: NDArray[np.int32]


def empty_grid() -> Grid:
    """A grid without cells."""
    return Grid(
        np.zeros(3), 1.0, np.zeros(3, dtype=np.int64), np.zeros(1, dtype=np.int32),
        np.empty(0, dtype=np.int32), np.empty(0, dtype=np.float32), np.empty(0, dtype=np.int32),
    )  # fmt: skip


def fill_grid(capsules: Array, reach_m: float) -> Grid:
    """The grid of capsules, shape (n, CAPSULE_COLUMNS), as far as they are within reach.

    Args:
        capsules: rows of `Obstacles.gridded`.
        reach_m: cells beyond it along x, y or z are left out [m].
    """
    if not len(capsules):
        return empty_grid()
    ends = np.stack((capsules[:, :3], capsules[:, :3] + capsules[:, 3:6]))
    radii = capsules[:, 6:7]
    low = np.maximum((ends.min(axis=0) - radii).min(axis=0), -reach_m)
    high = np.minimum((ends.max(axis=0) + radii).max(axis=0), reach_m)
    size = np.maximum(high - low, 0.0)
    cell = max(float(size.max()), float(radii.max())) / GRID_CELLS
    counts = np.maximum(np.ceil(size / cell), 1).astype(np.int64)
    cells = int(counts.prod())
    starts, filled = np.zeros((2, cells + 1), dtype=np.int32)
    put_items(capsules, low, cell, counts, starts, np.empty(0, dtype=np.int32), filled)
    np.cumsum(filled[:-1], out=starts[1:])
    items = np.empty(int(starts[-1]), dtype=np.int32)
    filled[:] = 0
    put_items(capsules, low, cell, counts, starts, items, filled)
    gaps = np.where(filled[:-1] > 0, 0.0, math.inf)
    nearest = np.arange(cells, dtype=np.int32)
    squared_gaps(gaps, nearest, counts)
    # Between centres of cells; a place and a solid are each half a diagonal off theirs at most.
    gaps = np.maximum(np.sqrt(gaps) - 2 * HALF_DIAGONAL, 0.0) * cell
    return Grid(low, cell, counts, starts, items, gaps.astype(np.float32), nearest)


@inlined
def first_and_last(low, high, origin, per_cell, count):
    """The cells that an interval is in along one edge: from the first to before the last."""
    first = math.floor((low - origin) * per_cell)
    last = math.floor((high - origin) * per_cell) + 1
    return max(first, 0), min(last, count)


@kernel
def cell_range(capsule, origin, cell, counts, ranges):
    """Writes the cells around a capsule along x, y and z, shape (3, 2)."""
    for i in range(3):
        a, b = capsule[i], capsule[i] + capsule[3 + i]
        low, high = min(a, b) - capsule[6], max(a, b) + capsule[6]
        ranges[i, 0], ranges[i, 1] = first_and_last(low, high, origin[i], 1.0 / cell, counts[i])


@kernel
def is_in_cell(capsule, x, y, z, cell):
    """Whether a capsule may be in the cell around a centre: certainly where it is a ball."""
    if capsule[3] == 0.0 and capsule[4] == 0.0 and capsule[5] == 0.0:
        half, total = cell / 2, 0.0
        for i, place in enumerate((x, y, z)):
            beyond = max(abs(capsule[i] - place) - half, 0.0)
            total += beyond * beyond
        return total <= capsule[6] * capsule[6]
    near = capsule[6] + HALF_DIAGONAL * cell
    apart = squared_between(
        x, y, z, 0.0, 0.0, 0.0,
        capsule[0], capsule[1], capsule[2], capsule[3], capsule[4], capsule[5],
    )  # fmt: skip
    return apart <= near * near


@kernel
def put_items(capsules, origin, cell, counts, starts, items, filled):
    """Counts the capsules in each cell into `filled`, and writes their numbers if there is room.

    Args:
        capsules: shape (n, CAPSULE_COLUMNS).
        origin: the grid's lowest corner, shape (3,) [m].
        cell: length of its cells' edges [m].
        counts: cells along x, y and z, shape (3,).
        starts: where each cell's items begin, shape (cells + 1,).
        items: shape (starts[-1],); without room capsules are only counted.
        filled: zeros, shape (cells + 1,).
    """
    ranges = np.empty((3, 2), dtype=np.int64)
    for m in range(len(capsules)):
        cell_range(capsules[m], origin, cell, counts, ranges)
        for i in range(ranges[0, 0], ranges[0, 1]):
            for j in range(ranges[1, 0], ranges[1, 1]):
                for k in range(ranges[2, 0], ranges[2, 1]):
                    x = origin[0] + (i + 0.5) * cell
                    y = origin[1] + (j + 0.5) * cell
                    z = origin[2] + (k + 0.5) * cell
                    if is_in_cell(capsules[m], x, y, z, cell):
                        number = (i * counts[1] + j) * counts[2] + k
                        if len(items) > 0:
                            items[starts[number] + filled[number]] = m
                        filled[number] += 1


@kernel
def squared_gaps(values, nearest, counts):
    """Squared distances to the nearest cell with something, in place, and which that is.

    They begin with zeros where there is something, else infinity, and each cell's own number.
    Exact, one edge after the other: the lower envelope of parabolas.
    Source: P. Felzenszwalb, D. Huttenlocher, Distance Transforms of Sampled Functions (2012).
    """
    longest = counts.max()
    line, place = np.empty(longest), np.empty(longest, dtype=np.int64)
    bounds, known = np.empty(longest + 1), np.empty(longest, dtype=np.int32)
    strides = np.array([counts[1] * counts[2], counts[2], 1])
    for edge in range(3):
        n, stride = counts[edge], strides[edge]
        for first in range(len(values)):
            if (first // stride) % n != 0:
                continue
            for q in range(n):
                line[q], known[q] = values[first + q * stride], nearest[first + q * stride]
            top = -1
            for q in range(n):
                if line[q] == math.inf:
                    continue
                start = -math.inf
                while top >= 0:
                    p = place[top]
                    start = ((line[q] + q * q) - (line[p] + p * p)) / (2.0 * (q - p))
                    if start > bounds[top]:
                        break
                    top -= 1
                    start = -math.inf
                top += 1
                place[top], bounds[top] = q, start
            if top < 0:
                continue
            at = 0
            for q in range(n):
                while at < top and bounds[at + 1] < q:
                    at += 1
                p = place[at]
                values[first + q * stride] = (q - p) * (q - p) + line[p]
                nearest[first + q * stride] = known[p]
