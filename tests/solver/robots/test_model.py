import math
from importlib import resources

import pytest

from solver import InvalidRobot, Robot, UnknownRobot, load_robot, robot_names
from solver.robots.model import parse_robot

DOCUMENT = (resources.files("solver.robots") / "tabletop.toml").read_text()


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
    ],
)
def test_broken_model_files_are_refused(old: str, new: str, message: str) -> None:
    assert old in DOCUMENT
    with pytest.raises(InvalidRobot, match=message):
        parse_robot(DOCUMENT.replace(old, new, 1).encode())
