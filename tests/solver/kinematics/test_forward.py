import numpy as np
import pytest

from solver import Robot, load_robot
from solver.kinematics.forward import forward_kinematics, jacobian
from tests.solver.kinematics.arms import arms, ur5

STEP_RAD = 1e-6


@pytest.mark.parametrize(
    "arm", [*arms(), load_robot("puma560_rail"), ur5()], ids=lambda arm: arm.name
)
def test_jacobian_agrees_with_central_differences(arm: Robot) -> None:
    q = np.random.default_rng(1).uniform(arm.lower, arm.upper, (50, len(arm.joints)))
    tool = arm.tools[0]
    found = jacobian(arm, tool, q)
    for i in range(len(arm.joints)):
        step = np.zeros(len(arm.joints))
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


def test_a_slide_moves_the_tool_along_its_axis_and_turns_nothing() -> None:
    robot = load_robot("puma560_rail")
    home = np.array(robot.home_joints)
    slid = home + np.array([0.4, 0, 0, 0, 0, 0, 0])
    here, there = forward_kinematics(robot, robot.tools[0], np.stack((home, slid)))
    np.testing.assert_allclose(there[:3, 3] - here[:3, 3], (0.0, 0.4, 0.0), atol=1e-12)
    np.testing.assert_array_equal(there[:3, :3], here[:3, :3])
    alone = load_robot("puma560")
    pose = forward_kinematics(alone, alone.tools[0], home[1:])
    np.testing.assert_allclose(here, pose, atol=1e-12)
