import numpy as np
import pytest

from solver import Robot, load_robot
from solver.approach.cut_in.line_behind import LineBehind
from solver.kinematics.families.on_rail import split_rail
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.spherical_wrist import inverse_kinematics
from tests.solver.kinematics.arms import ur5

RETREATS_M = np.linspace(0.03, 0.0, 7)


@pytest.mark.parametrize("name", ["tabletop", "puma560", "puma560_rail"])
def test_rows_lie_on_the_line_and_end_at_thinning(name: str) -> None:
    robot = load_robot(name)
    tool, q = robot.tools[0], np.asarray(robot.home_joints) + 0.1
    pose = forward_kinematics(robot, tool, q)
    line = LineBehind(robot, tool, q, _branch_of(robot, q))
    rows = line.rows(RETREATS_M)
    poses = forward_kinematics(robot, tool, rows)
    places = pose[:3, 3] - RETREATS_M[:, None] * pose[:3, 2]
    np.testing.assert_allclose(poses[:, :3, 3], places, atol=1e-9)
    np.testing.assert_allclose(poses[:, :3, :3] - pose[:3, :3], 0.0, atol=1e-9)
    np.testing.assert_array_equal(rows[-1], q)
    assert np.all(rows[:, :-6] == q[:-6]), "a rail stands still"
    assert np.all(line.reach(RETREATS_M) > 0.0)


def test_reach_says_nothing_of_an_arm_without_a_closed_form() -> None:
    robot = ur5()
    line = LineBehind(robot, robot.tools[0], robot.home_joints, None)
    assert np.all(line.reach(RETREATS_M) == np.inf)


def _branch_of(robot: Robot, q: np.ndarray) -> int:
    rail = split_rail(robot)
    arm = robot if rail is None else rail.arm_at(float(q[0]))
    own = q[-6:]
    found = inverse_kinematics(
        arm, robot.tools[0], forward_kinematics(arm, arm.tools[0], own)[None]
    )
    apart = np.abs(np.remainder(found.joints[0] - own + np.pi, 2 * np.pi) - np.pi).max(axis=1)
    return int(apart.argmin())
