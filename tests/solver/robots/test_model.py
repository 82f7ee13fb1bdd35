import math
import pickle
from importlib import resources

import numpy as np
import pytest

from solver import Robot, load_robot
from solver.robots.files import parse_robot

DOCUMENT = (resources.files("solver.robots") / "tabletop.toml").read_text()
RAIL = (resources.files("solver.robots") / "puma560_rail.toml").read_text()


def test_table_top_arm_has_the_thesis_numbers(tabletop: Robot) -> None:
    """T tables 3.2 and 3.4; joint 3 ends at 60 degrees, where its servo does."""
    assert [math.degrees(value) for value in tabletop.upper] == pytest.approx(
        [135, 99, 60, 150, 91, 150]
    )
    assert [math.degrees(value) for value in tabletop.lower] == pytest.approx(
        [-135, -45, -99, -150, -91, -150]
    )
    assert [joint.a_m for joint in tabletop.joints] == [0.0135, 0.1775, 0, 0, 0, 0]
    assert [joint.d_m for joint in tabletop.joints] == [0.114, 0, 0, 0.1025, 0, 0.064]
    lengths = {tool.name: 0.064 + tool.length_m for tool in tabletop.tools}
    assert lengths == pytest.approx({"laser": 0.104, "scaffold": 0.124})


def test_limits_cannot_be_written_to(tabletop: Robot) -> None:
    with pytest.raises(ValueError, match="read-only"):
        tabletop.lower[0] = 0.0


def test_a_margin_draws_in_what_turns_and_leaves_what_slides(tabletop: Robot) -> None:
    lower, upper = tabletop.limits_within(0.1)
    np.testing.assert_array_equal(lower, tabletop.lower + 0.1)
    np.testing.assert_array_equal(upper, tabletop.upper - 0.1)
    rail = load_robot("puma560_rail")
    lower, upper = rail.limits_within(0.1)
    assert (lower[0], upper[0]) == (rail.lower[0], rail.upper[0])
    np.testing.assert_array_equal(lower[1:], rail.lower[1:] + 0.1)


def test_the_limit_margin_is_of_angles_only() -> None:
    robot = load_robot("puma560_rail")
    at_the_end = np.array([0.6, *robot.home_joints[1:]])
    assert robot.limit_margin(at_the_end) == robot.limit_margin(np.array(robot.home_joints)) > 0


def test_the_reach_bound_counts_slide_and_mount() -> None:
    robot, alone = load_robot("puma560_rail"), load_robot("puma560")
    tool = robot.tools[0]
    assert robot.reach_m(tool) == pytest.approx(alone.reach_m(tool) + 0.6)
    moved = parse_robot(b"mount_position_m = [3.0, 0.0, 4.0]\n" + DOCUMENT.encode())
    assert moved.reach_m(tool) == pytest.approx(load_robot("tabletop").reach_m(tool) + 5.0)


def test_a_robot_passes_between_processes() -> None:
    robot = load_robot("puma560_rail")
    assert robot.lower is robot.lower
    again = pickle.loads(pickle.dumps(robot))
    assert again == robot
    assert hash(again) == hash(robot)
