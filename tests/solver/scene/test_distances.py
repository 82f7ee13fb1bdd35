"""Distances of segments against fine samples of both, and known ones."""

import math

import numpy as np
import pytest

from solver.robots.shapes import Box, Capsule
from solver.scene.distances import distance_to_box, distance_to_plane, squared_between
from solver.scene.obstacles import Array
from solver.scene.packing import box_row, capsule_rows, plane_row

SAMPLES = np.linspace(0.0, 1.0, 400)


def between(a: Array, d: Array, b: Array, e: Array) -> float:
    return math.sqrt(squared_between(*a, *d, *b, *e))


@pytest.mark.parametrize("seed", range(30))
def test_segments_are_as_near_as_their_nearest_points(seed: int) -> None:
    a, d, b, e = np.random.default_rng(seed).normal(size=(4, 3))
    points, others = (start + SAMPLES[:, None] * way for start, way in ((a, d), (b, e)))
    sampled = np.linalg.norm(points[:, None] - others, axis=2).min()
    spacing = max(np.linalg.norm(d), np.linalg.norm(e)) / (len(SAMPLES) - 1)
    found = between(a, d, b, e)
    assert sampled - spacing <= found <= sampled + 1e-12
    assert found == pytest.approx(between(b, e, a, d), abs=1e-12)


X, Y, ZERO = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), np.zeros(3)


@pytest.mark.parametrize(
    ("a", "d", "b", "e", "distance"),
    [
        (ZERO, X, 2 * Y, X, 2.0),  # beside each other
        (ZERO, X, 2 * X, X, 1.0),  # in one line
        (ZERO, X, 2 * X, -0.5 * X, 0.5),
        (ZERO, X, 0.5 * X - Y, 2 * Y, 0.0),  # crossing
        (ZERO, ZERO, 3 * Y, X, 3.0),  # a point
        (ZERO, X, 3 * X + 4 * Y, ZERO, math.hypot(2, 4)),
        (ZERO, ZERO, 5 * Y, ZERO, 5.0),  # two points
        (ZERO, X, Y, X + 1e-9 * Y, 1.0),  # all but parallel
        (ZERO, ZERO, ZERO, ZERO, 0.0),
    ],
)
def test_known_distances(a: Array, d: Array, b: Array, e: Array, distance: float) -> None:
    assert between(a, d, b, e) == pytest.approx(distance, abs=1e-9)


def box_and_segment(seed: int) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    half, turn, place = rng.uniform(0.05, 0.5, 3), rng.normal(size=4), rng.normal(size=3) * 0.3
    box = box_row(Box(tuple(place), tuple(2 * half), tuple(turn)))
    start, end = rng.normal(size=(2, 3)) * rng.choice((0.2, 1.0))
    return box, capsule_rows([Capsule(tuple(start), tuple(end), 0.01)])[0]


def beyond_faces(box: Array, one: Array) -> tuple[Array, Array]:
    """Distances of points of the axis to the box, and their depths in it, shape (samples,)."""
    points = one[:3] + SAMPLES[:, None] * one[3:6] - box[:3]
    places = np.abs(points @ box[3:12].reshape(3, 3).T) - box[12:15]
    return np.linalg.norm(np.maximum(places, 0.0), axis=1), -places.max(axis=1)


@pytest.mark.parametrize("seed", range(40))
def test_boxes_are_as_near_as_the_nearest_point_of_an_axis(seed: int) -> None:
    box, one = box_and_segment(seed)
    outside, depths = beyond_faces(box, one)
    spacing = float(np.linalg.norm(one[3:6])) / (len(SAMPLES) - 1)
    found = distance_to_box(one, box)
    if found > 0.0:
        assert outside.min() - spacing <= found <= outside.min() + 1e-12
    else:
        assert depths.max() - 1e-12 <= -found <= depths.max() + spacing


def test_some_axes_enter_their_box_and_some_do_not() -> None:
    inside = [distance_to_box(one, box) <= 0.0 for box, one in map(box_and_segment, range(40))]
    assert 5 < sum(inside) < 35


def test_planes_count_from_the_nearer_end() -> None:
    plane = plane_row((0.0, 0.0, 1.0), (0.0, 0.0, -5.0))
    one = capsule_rows([Capsule((0.0, 0.0, 0.2), (1.0, 0.0, 0.7), 0.05)])[0]
    assert distance_to_plane(one, plane) == pytest.approx(0.3)
    through = capsule_rows([Capsule((0.0, 0.0, 0.2), (1.0, 0.0, 1.7), 0.05)])[0]
    assert distance_to_plane(through, plane) == pytest.approx(-0.7)
