"""Poses estimated from pairs of points, and what pairs say about a pose that is given."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from solver import InvalidProblem
from solver.frames.point_pairs import PointPair
from solver.frames.registration import check_frame, register_frame
from solver.frames.tolerances import MOST_PAIRS
from solver.frames.transforms import RigidTransform, transform_from_rotation
from solver.robots.model import Array

seeds = st.integers(0, 10**6)
counts = st.integers(4, 12)
NOISE_M = 5e-4


@dataclass(frozen=True)
class Scene:
    truth: RigidTransform
    frame_m: Array
    base_m: Array

    @property
    def pairs(self) -> list[PointPair]:
        return pairs(self.frame_m, self.base_m)


def pairs(frame_m: Array, base_m: Array) -> list[PointPair]:
    return [PointPair(*both) for both in zip(frame_m.tolist(), base_m.tolist(), strict=True)]


def scene(seed: int, count: int, noise_m: float = 0.0, scale: float = 1.0) -> Scene:
    """Points spread through half a metre, seen by a camera that stands anywhere."""
    rng = np.random.default_rng(seed)
    turn = np.asarray(Rotation.random(rng=rng).as_matrix())
    truth = transform_from_rotation(rng.uniform(-1, 1, 3), turn)
    # Corners of a box, so that no draw is nearly flat, moved about.
    corners = np.array([[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]] * 3, dtype=float)
    frame_m = 0.25 * (corners[:count] + rng.uniform(-0.4, 0.4, (count, 3)))
    base_m = truth.points(frame_m * scale)
    return Scene(truth, frame_m, base_m + rng.normal(size=base_m.shape) * noise_m)


def refusal(given: list[PointPair]) -> dict[str, str]:
    with pytest.raises(InvalidProblem) as raised:
        register_frame(given)
    return {fault.pointer: fault.detail for fault in raised.value.faults}


def codes(given: list[PointPair], reach_m: float | None = None) -> list[str]:
    return [row.code for row in register_frame(given, reach_m=reach_m).warnings]


@given(seeds, st.integers(3, 12))
def test_exact_points_give_the_pose_exactly(seed: int, count: int) -> None:
    it = scene(seed, count)
    found = register_frame(it.pairs)
    assert found.base_from_frame.position_m == pytest.approx(it.truth.position_m, abs=1e-12)
    assert found.base_from_frame.rotation == pytest.approx(it.truth.rotation, abs=1e-12)
    assert found.max_residual_m < 1e-12
    assert found.scale == pytest.approx(1, abs=1e-12)
    assert [row.code for row in found.warnings] == (["few_pairs"] if count == 3 else [])


@given(seeds, counts)
def test_order_of_pairs_does_not_matter(seed: int, count: int) -> None:
    it = scene(seed, count, NOISE_M)
    order = np.random.default_rng(seed).permutation(count)
    found, other = register_frame(it.pairs), register_frame([it.pairs[k] for k in order])
    assert other.base_from_frame.rotation == pytest.approx(found.base_from_frame.rotation, abs=1e-9)
    assert other.residuals_m == pytest.approx(found.residuals_m[order], abs=1e-9)
    assert {row.code for row in other.warnings} == {row.code for row in found.warnings}


@given(seeds, counts)
def test_exchanged_points_give_the_inverse_with_the_same_residuals(seed: int, count: int) -> None:
    """Why residuals cannot tell that the two were exchanged."""
    it = scene(seed, count, NOISE_M)
    found, other = register_frame(it.pairs), register_frame(pairs(it.base_m, it.frame_m))
    back = other.base_from_frame.inverse
    assert back.rotation == pytest.approx(found.base_from_frame.rotation, abs=1e-9)
    assert back.position_m == pytest.approx(found.base_from_frame.position_m, abs=1e-9)
    assert other.residuals_m == pytest.approx(found.residuals_m, abs=1e-9)


@pytest.mark.parametrize("count", [4, 6, 12])
def test_noise_comes_out_as_theory_says(count: int) -> None:
    """Residuals keep 3 n - 6 of 3 n degrees of freedom; the rotation is as sure as is told."""
    squares, turns, told = [], [], []
    for seed in range(400):
        it = scene(seed, count, NOISE_M)
        found = register_frame(it.pairs)
        assert found.rotation_std_rad is not None
        squares.append(np.sum(found.residuals_m**2))
        error = found.base_from_frame.rotation @ it.truth.rotation.T
        turns.append(np.sum(Rotation.from_matrix(error).as_rotvec() ** 2))
        told.append(found.rotation_std_rad**2)
    # 400 draws of at least six degrees of freedom: the mean is sure to 3 %.
    assert np.mean(squares) == pytest.approx((3 * count - 6) * NOISE_M**2, rel=0.12)
    # Told is the worst of the three axes.
    assert np.mean(told) < np.mean(turns) < 3.3 * np.mean(told)


@pytest.mark.parametrize("count", [4, 6, 12])
def test_honest_noise_is_rarely_warned_of(count: int) -> None:
    warned = sum(bool(codes(scene(seed, count, NOISE_M).pairs)) for seed in range(400))
    assert warned <= 4


@given(seeds, counts, st.sampled_from([0.97, 1.03, 0.001, 1000.0, 0.01, 0.0254, 0.3048]))
def test_scale_is_told(seed: int, count: int, scale: float) -> None:
    it = scene(seed, count, noise_m=0.0)
    found = register_frame(pairs(it.frame_m / min(scale, 1), it.base_m * max(scale, 1)))
    (detail,) = [row.detail for row in found.warnings if row.code == "scaled"]
    assert found.scale == pytest.approx(scale, rel=1e-9)
    named = {0.001: "frame_m seems to be millimetres", 1000.0: "base_m seems to be millimetres",
             0.01: "frame_m seems to be centimetres", 0.0254: "inches", 0.3048: "feet"}  # fmt: skip
    assert named.get(scale, "pose does not scale") in detail
    # The pose has none of it.
    assert np.linalg.det(found.base_from_frame.rotation) == pytest.approx(1)


@given(seeds, st.integers(6, 12), st.sampled_from([0.98, 1.02]))
def test_scale_is_told_in_noise_too(seed: int, count: int, scale: float) -> None:
    assert "scaled" in codes(scene(seed, count, NOISE_M, scale).pairs)


@given(seeds, st.integers(5, 12), st.integers(0, 2), st.sampled_from([1.0, 0.001]))
def test_mirror_images_are_refused(seed: int, count: int, axis: int, scale: float) -> None:
    it = scene(seed, count, NOISE_M)
    flipped = it.frame_m / scale
    flipped[:, axis] *= -1
    told = refusal(pairs(flipped, it.base_m))
    assert "mirror images" in told["#/pairs"]
    exchanged = it.frame_m[:, [1, 0, 2]]
    assert "mirror images" in refusal(pairs(exchanged, it.base_m))["#/pairs"]


@given(seeds, counts)
def test_flat_points_are_their_own_mirror_images(seed: int, count: int) -> None:
    """A board's corners: no rotation is wrong of them, and none is refused."""
    it = scene(seed, count)
    flat = it.frame_m * [1, 1, 0]
    noise = np.random.default_rng(seed).normal(size=flat.shape) * NOISE_M
    found = register_frame(pairs(flat, it.truth.points(flat) + noise))
    assert "mirrored" not in {row.code for row in found.warnings}
    error = found.base_from_frame.rotation @ it.truth.rotation.T
    assert Rotation.from_matrix(error).magnitude() < 0.05


