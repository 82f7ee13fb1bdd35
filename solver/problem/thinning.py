"""The 5-8 pattern: which blossoms of a branch are removed, and which stay to become fruit.

Source: T 3.1.2. From the branch's origin the first 5 cm lose all their blossoms. Then windows of
5 cm and 8 cm alternate, beginning with 5 cm: a 5 cm window keeps its first and its last blossom, an
8 cm window none. T says "usually the ones located in close proximity to the extremes"; here it is
always the first and the last, the two that are furthest apart.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from solver.exceptions import Fault, InvalidProblem
from solver.problem.tolerances import LONGEST_SEGMENT_M, SAME_POINT_M
from solver.robots.model import Array

# Whole nanometres, so that a blossom at a window's boundary is on the side where decimals put it.
_NANOMETRES: Final = 1_000_000_000
_BARE: Final = 50_000_000
_FRUITING: Final = 50_000_000
_PERIOD: Final = 130_000_000

MOST_FAULTS: Final = 1000
"""Nobody reads more, and a request may have hundreds of thousands of blossoms."""


@dataclass(frozen=True)
class Blossom:
    """A blossom on a branch.

    Attributes:
        id: any non-empty text, once among all branches.
        distance_m: from the branch's origin along the branch [m].
    """

    id: str
    distance_m: float


@dataclass(frozen=True)
class BlossomBranch:
    """A branch as a polyline, with its blossoms in any order.

    Attributes:
        id: any non-empty text, once among all branches.
        points_m: from the origin to the tip, two points or more of three numbers each [m].
        blossoms: what is on it.
    """

    id: str
    points_m: Sequence[Sequence[float]]
    blossoms: Sequence[Blossom]


@dataclass(frozen=True)
class PlacedBlossom:
    """A blossom with its place in space; `Target(id, position_m, branch_direction)` removes it.

    Attributes:
        id: the blossom's.
        branch_id: its branch's.
        position_m: on the branch [m].
        branch_direction: unit tangent towards the tip; at a corner, of the segment behind it.
        distance_m: from the branch's origin along the branch [m].
    """

    id: str
    branch_id: str
    position_m: tuple[float, float, float]
    branch_direction: tuple[float, float, float]
    distance_m: float


@dataclass(frozen=True)
class ThinningSelection:
    """What is removed and what stays, branch by branch as given, from origin to tip."""

    targets: tuple[PlacedBlossom, ...]
    keepers: tuple[PlacedBlossom, ...]


def select_blossoms(branches: Sequence[BlossomBranch]) -> ThinningSelection:
    """The 5-8 pattern on every branch.

    Windows are half-open: a blossom at a boundary belongs to the window that begins there. A window
    that the tip cuts off is a window like the others. A single blossom in a 5 cm window is its
    first and its last, and stays.

    Raises:
        InvalidProblem: with the faults found, MOST_FAULTS at most; paths begin with "branches".
    """
    if faults := tuple(itertools.islice(_faults(branches), MOST_FAULTS)):
        raise InvalidProblem(faults)
    targets: list[PlacedBlossom] = []
    keepers: list[PlacedBlossom] = []
    for branch in branches:
        along = sorted(branch.blossoms, key=lambda blossom: blossom.distance_m)
        kept = _kept([blossom.distance_m for blossom in along])
        for k, blossom in enumerate(_placed(branch, along)):
            (keepers if k in kept else targets).append(blossom)
    return ThinningSelection(tuple(targets), tuple(keepers))


def _kept(distances: Sequence[float]) -> set[int]:
    """Indices of the blossoms that stay, of distances in ascending order [m]."""
    windows: dict[int, list[int]] = {}
    for k, distance in enumerate(distances):
        window, place = divmod(_nanometres(distance) - _BARE, _PERIOD)
        if window >= 0 and place < _FRUITING:
            windows.setdefault(window, []).append(k)
    return {k for inside in windows.values() for k in (inside[0], inside[-1])}


def _nanometres(distance_m: float) -> int:
    return round(distance_m * _NANOMETRES)


def _placed(branch: BlossomBranch, along: Sequence[Blossom]) -> list[PlacedBlossom]:
    """Blossoms of a branch in space, in ascending order of distance."""
    points = np.asarray(branch.points_m, dtype=np.float64)
    distances = np.array([blossom.distance_m for blossom in along], dtype=np.float64)
    lengths = _segment_lengths(points)
    begins = np.append(0.0, np.cumsum(lengths)[:-1])
    segment = np.searchsorted(begins, distances, side="right") - 1
    directions = (np.diff(points, axis=0) / lengths[:, None])[segment]
    positions = points[segment] + (distances - begins[segment])[:, None] * directions
    return [
        PlacedBlossom(one.id, branch.id, _triple(position), _triple(direction), one.distance_m)
        for one, position, direction in zip(
            along, positions.tolist(), directions.tolist(), strict=True
        )
    ]


def _triple(values: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = values
    return x, y, z


def _segment_lengths(points: Array) -> Array:
    return np.asarray(np.linalg.norm(np.diff(points, axis=0), axis=1))


def _faults(branches: Sequence[BlossomBranch]) -> Iterator[Fault]:
    if not branches:
        yield Fault(("branches",), "there is no branch")
    branch_ids: dict[str, int] = {}
    blossom_ids: set[str] = set()
    for i, branch in enumerate(branches):
        path: tuple[str | int, ...] = ("branches", i)
        if not branch.id:
            yield Fault((*path, "id"), "the id is empty")
        elif branch.id in branch_ids:
            yield Fault((*path, "id"), f"also the id of branch {branch_ids[branch.id]}")
        branch_ids.setdefault(branch.id, i)
        length: float | None = None
        points_faults = list(_point_faults(branch.points_m, (*path, "points_m")))
        yield from points_faults
        if not points_faults:
            length = float(_segment_lengths(np.asarray(branch.points_m, dtype=np.float64)).sum())
        for j, blossom in enumerate(branch.blossoms):
            place = (*path, "blossoms", j)
            if not blossom.id:
                yield Fault((*place, "id"), "the id is empty")
            elif blossom.id in blossom_ids:
                yield Fault((*place, "id"), "also the id of a blossom before it")
            blossom_ids.add(blossom.id)
            if detail := _distance_problem(blossom.distance_m, length):
                yield Fault((*place, "distance_m"), detail)


def _point_faults(
    points: Sequence[Sequence[float]], path: tuple[str | int, ...]
) -> Iterator[Fault]:
    if len(points) < 2:
        yield Fault(path, f"needs two points or more, has {len(points)}")
    spoiled = False
    for k, point in enumerate(points):
        if len(point) != 3:
            spoiled = True
            yield Fault((*path, k), f"needs 3 numbers, has {len(point)}")
        elif not all(math.isfinite(value) for value in point):
            spoiled = True
            yield Fault((*path, k), "has a value that is not finite")
    if spoiled or len(points) < 2:
        return
    for k, (one, two) in enumerate(itertools.pairwise(points), start=1):
        distance = math.dist(one, two)
        if not distance > SAME_POINT_M:
            yield Fault((*path, k), "is the same point as the one before")
        elif not distance <= LONGEST_SEGMENT_M:
            detail = f"more than {LONGEST_SEGMENT_M:g} m from the one before; points are metres"
            yield Fault((*path, k), detail)


def _distance_problem(distance_m: float, length_m: float | None) -> str | None:
    if not math.isfinite(distance_m):
        return "is not finite"
    if distance_m < 0:
        return "is below zero; it counts from the branch's origin"
    if length_m is not None and distance_m > length_m + 0.5 / _NANOMETRES:
        return "is beyond the branch's tip"
    return None
