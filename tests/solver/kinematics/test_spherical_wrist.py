from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import Robot, UnsupportedKinematics, load_robot
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.spherical_wrist import BRANCHES, inverse_kinematics, wrist_geometry
from solver.robots.model import Array
from tests.solver.kinematics.arms import arms

TABLETOP = load_robot("tabletop")
LASER = TABLETOP.tools[0]


def turns_apart(a: Array, b: Array) -> Array:
    """Largest joint difference of postures, whole turns aside."""
    difference = np.abs(np.remainder(a - b + np.pi, 2 * np.pi) - np.pi)
    return np.asarray(difference.max(axis=-1))


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_every_branch_leads_back_and_one_is_the_seed(arm: Robot) -> None:
    q = np.random.default_rng(2).uniform(arm.lower, arm.upper, (5000, 6))
    tool = arm.tools[0]
    poses = forward_kinematics(arm, tool, q)
    found = inverse_kinematics(arm, tool, poses)
    errors = np.abs(forward_kinematics(arm, tool, found.joints) - poses[:, None]).max(axis=(2, 3))
    assert found.reachable.any(axis=1).all()
    assert errors[found.reachable].max() < 1e-9
    assert turns_apart(found.joints, q[:, None]).min(axis=1).max() < 1e-6


@given(
    q=st.tuples(
        *(st.floats(low, up) for low, up in zip(TABLETOP.lower, TABLETOP.upper, strict=True))
    )
)
def test_any_posture_is_found_again(q: tuple[float, ...]) -> None:
    """Over the whole joint space, edges included; where the wrist is straight, its pose is."""
    seed = np.array(q)
    pose = forward_kinematics(TABLETOP, LASER, seed)[None]
    found = inverse_kinematics(TABLETOP, LASER, pose)
    reached = forward_kinematics(TABLETOP, LASER, found.joints[0][found.reachable[0]])
    assert len(reached) >= 2
    np.testing.assert_allclose(reached, np.broadcast_to(pose, reached.shape), atol=1e-7)
    # Excluded shells: straight wrist, stretched arm, wrist centre over the waist. There a branch
    # meets another, and the digits that tell the seed are lost.
    wrist_centre = pose[0, :3, 3] - 0.104 * pose[0, :3, 2]
    regular = (
        abs(np.sin(seed[4])) > 1e-3
        and abs(np.sin(seed[2])) > 1e-3
        and np.hypot(*wrist_centre[:2]) > 1e-3
    )
    if regular:
        assert turns_apart(found.joints[0], seed).min() < 1e-6


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
@pytest.mark.parametrize("theta5", [0.0, np.pi])
def test_straight_wrist_keeps_the_pose_and_says_so(arm: Robot, theta5: float) -> None:
    q = np.random.default_rng(3).uniform(arm.lower, arm.upper, (500, 6))
    q[:, 4] = theta5
    tool = arm.tools[0]
    poses = forward_kinematics(arm, tool, q)
    found = inverse_kinematics(arm, tool, poses)
    errors = np.abs(forward_kinematics(arm, tool, found.joints) - poses[:, None]).max(axis=(2, 3))
    assert errors[found.reachable].max() < 1e-9
    straight = found.singular & found.reachable
    assert straight.any(axis=1).all()
    assert np.abs(found.joints[straight][:, 3]).max() == 0.0


def test_reach_is_told_apart_from_limits(tabletop: Robot) -> None:
    far = np.eye(4)
    far[:3, 3] = (2.0, 0.0, 0.1)
    behind = forward_kinematics(tabletop, LASER, np.array([np.pi, 0.3, -0.6, 0.1, 0.4, 0.2]))
    found = inverse_kinematics(tabletop, LASER, np.stack((far, behind)))
    assert not found.reachable[0].any()
    assert found.reach_margin_m[0].max() < -1.0
    assert found.reachable[1].any()
    outside = (found.joints[1] < tabletop.lower) | (found.joints[1] > tabletop.upper)
    assert outside.any(axis=1).all()


def test_branch_numbers_keep_their_meaning(tabletop: Robot) -> None:
    q = np.random.default_rng(4).uniform(tabletop.lower, tabletop.upper, (200, 6))
    found = inverse_kinematics(tabletop, LASER, forward_kinematics(tabletop, LASER, q))
    assert BRANCHES == 8
    for branch in range(BRANCHES):
        sines = np.sin(found.joints[:, branch, 4])
        assert (sines >= 0).all() if branch % 2 == 0 else (sines <= 0).all()


def test_other_wrists_are_refused_with_the_reason(tabletop: Robot) -> None:
    joints = (*tabletop.joints[:4], replace(tabletop.joints[4], d_m=0.05), tabletop.joints[5])
    with pytest.raises(UnsupportedKinematics, match="d5 is not zero"):
        wrist_geometry(replace(tabletop, joints=joints), LASER)
    with pytest.raises(UnsupportedKinematics, match="5 joints"):
        wrist_geometry(replace(tabletop, joints=tabletop.joints[:5]), LASER)