@given(seeds, st.integers(3, 12), st.sampled_from([0.0, NOISE_M]))
def test_points_on_a_line_are_refused(seed: int, count: int, noise_m: float) -> None:
    rng = np.random.default_rng(seed)
    it = scene(seed, count)
    line = np.outer(np.linspace(-0.3, 0.3, count), [0.6, 0.0, 0.8]) + 0.1
    base = it.truth.points(line) + rng.normal(size=line.shape) * noise_m
    told = refusal(pairs(line, base))
    assert "on a line" in told["#/pairs"]
    assert "on a line" in refusal(pairs(base, line))["#/pairs"]


@given(seeds, st.integers(5, 12))
def test_points_on_a_line_but_for_their_noise_are_refused(seed: int, count: int) -> None:
    """The noise of both sets is larger than what the geometry alone would refuse."""
    rng = np.random.default_rng(seed)
    line = np.outer(np.linspace(-0.2, 0.2, count), [0.6, 0.0, 0.8])
    noisy = [line + rng.normal(size=line.shape) * 0.005 for _ in range(2)]
    assert refusal(pairs(*noisy)).keys() == {"#/pairs"}


@pytest.mark.parametrize("count", [0, 1, 2])
def test_two_pairs_are_too_few(count: int) -> None:
    assert "3 pairs" in refusal(scene(0, 4).pairs[:count])["#/pairs"]


