"""The verifier's formulas of how a tool stands to a target, against those of the methods."""

import numpy as np
import pytest

from solver.approach.task.frame import approach_frame
from solver.approach.task.relaxation import placement, rotation, shortened
from solver.verification.placement import least_rotation, seen_from


@pytest.mark.parametrize("seed", range(200))
def test_poses_are_taken_apart_as_the_methods_do(seed: int) -> None:
    rng = np.random.default_rng(seed)
    position, branch = rng.uniform(-1.0, 1.0, (2, 3))
    side = 1 if seed % 2 else -1
    frame = approach_frame(position.tolist(), branch.tolist())
    lean = rng.normal(size=3)
    lean -= (lean @ frame.branch) * frame.branch
    lean *= rng.choice([0.0, 1e-9, 1e-3, 0.3, 1.5]) / np.linalg.norm(lean)
    angle, strike = rng.uniform(-np.pi, np.pi), rng.uniform(-0.1, 0.1)
    pose = np.eye(4)
    pose[:3, :3] = rotation(lean) @ frame.axes(angle, side)
    pose[:3, 3] = position + strike * pose[:3, 2]
    known, seen = (
        placement(frame, position, side, pose),
        seen_from(position, frame.branch, side, pose),
    )
    assert seen.strike_m == pytest.approx(known.strike_m, abs=1e-14)
    assert seen.tilt_rad == pytest.approx(known.tilt_rad, abs=1e-14)
    upright = frame.axes(angle, side)
    for most in (0.0, 0.1, 2.0):
        expected = rotation(shortened(known.swing_rad, most)) @ upright
        assert seen.leaning(upright, most) == pytest.approx(expected, abs=1e-13)


def test_a_tool_the_wrong_way_round_leans_nowhere() -> None:
    """So that its axes are told as wrong, by half a turn."""
    pose = np.diag([-1.0, -1.0, 1.0, 1.0])
    seen = seen_from(np.zeros(3), np.array([0.0, 1.0, 0.0]), 1, pose)
    assert seen.tilt_rad == pytest.approx(np.pi)
    assert seen.leaning(np.eye(3), 0.0) == pytest.approx(np.eye(3))


@pytest.mark.parametrize("seed", range(20))
def test_the_smallest_rotation_is_one_about_what_is_across(seed: int) -> None:
    rng = np.random.default_rng(seed)
    start, end = (one / np.linalg.norm(one) for one in rng.normal(size=(2, 3)))
    turned = least_rotation(start, end, np.eye(3))
    assert turned @ turned.T == pytest.approx(np.eye(3), abs=1e-13)
    assert np.linalg.det(turned) == pytest.approx(1.0)
    assert turned @ start == pytest.approx(end, abs=1e-13)
    assert turned @ np.cross(start, end) == pytest.approx(np.cross(start, end), abs=1e-13)
