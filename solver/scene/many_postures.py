"""Many postures of an arm among obstacles: which touch, and how near each comes."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.compiled import kernel
from solver.robots.model import Array
from solver.scene.arm_body import ArmBody
from solver.scene.clearance import body_scratch, nearest, touches
from solver.scene.packing import Obstacles


@dataclass(frozen=True)
class NearestPairs:
    """The nearest pair of the arm and an obstacle in n postures.

    Attributes:
        distances_m: depth is below zero; what was looked up to where nothing is nearer, shape (n,).
        shapes: numbers of the arm's shapes, see `shape_names`; -1 where nothing is, shape (n,).
        obstacles: numbers in `Scene.ids`; -1 where nothing is, shape (n,).
    """

    distances_m: Array
    shapes: NDArray[np.int64]
    obstacles: NDArray[np.int64]


def touching(
    body: ArmBody, obstacles: Obstacles, clearance_m: float, postures: Array
) -> NDArray[np.bool_]:
    """Whether postures, shape (n, joints), come nearer to an obstacle than that, shape (n,)."""
    found = np.empty(len(postures), dtype=np.bool_)
    write_touching(body, obstacles, clearance_m, postures, found)
    return found


def nearest_pairs(
    body: ArmBody, obstacles: Obstacles, most_m: float, postures: Array
) -> NearestPairs:
    """The nearest pair of each posture, shape (n, joints), as far as it is nearer than that."""
    n = len(postures)
    shapes, numbers = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int64)
    found = NearestPairs(np.empty(n), shapes, numbers)
    write_nearest(body, obstacles, most_m, postures, found.distances_m, shapes, numbers)
    return found


@kernel
def write_touching(body, obstacles, clearance, postures, found):
    """Writes `touching` to found, shape (n,)."""
    scratch = body_scratch(body)
    for k in range(len(postures)):
        found[k] = touches(body, obstacles, clearance, postures[k], scratch)


@kernel
def write_nearest(body, obstacles, most, postures, distances, shapes, numbers):
    """Writes the fields of `NearestPairs`, shape (n,) each."""
    scratch = body_scratch(body)
    for k in range(len(postures)):
        distances[k], shapes[k], numbers[k] = nearest(body, obstacles, most, postures[k], scratch)
