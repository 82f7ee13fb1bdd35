"""A robot as a URDF file, with plain cylinders to look at, for other people's tools.

Link i of the file stands in joint i's frame, whose z axis is the joint's; the joint's origin is the
rest of the Denavit-Hartenberg row before it. The tool is a link of its own at the tool centre
point.
"""

import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import Final

import numpy as np

from solver.kinematics.dynamics import link_tensor
from solver.robots.model import REVOLUTE, Array, Joint, Link, Robot, Tool
from solver.robots.rigid import link_transform, roll_pitch_yaw, transform
from solver.urdf.tolerances import URDF_SHORTEST_M

BASE_LINK: Final = "base_link"
TIP_LINK: Final = "tool_centre_point"

_THICKNESS: Final = 0.08
"""Radius of the cylinders as a share of the longest one: slender, and no joint out of sight."""


def robot_to_urdf(robot: Robot, tool: Tool) -> bytes:
    """The file for an arm with a tool.

    URDF has no place for accelerations, drive inertias and home; they are left out. It wants an
    effort limit, which the model does not have: 0, which means none is known.
    """
    root = ET.Element("robot", name=robot.name)
    lengths = [max(abs(j.a_m), abs(j.d_m)) for j in robot.joints]
    radius = _THICKNESS * max(*lengths, tool.length_m, URDF_SHORTEST_M)
    parent, origin = _link(root, BASE_LINK), robot.mount
    _cylinder(parent, np.zeros(3), origin[:3, 3], radius)
    parent_name = BASE_LINK
    for joint in robot.joints:
        name = f"{joint.name}_link"
        _moving(root, joint, parent_name, name, origin)
        element = _link(root, name)
        rest = link_transform(joint.a_m, joint.alpha_rad, joint.d_m, joint.offset_rad)
        if joint is robot.joints[-1]:
            rest = rest @ transform((0.0, 0.0, 0.0), (0.0, 0.0, robot.flange_roll_rad))
        elbow = np.array([0.0, 0.0, joint.d_m])
        _cylinder(element, np.zeros(3), elbow, radius)
        _cylinder(element, elbow, rest[:3, 3], radius)
        if joint.link is not None:
            _inertial(element, joint.link, rest)
        parent_name, origin = name, rest
    _fixed(root, parent_name, TIP_LINK, origin @ transform((0.0, 0.0, tool.length_m), (0, 0, 0)))
    tip = _link(root, TIP_LINK)
    _cylinder(tip, np.array([0.0, 0.0, -tool.length_m]), np.zeros(3), radius / 2)
    if tool.mass_kg > 0:
        middle = replace(_MASSLESS, mass_kg=tool.mass_kg, centre_m=(0.0, 0.0, -tool.length_m / 2))
        _inertial(tip, middle, np.eye(4))
    ET.indent(root)
    text: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


_MASSLESS: Final = Link(0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0, 0.0, 0.0))


def _link(root: ET.Element, name: str) -> ET.Element:
    return ET.SubElement(root, "link", name=name)


def _moving(root: ET.Element, joint: Joint, parent: str, child: str, origin: Array) -> None:
    kind = "revolute" if joint.kind == REVOLUTE else "prismatic"
    element = ET.SubElement(root, "joint", name=joint.name, type=kind)
    _ends(element, parent, child, origin)
    ET.SubElement(element, "axis", xyz="0 0 1")
    ET.SubElement(
        element,
        "limit",
        lower=repr(joint.lower),
        upper=repr(joint.upper),
        velocity=repr(joint.velocity),
        effort="0",
    )


def _fixed(root: ET.Element, parent: str, child: str, origin: Array) -> None:
    element = ET.SubElement(root, "joint", name=f"{child}_joint", type="fixed")
    _ends(element, parent, child, origin)


def _ends(element: ET.Element, parent: str, child: str, origin: Array) -> None:
    ET.SubElement(element, "parent", link=parent)
    ET.SubElement(element, "child", link=child)
    _origin(element, origin)


def _origin(element: ET.Element, pose: Array) -> None:
    ET.SubElement(
        element,
        "origin",
        xyz=_text(pose[:3, 3]),
        rpy=_text(np.array(roll_pitch_yaw(pose[:3, :3]))),
    )


def _inertial(element: ET.Element, link: Link, rest: Array) -> None:
    inertial = ET.SubElement(element, "inertial")
    place = rest.copy()
    place[:3, 3] += rest[:3, :3] @ np.array(link.centre_m)
    _origin(inertial, place)
    ET.SubElement(inertial, "mass", value=repr(link.mass_kg))
    tensor = link_tensor(link)
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    values = tensor[np.triu_indices(3)]
    entries = {name: repr(float(value)) for name, value in zip(names, values, strict=True)}
    ET.SubElement(inertial, "inertia", entries)


def _cylinder(element: ET.Element, start: Array, end: Array, radius: float) -> None:
    """A visual from one point of the link to another; nothing where they are one."""
    along = end - start
    length = float(np.linalg.norm(along))
    if length == 0.0:
        return
    visual = ET.SubElement(element, "visual")
    pitch = float(np.arctan2(np.hypot(along[0], along[1]), along[2]))
    yaw = float(np.arctan2(along[1], along[0]))
    _origin(visual, transform((start + end) / 2, (0.0, pitch, yaw)))
    geometry = ET.SubElement(visual, "geometry")
    ET.SubElement(geometry, "cylinder", radius=repr(float(radius)), length=repr(length))


def _text(values: Array) -> str:
    return " ".join(repr(float(value)) for value in values)
