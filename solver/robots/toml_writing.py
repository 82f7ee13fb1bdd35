"""A robot as the text of a model file, which `parse_robot` reads back to the same numbers."""

import hashlib
import json
import math
from collections.abc import Iterable, Iterator
from dataclasses import asdict, replace

from solver.robots.model import REVOLUTE, Joint, Robot
from solver.robots.shapes import Capsule

_BY_KIND = {
    "revolute": (
        "lower_rad",
        "upper_rad",
        "velocity_rad_s",
        "acceleration_rad_s2",
        "drive_inertia_kg_m2",
    ),
    "prismatic": ("lower_m", "upper_m", "velocity_m_s", "acceleration_m_s2", "drive_mass_kg"),
}


def robot_to_toml(robot: Robot) -> bytes:
    """The model file of a robot. Angles are in radians, so that no digit is lost."""
    return ("\n".join(_lines(robot)) + "\n").encode()


def with_version(robot: Robot) -> Robot:
    """The robot with the version that its model file has."""
    return replace(robot, version=hashlib.sha256(robot_to_toml(robot)).hexdigest()[:12])


def _lines(robot: Robot) -> Iterator[str]:
    for key in ("name", "description", "source"):
        yield f"{key} = {_text(getattr(robot, key))}"
    yield f"home_joints = {_numbers(robot.home_joints)}"
    yield f"default_tool = {_text(robot.default_tool)}"
    if robot.mass_source:
        yield f"mass_source = {_text(robot.mass_source)}"
    if any(robot.mount_position_m):
        yield f"mount_position_m = {_numbers(robot.mount_position_m)}"
    if any(robot.mount_rpy_rad):
        yield f"mount_rpy_rad = {_numbers(robot.mount_rpy_rad)}"
    if robot.flange_roll_rad:
        yield f"flange_roll_rad = {_number(robot.flange_roll_rad)}"
    if robot.body_source:
        yield f"body_source = {_text(robot.body_source)}"
    if robot.kept_apart:
        pairs = (f"[{_text(one)}, {_text(other)}]" for one, other in robot.kept_apart)
        yield f"kept_apart = [{', '.join(pairs)}]"
    for fixture in robot.fixtures:
        yield from ("", "[[fixtures]]", f"name = {_text(fixture.name)}")
        yield from _capsule_lines("fixtures.capsules", fixture.capsules)
        for box in fixture.boxes:
            yield from ("", "[[fixtures.boxes]]", f"position_m = {_numbers(box.position_m)}")
            yield f"size_m = {_numbers(box.size_m)}"
            yield f"quaternion_xyzw = {_numbers(box.quaternion_xyzw)}"
    for tool in robot.tools:
        yield from (
            "",
            "[[tools]]",
            f"name = {_text(tool.name)}",
            f"length_m = {_number(tool.length_m)}",
        )
        yield f"description = {_text(tool.description)}"
        if tool.mass_kg:
            yield f"mass_kg = {_number(tool.mass_kg)}"
        yield from _capsule_lines("tools.body", tool.body)
        if (forks := tool.forks) is not None:
            yield from ("", "[tools.forks]")
            yield from (f"{key} = {_number(value)}" for key, value in asdict(forks).items())
    for joint in robot.joints:
        yield from _joint_lines(joint)


def _capsule_lines(table: str, capsules: Iterable[Capsule]) -> Iterator[str]:
    for capsule in capsules:
        yield from ("", f"[[{table}]]", f"start_m = {_numbers(capsule.start_m)}")
        yield f"end_m = {_numbers(capsule.end_m)}"
        yield f"radius_m = {_number(capsule.radius_m)}"


def _joint_lines(joint: Joint) -> Iterator[str]:
    lower, upper, velocity, acceleration, drive = _BY_KIND[joint.kind]
    yield from ("", "[[joints]]", f"name = {_text(joint.name)}")
    if joint.kind != REVOLUTE:
        yield f"kind = {_text(joint.kind)}"
    if joint.servo is not None:
        yield f"servo = {_text(joint.servo)}"
    yield f"a_m = {_number(joint.a_m)}"
    yield f"alpha_rad = {_number(joint.alpha_rad)}{_degrees(joint.alpha_rad)}"
    yield f"d_m = {_number(joint.d_m)}"
    yield f"offset_rad = {_number(joint.offset_rad)}{_degrees(joint.offset_rad)}"
    yield f"{lower} = {_number(joint.lower)}"
    yield f"{upper} = {_number(joint.upper)}"
    yield f"{velocity} = {_number(joint.velocity)}"
    yield f"{acceleration} = {_number(joint.acceleration)}"
    if joint.link is not None:
        yield from ("", "[joints.link]", f"mass_kg = {_number(joint.link.mass_kg)}")
        yield f"centre_m = {_numbers(joint.link.centre_m)}"
        yield f"inertia_kg_m2 = {_numbers(joint.link.inertia_kg_m2)}"
        yield f"{drive} = {_number(joint.link.drive_inertia)}"
    yield from _capsule_lines("joints.body", joint.body)


def _text(value: str) -> str:
    # JSON's escapes are those of a TOML basic string, but for a bare DEL.
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _number(value: float) -> str:
    return repr(float(value))


def _numbers(values: tuple[float, ...]) -> str:
    return f"[{', '.join(map(_number, values))}]"


def _degrees(angle: float) -> str:
    return f"  # {math.degrees(angle):.6g} degrees" if angle else ""
