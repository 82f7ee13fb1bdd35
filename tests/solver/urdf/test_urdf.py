"""URDF in and out: the same poses, limits and masses, and refusals that say what is wrong."""

import math
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver import (
    InvalidRobot,
    Joint,
    Link,
    Robot,
    Tool,
    load_robot,
    parse_robot,
    robot_from_urdf,
    robot_names,
    robot_to_toml,
    robot_to_urdf,
)
from solver.kinematics.dynamics import joint_loads
from solver.kinematics.families import has_closed_form, rail_of
from solver.kinematics.forward import forward_kinematics
from solver.urdf.writing import BASE_LINK, TIP_LINK
from tests.solver.kinematics.arms import arms, seven_joints, ur5

# lengths and angles as people build them: exactly none, right, or anything
lengths = st.one_of(st.just(0.0), st.floats(-0.6, 0.6).filter(lambda x: abs(x) > 1e-3))
angles = st.one_of(
    st.sampled_from([0.0, math.pi / 2, -math.pi / 2, math.pi]),
    st.floats(-3.0, 3.0).filter(lambda x: abs(x) > 1e-3),
)
triples = st.tuples(lengths, lengths, lengths)
links = st.builds(
    Link,
    mass_kg=st.floats(0.1, 5.0),
    centre_m=triples,
    inertia_kg_m2=st.tuples(*[st.floats(0.01, 0.1)] * 3, *[st.floats(-0.005, 0.005)] * 3),
)


@st.composite
def robots(draw: st.DrawFn) -> Robot:
    count = draw(st.integers(1, 7))
    joints = tuple(
        Joint(
            name=f"joint_{i}",
            a_m=draw(lengths),
            alpha_rad=draw(angles),
            d_m=draw(lengths),
            offset_rad=draw(angles),
            lower=-draw(st.floats(0.1, 3.0)),
            upper=draw(st.floats(0.1, 3.0)),
            velocity=draw(st.floats(0.1, 3.0)),
            acceleration=3.0,
            kind=draw(st.sampled_from(["revolute", "revolute", "prismatic"])),
            link=draw(links),
        )
        for i in range(count)
    )
    return Robot(
        name="drawn",
        description="",
        source="",
        joints=joints,
        tools=(Tool("tool", 0.1, "", draw(st.floats(0.0, 0.5))),),
        default_tool="tool",
        home_joints=(0.0,) * count,
        version="",
        mount_position_m=draw(triples),
        mount_rpy_rad=draw(st.tuples(angles, st.floats(-1.5, 1.5), angles)),
        flange_roll_rad=draw(angles),
    )


def there_and_back(robot: Robot, tool: Tool) -> Robot:
    document = robot_to_urdf(robot, tool)
    return robot_from_urdf(
        document, BASE_LINK, TIP_LINK, acceleration_rad_s2=3.0, acceleration_m_s2=3.0
    )


def assert_same_arm(one: Robot, tool: Tool, other: Robot) -> None:
    q = np.random.default_rng(41).uniform(one.lower, one.upper, (20, len(one.joints)))
    poses = forward_kinematics(one, tool, q)
    np.testing.assert_allclose(forward_kinematics(other, other.tools[0], q), poses, atol=1e-7)
    assert other.joint_names == one.joint_names
    assert [joint.kind for joint in other.joints] == [joint.kind for joint in one.joints]
    for name in ("lower", "upper", "velocity"):
        np.testing.assert_array_equal(getattr(other, name), getattr(one, name))
    if one.has_masses:
        bare = [replace(j, link=replace(j.link, drive_inertia=0.0)) for j in one.joints if j.link]
        ours = joint_loads(replace(one, joints=tuple(bare)), tool, q)
        theirs = joint_loads(other, other.tools[0], q)
        np.testing.assert_allclose(theirs.gravity, ours.gravity, atol=1e-5)
        np.testing.assert_allclose(theirs.inertia, ours.inertia, atol=1e-5)


