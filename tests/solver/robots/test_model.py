import math
import pickle
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from solver import InvalidRobot, Robot, UnknownRobot, load_robot, robot_names
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


def test_every_shipped_robot_loads_and_is_hashable() -> None:
    assert "tabletop" in robot_names()
    for name in robot_names():
        assert load_robot(name).name == name
        assert hash(load_robot(name)) == hash(load_robot(name))


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


def test_unknown_robot_names_the_known_ones() -> None:
    with pytest.raises(UnknownRobot, match="tabletop") as raised:
        load_robot("../tabletop")
    assert raised.value.name == "../tabletop"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name = "tabletop"', "name = ", "cannot be read"),
        ("lower_deg = -135.0\n", "", "lower_rad"),
        ("lower_deg = -135.0", "lower_deg = 140.0", "out of order"),
        ("velocity_rad_s = 2.0", "velocity_rad_s = 0.0", "speed limits"),
        ("velocity_rad_s = 2.0", "velocity_rad_s = 2.0\ncolour = 1", "colour"),
        ('default_tool = "laser"', 'default_tool = "saw"', "saw"),
        ("home_joints = [0.0, 1.57", "home_joints = [0.0, 3.57", "home is outside"),
        ("home_joints = [0.0, ", "home_joints = [", "needs 6 values"),
        ('name = "joint_2"', 'name = "joint_1"', "two joints have one name"),
        ("a_m = 0.0135", "a_m = inf", "not finite"),
        ("mass_kg = 0.35", "mass_kg = -0.35", "mass below zero"),
        ('servo = "RX-64"', 'kind = "spherical"', "spherical"),
        ('servo = "RX-64"', 'kind = "prismatic"', "lower_m"),
        ("drive_inertia_kg_m2 = 8.0e-3", "drive_mass_kg = 8.0e-3", "drive_mass_kg"),
        ("centre_m = [0.0, 0.0, 0.0]", "centre_m = [0.0, 0.0]", "cannot be read"),
    ],
)
def test_broken_model_files_are_refused(old: str, new: str, message: str) -> None:
    assert old in DOCUMENT
    with pytest.raises(InvalidRobot, match=message):
        parse_robot(DOCUMENT.replace(old, new, 1).encode())


def test_a_prismatic_joint_has_metres() -> None:
    robot = load_robot("puma560_rail")
    rail = robot.joints[0]
    assert (rail.kind, rail.unit, rail.lower, rail.upper) == ("prismatic", "m", -0.6, 0.6)
    assert (rail.velocity, rail.acceleration, rail.servo) == (0.5, 1.0, None)
    assert robot.turning.tolist() == [0, 1, 1, 1, 1, 1, 1]
    np.testing.assert_allclose(robot.mount[:3, 2], (0.0, 1.0, 0.0), atol=0)
    with pytest.raises(InvalidRobot, match="lower_m"):
        parse_robot(RAIL.replace("lower_m = -0.6", "lower_rad = -0.6").encode())


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


def test_own_model_files_by_path_and_by_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    document = DOCUMENT.replace('name = "tabletop"', 'name = "mine"')
    (tmp_path / "mine.toml").write_text(document)
    assert load_robot(tmp_path / "mine.toml").name == "mine"
    assert "mine" not in robot_names()
    monkeypatch.setenv("PRUNUS_ROBOTS_DIR", str(tmp_path))
    assert {"mine", "tabletop"} < set(robot_names())
    assert load_robot("mine").name == "mine"
    (tmp_path / "other.toml").write_text(document)
    with pytest.raises(InvalidRobot, match="named 'mine'"):
        load_robot("other")
    (tmp_path / "tabletop.toml").write_text(document)
    with pytest.raises(InvalidRobot, match="tabletop"):
        robot_names()
    monkeypatch.setenv("PRUNUS_ROBOTS_DIR", str(tmp_path / "nowhere"))
    with pytest.raises(InvalidRobot, match="PRUNUS_ROBOTS_DIR"):
        robot_names()