def test_points_in_one_place_and_too_many_are_refused() -> None:
    it = scene(0, 4)
    told = refusal(pairs(it.frame_m * 1e-4, it.base_m))["#/pairs"]
    assert "one place" in told
    assert "more than" in refusal(it.pairs * (MOST_PAIRS // 4 + 1))["#/pairs"]


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e8])
def test_points_that_are_none_are_pointed_to(value: float) -> None:
    given = scene(0, 4).pairs
    given[2] = PointPair((0.1, value, 0.2), (0.1, 0.2))
    assert refusal(given).keys() == {"#/pairs/2/frame_m", "#/pairs/2/base_m"}


@given(seeds, st.integers(6, 12), st.floats(0.02, 0.2), seeds)
def test_a_wrong_pair_is_named(seed: int, count: int, off_m: float, which: int) -> None:
    it = scene(seed, count, NOISE_M)
    k = which % count
    it.base_m[k] += off_m * np.array([0.6, 0.0, 0.8])
    (told,) = [row for row in register_frame(it.pairs).warnings if row.code == "large_residual"]
    assert told.detail.startswith(f"pair {k} ")


def test_points_that_do_not_belong_together_are_refused() -> None:
    points = np.random.default_rng(1).uniform(-0.25, 0.25, (2, 8, 3))
    assert "same points" in refusal(pairs(*points))["#/pairs"]


@given(seeds, counts)
def test_exchanged_points_show_where_the_arm_does_not_reach(seed: int, count: int) -> None:
    it = scene(seed, count, NOISE_M)
    far = it.base_m / np.linalg.norm(it.base_m, axis=1).max()
    assume(np.linalg.norm(it.frame_m, axis=1).max() < 0.9)
    shift = np.array([3.0, 0.0, 0.0])
    # Base points within a metre, the camera three metres away from them.
    right = pairs(it.truth.inverse.points(far) + shift, far)
    wrong = [PointPair(pair.base_m, pair.frame_m) for pair in right]
    assert "inverted" not in codes(right, reach_m=1.01)
    assert "inverted" in codes(wrong, reach_m=1.01)
    assert "inverted" not in codes(wrong)


@given(seeds, st.integers(1, 12))
def test_a_true_pose_passes_its_check(seed: int, count: int) -> None:
    it = scene(seed, count, NOISE_M)
    found = check_frame(it.truth, it.pairs)
    assert found.warnings == ()
    assert found.max_residual_m < 10 * NOISE_M
    assert (found.scale is None) == (count < 3)


@given(seeds, st.integers(1, 12))
def test_an_inverted_pose_is_told(seed: int, count: int) -> None:
    it = scene(seed, count, NOISE_M)
    left = np.linalg.norm(it.truth.inverse.points(it.frame_m) - it.base_m, axis=1)
    assume(math.sqrt(np.mean(left**2)) > 0.05)
    (told,) = check_frame(it.truth.inverse, it.pairs).warnings
    assert told.code == "inverted"


@given(seeds, counts)
def test_scaled_and_mirrored_check_points_are_told(seed: int, count: int) -> None:
    it = scene(seed, count)
    found = check_frame(it.truth, pairs(it.frame_m * 1000, it.base_m))
    assert [row.code for row in found.warnings] == ["scaled", "large_residual"]
    found = check_frame(it.truth, pairs(it.frame_m * [1, 1, -1], it.base_m))
    assert [row.code for row in found.warnings] == ["mirrored", "large_residual"]


def test_a_pose_that_disagrees_is_told_with_what_would_agree() -> None:
    it = scene(0, 6, NOISE_M)
    moved = RigidTransform((0.0, 0.0, 0.0), it.truth.quaternion_xyzw)
    (told,) = check_frame(moved, it.pairs).warnings
    assert told.code == "large_residual"
    assert "a pose estimated from the pairs leaves" in told.detail
    with pytest.raises(InvalidProblem, match="check_pairs"):
        check_frame(moved, [])
