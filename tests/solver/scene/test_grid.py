"""The grid over many obstacles: nothing is missing from a cell, and gaps promise nothing untrue."""

import numpy as np
import pytest

from bench.scenes import leaves, twigs
from solver.robots.shapes import Capsule
from solver.scene.clearance import gap_at
from solver.scene.grid import Grid, empty_grid, fill_grid, squared_gaps
from solver.scene.obstacles import Array, Scene
from solver.scene.packing import Obstacles, capsule_rows, pack_scene

REACH_M = 0.5


def gridded(name: str, monkeypatch: pytest.MonkeyPatch) -> Obstacles:
    monkeypatch.setattr("solver.scene.packing.DIRECT_CAPSULES", 0)
    scenes = {"twigs": Scene(twigs(1, 80)), "points": Scene((), (), (), (leaves(2, 500),))}
    return pack_scene(scenes[name], REACH_M)


def cell_of(grid: Grid, place: Array) -> int | None:
    index = np.floor((place - grid.origin) / grid.cell).astype(int)
    if (index < 0).any() or (index >= grid.counts).any():
        return None
    return int((index[0] * grid.counts[1] + index[1]) * grid.counts[2] + index[2])


@pytest.mark.parametrize("name", ["twigs", "points"])
def test_what_has_a_place_is_in_the_cell_of_that_place(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    obstacles, rng = gridded(name, monkeypatch), np.random.default_rng(3)
    grid, looked = obstacles.grid, 0
    for number, row in enumerate(obstacles.gridded):
        for _ in range(5):
            aside = rng.normal(size=3)
            aside *= rng.uniform() * row[6] / np.linalg.norm(aside)
            own = cell_of(grid, row[:3] + rng.uniform() * row[3:6] + aside)
            if own is not None:
                assert number in grid.items[grid.starts[own] : grid.starts[own + 1]]
                looked += 1
    assert looked > len(obstacles.gridded)


@pytest.mark.parametrize("name", ["twigs", "points"])
def test_nothing_is_nearer_than_a_gap(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    obstacles, rng = gridded(name, monkeypatch), np.random.default_rng(4)
    rows, useful = obstacles.gridded, 0
    for place in rng.uniform(-0.8, 0.8, (400, 3)):
        along = np.einsum("ni,ni->n", place - rows[:, :3], rows[:, 3:6])
        shares = np.clip(along / np.maximum(np.sum(rows[:, 3:6] ** 2, axis=1), 1e-300), 0, 1)
        nearest = rows[:, :3] + shares[:, None] * rows[:, 3:6]
        distance = (np.linalg.norm(place - nearest, axis=1) - rows[:, 6]).min()
        gap = gap_at(obstacles.grid, *place)
        assert gap <= max(distance, 0.0) + 1e-7
        useful += gap > distance / 3
    # A gap of zero would be true everywhere.
    assert useful > 150


def test_gaps_between_cells_are_exact() -> None:
    rng = np.random.default_rng(5)
    counts = np.array([7, 5, 9])
    filled = rng.uniform(size=counts.prod()) < 0.03
    values = np.where(filled, 0.0, np.inf)
    nearest = np.arange(counts.prod(), dtype=np.int32)
    squared_gaps(values, nearest, counts)
    places = np.stack(np.unravel_index(np.arange(counts.prod()), counts), axis=1)
    apart = np.sum((places[:, None] - places[filled]) ** 2, axis=2)
    assert (values == apart.min(axis=1)).all()
    assert filled[nearest].all()
    assert (np.sum((places - places[nearest]) ** 2, axis=1) == values).all()


def test_one_point_and_no_point_make_a_grid() -> None:
    assert fill_grid(capsule_rows([]), REACH_M).gaps.size == 0
    assert empty_grid().starts.tolist() == [0]
    ball = capsule_rows([Capsule((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.01)])
    grid = fill_grid(ball, REACH_M)
    assert grid.items.size >= 1
    assert gap_at(grid, 0.3, 0.0, 0.0) > 0.25
    assert gap_at(grid, 0.0, 0.0, 0.0) == 0.0
