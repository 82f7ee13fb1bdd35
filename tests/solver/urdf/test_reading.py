"""URDF in: what it means, and refusals that say what is wrong."""

import math

import numpy as np
import pytest

from solver import (
    InvalidRobot,
    Robot,
    robot_from_urdf,
)
from solver.kinematics.forward import forward_kinematics

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