@given(robot=robots())
@settings(max_examples=60)
def test_any_chain_comes_back_as_the_same_arm(robot: Robot) -> None:
    """Axes that are one, parallel, meeting and skew; tools turned about them."""
    tool = robot.tools[0]
    assert_same_arm(robot, tool, there_and_back(robot, tool))


@pytest.mark.parametrize("robot", [*arms(), load_robot("puma560_rail"), ur5(), seven_joints()])
def test_known_arms_keep_their_family(robot: Robot) -> None:
    for tool in robot.tools:
        again = there_and_back(robot, tool)
        assert_same_arm(robot, tool, again)
        mounted = again.tools[0]
        assert has_closed_form(again, mounted) == has_closed_form(robot, tool)
        assert (rail_of(again, mounted) is None) == (rail_of(robot, tool) is None)


@pytest.mark.parametrize("name", robot_names())
def test_a_model_file_is_written_as_it_was_read(name: str) -> None:
    robot = load_robot(name)
    again = parse_robot(robot_to_toml(robot))
    assert replace(again, version=robot.version) == robot
    imported = there_and_back(robot, robot.tools[0])
    assert parse_robot(robot_to_toml(imported)) == imported


def test_the_file_can_be_looked_at() -> None:
    """Every link hangs on one joint, and every length of the arm is a cylinder."""
    robot = load_robot("puma560")
    root = ET.fromstring(robot_to_urdf(robot, robot.tools[0]))
    names = [link.get("name") for link in root.findall("link")]
    children = [child.get("link") for child in root.iter("child")]
    assert sorted(names) == sorted([BASE_LINK, *children])  # type: ignore[type-var]
    drawn = sorted(float(cylinder.get("length", "nan")) for cylinder in root.iter("cylinder"))
    wanted = sorted((0.67183, 0.4318, 0.15005, 0.0203, 0.4318, 0.05625, 0.12))
    assert drawn == pytest.approx(wanted)


TWO_LINKS = """<?xml version="1.0"?>
<robot name="two">
  <link name="world"/>
  <joint name="stand" type="fixed">
    <parent link="world"/><child link="base"/><origin xyz="0 0 0.5" rpy="0 0 0"/>
  </joint>
  <link name="base"/>
  <joint name="shoulder" type="continuous">
    <parent link="base"/><child link="arm"/><origin rpy="1.5708 0 0"/>
    <axis xyz="0 0 2"/><limit velocity="1.5" effort="1"/>
  </joint>
  <link name="arm">
    <inertial><origin xyz="0.1 0 0"/><mass value="2"/><inertia ixx="0.01" iyy="0.02" izz="0.03"/>
    </inertial>
  </link>
  <joint name="plate" type="fixed">
    <parent link="arm"/><child link="camera"/><origin xyz="0.4 0 0"/>
  </joint>
  <link name="camera"><inertial><mass value="1"/><inertia/></inertial></link>
  <joint name="elbow" type="revolute">
    <parent link="arm"/><child link="hand"/><origin xyz="0.3 0 0"/>
    <axis xyz="0 0 1"/><limit lower="0.5" upper="2" velocity="1" effort="1"/>
  </joint>
  <link name="hand"><inertial><mass value="0.5"/><inertia/></inertial></link>
  <joint name="tool" type="fixed">
    <parent link="hand"/><child link="tip"/><origin xyz="0.2 0 0" rpy="0 1.5708 0"/>
  </joint>
  <link name="tip"/>
</robot>
"""


def read(document: str, base: str = "world", tip: str = "hand") -> Robot:
    return robot_from_urdf(document.encode(), base, tip, acceleration_rad_s2=4.0)


