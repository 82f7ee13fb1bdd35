import numpy as np
import pytest

from solver import Robot
from solver.kinematics.forward import forward_kinematics, jacobian
from tests.solver.kinematics.arms import arms

STEP_RAD = 1e-6


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_jacobian_agrees_with_central_differences(arm: Robot) -> None:
    q = np.random.default_rng(1).uniform(arm.lower, arm.upper, (50, 6))
    tool = arm.tools[0]
    found = jacobian(arm, tool, q)
    for i in range(6):
        step = np.zeros(6)
        step[i] = STEP_RAD
        after, before = (forward_kinematics(arm, tool, q + sign * step) for sign in (1, -1))
        change = (after - before) / (2 * STEP_RAD)
        spin = change[:, :3, :3] @ np.swapaxes(forward_kinematics(arm, tool, q)[:, :3, :3], 1, 2)
        angular = np.stack((spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]), axis=1)
        np.testing.assert_allclose(found[:, :3, i], change[:, :3, 3], atol=1e-9)
        np.testing.assert_allclose(found[:, 3:, i], angular, atol=1e-8)


def test_pose_of_the_thesis_start(tabletop: Robot) -> None:
    """T's program, data set 3: start at (11.6, 0, 39.5) cm with axes -x, -y, z."""
    tool = tabletop.tool("laser")
    assert tool is not None
    pose = forward_kinematics(tabletop, tool, np.array(tabletop.home_joints))
    np.testing.assert_allclose(pose[:3, 3], (0.116, 0.0, 0.395), atol=1e-5)
    np.testing.assert_allclose(pose[:3, :3], np.diag((-1.0, -1.0, 1.0)), atol=1e-4)


def test_stretched_arm_is_the_zero_position(tabletop: Robot) -> None:
    """T figure 3.8: at zero the links lie along x, 0.114 m up."""
    tool = tabletop.tool("laser")
    assert tool is not None
    pose = forward_kinematics(tabletop, tool, np.zeros(6))
    length = 0.0135 + 0.1775 + 0.1025 + 0.104
    np.testing.assert_allclose(pose[:3, 3], (length, 0.0, 0.114), atol=1e-12)
