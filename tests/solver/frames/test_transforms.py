"""Poses, checked."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.frames.tolerances import ORTHONORMAL, UNIT_QUATERNION
from solver.frames.transforms import (
    transform_from_matrix,
    transform_from_quaternion,
)
from solver.robots.model import Array
from tests.solver.frames.poses import faults, places, pose, rotations

IDENTITY = np.eye(3)


@given(places, rotations())
def test_matrix_and_quaternion_are_one_pose(position: tuple[float, ...], rotation: Array) -> None:
    by_matrix, no_warnings = transform_from_matrix(position, rotation.tolist())
    assert no_warnings == ()
    assert by_matrix.rotation == pytest.approx(rotation, abs=1e-12)
    assert math.hypot(*by_matrix.quaternion_xyzw) == pytest.approx(1, abs=1e-15)
    assert by_matrix.quaternion_xyzw[3] >= 0
    for sign in (1, -1):
        quaternion = [sign * value for value in by_matrix.quaternion_xyzw]
        by_quaternion, no_warnings = transform_from_quaternion(position, quaternion)
        assert no_warnings == ()
        assert by_quaternion.rotation == pytest.approx(rotation, abs=1e-12)


@given(places, rotations(), places)
def test_inverse_leads_back(
    position: tuple[float, ...], rotation: Array, point: tuple[float, ...]
) -> None:
    there = pose(position, rotation)
    points = np.array([point])
    assert there.inverse.points(there.points(points)) == pytest.approx(points, abs=1e-12)
    assert there.points(np.zeros((1, 3)))[0] == pytest.approx(np.array(position))
    turned = there.directions(np.eye(3)).T
    assert turned == pytest.approx(rotation, abs=1e-12)


@given(rotations(), st.sampled_from([0.5, 1.01, 1000.0]), st.booleans())
def test_scaled_and_mirrored_matrices_are_told_apart(
    rotation: Array, size: float, mirrored: bool
) -> None:
    hand = np.diag([1.0, 1.0, -1.0 if mirrored else 1.0])
    told = faults(transform_from_matrix, (0, 0, 0), (size * rotation @ hand).tolist())
    assert f"scaled by {size:.4g}" in told["#/rotation_matrix"]
    assert ("mirrored" in told["#/rotation_matrix"]) is mirrored
    told = faults(transform_from_matrix, (0, 0, 0), (rotation @ np.diag([1, -1, 1])).tolist())
    assert "reflection" in told["#/rotation_matrix"]


@given(rotations(), st.integers(3, 9))
def test_few_digits_are_made_exact_and_told(rotation: Array, digits: int) -> None:
    rounded = np.round(rotation, digits)
    kept, warnings = transform_from_matrix((0, 0, 0), rounded.tolist())
    assert kept.rotation @ kept.rotation.T == pytest.approx(IDENTITY, abs=1e-12)
    change = np.abs(kept.rotation - rounded).max()
    assert change <= ORTHONORMAL
    assert [row.code for row in warnings] == (["few_digits"] if change > 1e-6 else [])


@pytest.mark.parametrize(
    ("position", "rotation", "pointer", "word"),
    [
        ([0, 0], IDENTITY, "#/position_m", "3 numbers"),
        ([0, 0, math.nan], IDENTITY, "#/position_m", "finite"),
        ([0, 0, 2e7], IDENTITY, "#/position_m", "metres"),
        ([0, 0, 0], IDENTITY[:2], "#/rotation_matrix", "3 rows"),
        ([0, 0, 0], [[1, 0, 0], [0, 1], [0, 0, 1]], "#/rotation_matrix/1", "3 numbers"),
        ([0, 0, 0], [[1, 0, 0], [0, math.inf, 0], [0, 0, 1]], "#/rotation_matrix/1", "finite"),
        ([0, 0, 0], [[1, 0, 0], [0.1, 1, 0], [0, 0, 1]], "#/rotation_matrix", "right angles"),
        ([0, 0, 0], [[0, 0, 0]] * 3, "#/rotation_matrix", "length"),
        ([0, 0, 0], [[1e300, 0, 0], [0, 1e300, 0], [0, 0, 1e300]], "#/rotation_matrix", "length"),
    ],
)
def test_matrix_poses_that_make_no_sense(
    position: Any, rotation: Any, pointer: str, word: str
) -> None:
    assert word in faults(transform_from_matrix, position, rotation)[pointer]


@pytest.mark.parametrize("off", [-1.0, -2 * UNIT_QUATERNION, 2 * UNIT_QUATERNION, 1e300])
def test_quaternions_have_length_one(off: float) -> None:
    told = faults(transform_from_quaternion, (0, 0, math.inf), (0, 0, 0, 1 + off))
    assert set(told) == {"#/position_m", "#/quaternion_xyzw"}
    assert "length" in told["#/quaternion_xyzw"]
    assert "4 numbers" in faults(transform_from_quaternion, (0, 0, 0), (0, 0, 1)).popitem()[1]


def test_a_frame_far_away_is_warned_of() -> None:
    (warning,) = transform_from_quaternion((650, 0, 400), (0, 0, 0, 1))[1]
    assert warning.code == "far"