def test_fixed_joints_fold_and_rounded_angles_are_what_they_mean() -> None:
    robot = read(TWO_LINKS)
    assert robot.mount_position_m == (0.0, 0.0, 0.5)
    assert robot.mount_rpy_rad == (math.pi / 2, 0.0, 0.0)
    assert [joint.a_m for joint in robot.joints] == pytest.approx([0.3, 0.0])
    assert (robot.joints[0].lower, robot.joints[0].upper) == (-math.pi, math.pi)
    assert robot.home_joints == (0.0, 1.25)  # zero is outside the elbow's limits
    assert robot.joints[0].acceleration == 4.0
    carried = robot.joints[0].link
    assert carried is not None
    assert carried.mass_kg == 3.0
    # 2 kg at 0.1 m and 1 kg at 0.4 m from the shoulder; the frame stands at the elbow, 0.3 m out.
    assert carried.centre_m == pytest.approx((0.2 - 0.3, 0.0, 0.0))
    assert carried.inertia_kg_m2[2] == pytest.approx(0.03 + 2 * 0.1**2 + 1 * 0.2**2)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("<robot", "<!DOCTYPE robot [<!ENTITY a 'b'>]><robot", "DTDForbidden"),
        ('<robot name="two">', "<robot", "cannot be read"),
        ('type="continuous"', 'type="floating"', "floating"),
        ('<limit velocity="1.5" effort="1"/>', "", "velocity limit"),
        ('lower="0.5" ', "", "position limits"),
        ('lower="0.5"', 'lower="2.5"', "out of order"),
        ('velocity="1.5"', 'velocity="0"', "speed limits"),
        ('velocity="1.5"', 'velocity="fast"', "'fast' where a number"),
        ('<axis xyz="0 0 2"/>', '<axis xyz="0 0 0"/>', "without a direction"),
        ('<axis xyz="0 0 2"/>', '<axis xyz="0 0"/>', "three numbers"),
        ('<axis xyz="0 0 2"/>', '<mimic joint="elbow"/>', "mimics"),
        ('<child link="hand"/>', '<child link="elsewhere"/>', "no chain of joints"),
        ('<mass value="0.5"/>', "", "without mass"),
    ],
)
def test_broken_files_are_refused_with_the_reason(old: str, new: str, message: str) -> None:
    document = TWO_LINKS.removeprefix('<?xml version="1.0"?>\n')
    assert old in document
    with pytest.raises(InvalidRobot, match=message):
        read(document.replace(old, new, 1))


def test_entities_are_refused_in_every_encoding() -> None:
    bomb = '<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><robot name="&b;"/>'
    for encoding in ("utf-8", "utf-16"):
        with pytest.raises(InvalidRobot, match="Forbidden"):
            robot_from_urdf(bomb.encode(encoding), "a", "b", acceleration_rad_s2=1.0)


def test_chains_in_circles_end() -> None:
    circle = TWO_LINKS.replace('<child link="base"/>', '<child link="arm"/>').replace(
        '<parent link="world"/>', '<parent link="hand"/>'
    )
    with pytest.raises(InvalidRobot, match="no chain"):
        read(circle)


def test_a_bent_and_turned_tool_keeps_its_y_axis() -> None:
    """Four numbers a row cannot hold it: the flange's roll does. y goes along the branch."""
    turned = TWO_LINKS.replace(
        '<link name="tip"/>',
        '<link name="tip"/><joint name="turn" type="fixed"><parent link="tip"/>'
        '<child link="turned"/><origin rpy="0 0 0.3"/></joint><link name="turned"/>',
    )
    robot = read(turned, tip="turned")
    assert robot.flange_roll_rad != 0.0
    assert robot.tools[0].length_m == pytest.approx(0.2)
    pose = forward_kinematics(robot, robot.tools[0], np.zeros(2))
    # By hand: the plane of the arm stands upright, x is outwards, and the tool looks along it.
    np.testing.assert_allclose(pose[:3, 3], (0.5, 0.0, 0.5), atol=1e-12)
    np.testing.assert_allclose(pose[:3, 2], (1.0, 0.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(pose[:3, 1], (0.0, -math.sin(0.3), math.cos(0.3)), atol=1e-12)


def test_without_all_masses_there_are_none() -> None:
    robot = read(TWO_LINKS.replace('<inertial><mass value="0.5"/><inertia/></inertial>', ""))
    assert not any(joint.link for joint in robot.joints)
    assert robot.mass_source == ""
