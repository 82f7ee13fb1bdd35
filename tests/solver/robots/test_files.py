from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from solver import InvalidRobot, UnknownRobot, load_robot, robot_names
from solver.robots.files import parse_robot

DOCUMENT = (resources.files("solver.robots") / "tabletop.toml").read_text()
RAIL = (resources.files("solver.robots") / "puma560_rail.toml").read_text()


def test_every_shipped_robot_loads_and_is_hashable() -> None:
    assert "tabletop" in robot_names()
    for name in robot_names():
        assert load_robot(name).name == name
        assert hash(load_robot(name)) == hash(load_robot(name))


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
        ("radius_m = 0.033", "radius_m = 0.0", "joint_1 has a shape without a size"),
        ("gap_m = 0.03", "gap_m = -0.03", "tool scaffold has a shape without a size"),
        ("size_m = [0.8, 0.8, 0.8]", "size_m = [0.8, 0.0, 0.8]", "table has a shape without"),
        ("size_m = [0.8, 0.8, 0.8]", "size_m = [0.8, 0.8]", "cannot be read"),
        ("start_m = [0.0, 0.0, -0.03]", "start_m = [0.0, 0.0]", "cannot be read"),
        ('name = "base"', 'name = "joint_2"', "have one name"),
        ('["table", "joint_2"]', '["table", "joint_9"]', "no two that move"),
        ('["table", "joint_2"]', '["table", "base"]', "no two that move"),
        ('["table", "joint_2"]', '["joint_2", "joint_2"]', "no two that move"),
        ('["table", "joint_2"]', '["joint_2"]', "cannot be read"),
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
