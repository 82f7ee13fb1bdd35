"""Poses: checked, and targets brought to the base."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from solver import InvalidProblem, Options, Problem, Robot, Target, solve
from solver.frames.tolerances import ORTHONORMAL, UNIT_QUATERNION
from solver.frames.transforms import (
    RigidTransform,
    transform_from_matrix,
    transform_from_quaternion,
)
from solver.problem.targets import targets_in_base
from solver.robots.model import Array

coordinates = st.floats(-2.0, 2.0)
places = st.tuples(coordinates, coordinates, coordinates)
IDENTITY = np.eye(3)


@st.composite
def rotations(draw: st.DrawFn) -> Array:
    numbers = draw(st.tuples(*[st.floats(-1, 1)] * 4))
    assume(math.hypot(*numbers) > 0.1)
    return np.asarray(Rotation.from_quat(numbers).as_matrix())


def pose(position_m: Any, rotation: Array) -> RigidTransform:
    return transform_from_matrix(position_m, rotation.tolist())[0]


def faults(call: Any, *arguments: Any) -> dict[str, str]:
    with pytest.raises(InvalidProblem) as raised:
        call(*arguments)
    return {fault.pointer: fault.detail for fault in raised.value.faults}


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


@given(places, rotations())
def test_a_plan_in_any_frame_is_the_plan_in_base(
    tabletop: Robot, position: tuple[float, ...], rotation: Array
) -> None:
    there = pose(position, rotation)
    options = Options(method="ssas", include=("path",))
    in_base = [
        Target("1", (0.185, -0.057, 0.42), (-1, -1, 1)),
        Target("2", (0.2, 0.05, 0.38), (0, 3, 1), position_std_m=0.001),
        Target("3", (2.0, 0.0, 0.3), (0, 1, 0)),
    ]
    back = there.inverse
    sent = [
        Target(
            one.id,
            tuple(back.points(np.array([one.position_m]))[0].tolist()),
            tuple(back.directions(np.array([one.branch_direction], dtype=float))[0].tolist()),
            one.position_std_m,
        )
        for one in in_base
    ]
    found = targets_in_base(sent, there)
    assert [one.position_std_m for one in found] == [None, 0.001, None]
    plan = solve(Problem(tabletop, found, options=options))
    expected = solve(Problem(tabletop, in_base, options=options))
    assert [one.status for one in plan.approaches] == ["planned", "planned", "infeasible"]
    assert plan.total_effort == pytest.approx(expected.total_effort, abs=1e-6)
    for one, other in zip(plan.approaches, expected.approaches, strict=True):
        assert one.status == other.status
        if one.thinning_joints is not None:
            assert one.branch == other.branch
            assert one.thinning_joints == pytest.approx(other.thinning_joints, abs=1e-5)
        else:
            assert one.reason is not None
            assert other.reason is not None
            assert one.reason.code == other.reason.code


@pytest.mark.parametrize(
    ("position", "direction", "field"),
    [
        ((0.1, 0.2), (0, 1, 0), "position_m"),
        ((0.1, 0.2, math.nan), (0, 1, 0), "position_m"),
        ((1e308, 1e308, -1e308), (0, 1, 0), "position_m"),
        ((0.2, 0.1, 0.3), (0, 0, 0), "branch_direction"),
        ((0.2, 0.1, 0.3), (1.7e308, 1.7e308, 0), "branch_direction"),
        ((0.2, 0.1, 0.3), (0, 1), "branch_direction"),
    ],
)
def test_what_is_no_target_stays_for_the_problem_to_refuse(
    tabletop: Robot, position: Any, direction: Any, field: str
) -> None:
    there = pose((1, 2, 3), np.asarray(Rotation.from_rotvec([0.3, 0.2, 1]).as_matrix()))
    good = Target("1", (0.2, 0.1, 0.3), (0, 1, 0))
    found = targets_in_base([good, Target("2", position, direction)], there)
    assert found[0] != good
    told = faults(Problem, tabletop, found)
    assert set(told) == {f"#/targets/1/{field}"}
    assert targets_in_base([Target("2", position, direction)], there)[0].id == "2"
