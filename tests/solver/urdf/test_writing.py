"""URDF out and in again: the same poses, limits, masses and families."""

import math
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver import (
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
from solver.kinematics.families.registry import family_of
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
        assert family_of(again, mounted) is family_of(robot, tool)


@pytest.mark.parametrize("name", robot_names())
def test_what_was_converted_has_a_model_file(name: str) -> None:
    robot = load_robot(name)
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
