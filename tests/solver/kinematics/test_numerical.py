import numpy as np
import pytest

from solver import Robot, load_robot
from solver.approach.cut_in.cut_in import retreat_rows
from solver.kinematics import numerical
from solver.kinematics.forward import forward_kinematics, jacobian
from solver.kinematics.numerical import chain_of, postures_behind
from solver.kinematics.spherical_wrist import inverse_kinematics
from tests.solver.kinematics.arms import seven_joints, ur5

ROBOTS = [load_robot("puma560_rail"), ur5(), seven_joints()]


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_kernels_agree_with_the_plain_forward_kinematics(robot: Robot) -> None:
    tool, n = robot.tools[0], len(robot.joints)
    chain = chain_of(robot, tool)
    for q in np.random.default_rng(7).uniform(robot.lower, robot.upper, (20, n)):
        frames, columns = np.empty((n + 1, 4, 4)), np.empty((6, n))
        numerical.locate(chain, q, frames)
        numerical.fill_jacobian(chain, frames, columns)
        np.testing.assert_allclose(frames[-1], forward_kinematics(robot, tool, q), atol=1e-12)
        np.testing.assert_allclose(columns, jacobian(robot, tool, q), atol=1e-12)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_newton_comes_back_to_twelve_digits(robot: Robot) -> None:
    tool = robot.tools[0]
    chain = chain_of(robot, tool)
    rng = np.random.default_rng(8)
    came_back = 0
    for q in rng.uniform(0.8 * robot.lower, 0.8 * robot.upper, (50, len(robot.joints))):
        pose = forward_kinematics(robot, tool, q)
        near = q + rng.uniform(-0.02, 0.02, len(q))
        axes = np.ascontiguousarray(pose[:3, :3])
        left = numerical.polish(chain, pose[:3, 3].copy(), axes, np.ones(len(q)), near)
        reached = np.abs(forward_kinematics(robot, tool, near) - pose).max()
        assert (left < 1e-11) == (reached < 1e-11)  # it does not believe itself to be elsewhere
        came_back += left < 1e-12
    assert came_back >= 45  # the others begin next to a singularity


def test_the_error_is_the_whole_rotation_left() -> None:
    """Half a turn away a sum of cross products would be zero; the rotation vector is not."""
    error = np.empty(6)
    turned = np.eye(4)
    turned[:3, :3] = [[np.cos(3.0), -np.sin(3.0), 0], [np.sin(3.0), np.cos(3.0), 0], [0, 0, 1]]
    size = numerical.pose_error(turned, np.zeros(3), np.eye(3), error)
    assert size == pytest.approx(3.0)
    np.testing.assert_allclose(error, (0, 0, 0, 0, 0, -3.0), atol=1e-12)


def test_continuation_finds_the_branch_that_the_closed_form_has() -> None:
    robot = load_robot("puma560")
    tool = robot.tools[0]
    retreats = np.linspace(0.04, 0.0, 20)
    rng = np.random.default_rng(9)
    compared = 0
    for q in rng.uniform(0.8 * robot.lower, 0.8 * robot.upper, (60, 6)):
        found = inverse_kinematics(robot, tool, forward_kinematics(robot, tool, q)[None])
        apart = np.abs(np.remainder(found.joints[0] - q + np.pi, 2 * np.pi) - np.pi).max(axis=1)
        exact = retreat_rows(robot, tool, q, int(apart.argmin()), retreats)
        if np.abs(np.diff(exact, axis=0)).max() > 0.05:
            continue  # next to a singularity, where neighbours are far apart
        np.testing.assert_allclose(postures_behind(robot, tool, q, retreats), exact, atol=1e-8)
        compared += 1
    assert compared >= 40
