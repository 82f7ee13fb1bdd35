"""Obstacles as the kernels take them: numbers in rows, and a grid where there are many."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.robots.rigid import quaternion_matrix
from solver.robots.shapes import Box, Capsule
from solver.scene.grid import Grid, empty_grid, fill_grid
from solver.scene.obstacles import Array, Scene
from solver.scene.tolerances import DIRECT_CAPSULES

CAPSULE_COLUMNS = 11
"""Beginning, what leads to the end, radius; a ball around it all: centre and radius."""

BOX_COLUMNS = 16
"""Centre, the directions of the edges, half their lengths, radius of a ball around it."""

PLANE_COLUMNS = 4
"""Unit normal, and the offset along it [m]."""


class Obstacles(NamedTuple):
    """Solids in the base frame, and which obstacle of the scene each belongs to.

    Attributes:
        capsules: that are looked at one by one, shape (n, CAPSULE_COLUMNS).
        balls: centre and radius of the balls around them, column by column, shape (4, n).
        gridded: that are found by the grid, shape (m, CAPSULE_COLUMNS).
        grid: over these.
        boxes: shape (k, BOX_COLUMNS).
        planes: shape (l, PLANE_COLUMNS).
        of_capsules: numbers in `Scene.ids`, shape (n,); so the other three.
    """

    capsules: Array
    balls: Array
    gridded: Array
    grid: Grid
    boxes: Array
    planes: Array
    of_capsules: NDArray[np.int64]
    of_gridded: NDArray[np.int64]
    of_boxes: NDArray[np.int64]
    of_planes: NDArray[np.int64]


def pack_scene(scene: Scene, reach_m: float, *, soft: bool = False) -> Obstacles:
    """The hard obstacles of a scene, or its soft ones, for an arm of some reach.

    Args:
        scene: with shapes that make sense.
        reach_m: what is further from the base than this is left out of the grid: it is for
            distances up to those for which `body_reach_m` answered this [m].
        soft: what may be touched in place of what may not.
    """
    capsules, owners = _capsules(scene, soft)
    first_block = len(scene.chains)
    blocks = [(first_block + k, one.box) for k, one in enumerate(scene.blocks) if one.soft == soft]
    first_plane = first_block + len(scene.blocks)
    planes = [] if soft else [
        (first_plane + k, plane_row(one.position_m, one.normal))
        for k, one in enumerate(scene.planes)
    ]  # fmt: skip
    direct = len(capsules) <= DIRECT_CAPSULES
    none, nobody = np.empty((0, CAPSULE_COLUMNS)), np.empty(0, dtype=np.int64)
    grid = empty_grid()
    if not direct:
        near = np.linalg.norm(capsules[:, 7:10], axis=1) - capsules[:, 10] <= reach_m
        capsules, owners = np.ascontiguousarray(capsules[near]), owners[near]
        grid = fill_grid(capsules, reach_m)
    return Obstacles(
        capsules=capsules if direct else none,
        balls=np.ascontiguousarray((capsules if direct else none)[:, 7:11].T),
        gridded=none if direct else capsules,
        grid=grid,
        boxes=rows_of([box_row(box) for _, box in blocks], BOX_COLUMNS),
        planes=rows_of([row for _, row in planes], PLANE_COLUMNS),
        of_capsules=owners if direct else nobody,
        of_gridded=nobody if direct else owners,
        of_boxes=np.array([k for k, _ in blocks], dtype=np.int64),
        of_planes=np.array([k for k, _ in planes], dtype=np.int64),
    )


def _capsules(scene: Scene, soft: bool) -> tuple[Array, NDArray[np.int64]]:
    pieces = [
        (k, piece)
        for k, chain in enumerate(scene.chains)
        if chain.soft == soft
        for piece in chain.capsules()
    ]
    rows = [capsule_rows([piece for _, piece in pieces])]
    owners = [np.array([k for k, _ in pieces], dtype=np.int64)]
    first = len(scene.chains) + len(scene.blocks) + len(scene.planes)
    for k, cloud in enumerate(scene.points):
        if cloud.soft == soft:
            balls = np.zeros((len(cloud.points_m), CAPSULE_COLUMNS))
            balls[:, :3] = balls[:, 7:10] = cloud.points_m
            balls[:, 6] = balls[:, 10] = cloud.radius_m
            rows.append(balls)
            owners.append(np.full(len(balls), first + k, dtype=np.int64))
    return np.concatenate(rows), np.concatenate(owners)


def capsule_rows(capsules: Sequence[Capsule]) -> Array:
    """Rows of CAPSULE_COLUMNS numbers."""
    rows = np.empty((len(capsules), CAPSULE_COLUMNS))
    for row, capsule in zip(rows, capsules, strict=True):
        start, end = np.array(capsule.start_m), np.array(capsule.end_m)
        row[:3], row[3:6], row[6] = start, end - start, capsule.radius_m
        row[7:10] = (start + end) / 2
        row[10] = np.linalg.norm(end - start) / 2 + capsule.radius_m
    return rows


def box_row(box: Box) -> Array:
    """BOX_COLUMNS numbers."""
    half = np.array(box.size_m) / 2
    axes = quaternion_matrix(box.quaternion_xyzw).T
    return np.concatenate((box.position_m, axes.ravel(), half, [np.linalg.norm(half)]))


def plane_row(position_m: Sequence[float], normal: Sequence[float]) -> Array:
    """PLANE_COLUMNS numbers."""
    unit = np.array(normal) / np.linalg.norm(normal)
    return np.append(unit, unit @ np.array(position_m))


def rows_of(rows: Sequence[Array], columns: int) -> Array:
    """Rows as one array, which has its columns without rows too."""
    return np.array(rows, dtype=np.float64).reshape(len(rows), columns)
