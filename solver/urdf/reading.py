"""A robot from a URDF file: one serial chain of it, as Denavit-Hartenberg rows.

URDF has no acceleration limits and no home posture; both are said by the caller or follow a rule.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from defusedxml import ElementTree as SafeTree
from defusedxml.common import DefusedXmlException

from solver.exceptions import InvalidRobot
from solver.kinematics.dynamics import link_tensor, shift_tensor, tensor_entries
from solver.kinematics.forward import forward_kinematics
from solver.robots.model import PRISMATIC, REVOLUTE, Array, Joint, Link, Robot, Tool, check_robot
from solver.robots.rigid import inverse, roll_pitch_yaw, transform
from solver.robots.toml_writing import with_version
from solver.urdf.axes import Row, Rows, denavit_hartenberg
from solver.urdf.tolerances import CONVERTED_POSE, CONVERTED_POSTURES, URDF_DIGIT_SHARE, URDF_DIGITS

MOVING: Final = {"revolute": REVOLUTE, "continuous": REVOLUTE, "prismatic": PRISMATIC}


@dataclass(frozen=True)
class _Element:
    """A joint of the file: its frame in the parent link at q = 0, and in itself the axis."""

    name: str
    kind: str
    parent: str
    child: str
    origin: Array
    axis: Array
    element: ET.Element


@dataclass(frozen=True)
class _Body:
    """Mass [kg], centre [m] and inertia about it [kg m2] in the base frame at q = 0."""

    mass_kg: float
    centre: Array
    inertia: Array


def robot_from_urdf(
    document: bytes,
    base: str,
    tip: str,
    *,
    name: str | None = None,
    acceleration_rad_s2: float,
    acceleration_m_s2: float = 1.0,
) -> Robot:
    """The chain from one link to another as a robot, with a tool named after the tip.

    Fixed joints are folded into the links beside them, with their masses. A continuous joint gets
    limits of half a turn to either side. Home is zero where the limits allow it, else their middle.
    Angles that are written as rounded multiples of 15 degrees (1.5708) are read as these.

    Args:
        document: the file. Document types and entities are refused.
        base: link whose frame is the base frame.
        tip: link whose frame is the tool frame: z along the forks, y along the branch.
        name: the robot's name; default: the file's.
        acceleration_rad_s2: limit of every revolute joint [rad/s2].
        acceleration_m_s2: limit of every prismatic joint [m/s2].

    Raises:
        InvalidRobot: not a URDF, no such chain, joints that mimic or float, or no limits.
    """
    root = _root(document)
    elements = _elements(root)
    chain = _chain(elements, base, tip)
    moving = [entry for entry in chain if entry.kind in MOVING]
    if not moving:
        raise InvalidRobot(f"no joint moves between {base!r} and {tip!r}")
    frames, tip_frame = _frames_at_zero(chain)
    rows = denavit_hartenberg(frames, tip_frame)
    bodies = _bodies(root, elements, chain)
    limits = {REVOLUTE: acceleration_rad_s2, PRISMATIC: acceleration_m_s2}
    # The last link's frame is turned with the flange.
    flange = rows.rows[-1].frame @ transform((0.0, 0.0, 0.0), (0.0, 0.0, rows.roll_rad))
    frames = [*(row.frame for row in rows.rows[:-1]), flange]
    joints = tuple(
        _joint(entry, row, limits, None if body is None else _link(body, frame))
        for entry, row, body, frame in zip(moving, rows.rows, bodies, frames, strict=True)
    )
    robot = _robot(name or root.get("name") or "robot", joints, rows, tip)
    check_robot(robot)
    _compare(robot, chain)
    return with_version(robot)


def _root(document: bytes) -> ET.Element:
    try:
        root = SafeTree.fromstring(document, forbid_dtd=True)
    except (ET.ParseError, DefusedXmlException, ValueError, LookupError) as error:
        raise InvalidRobot(f"the URDF cannot be read: {error!r}") from error
    if root.tag != "robot":
        raise InvalidRobot("the document's root element is not <robot>")
    return root


def _elements(root: ET.Element) -> list[_Element]:
    elements = []
    for joint in root.findall("joint"):
        name = joint.get("name", "")
        parent, child = joint.find("parent"), joint.find("child")
        if parent is None or child is None:
            raise InvalidRobot(f"joint {name!r} has no parent or no child")
        axis_element = joint.find("axis")
        axis = np.array([1.0, 0.0, 0.0])  # URDF's default
        if axis_element is not None:
            axis = _vector(axis_element.get("xyz", "1 0 0"), name)
        kind = joint.get("type", "")
        if kind in MOVING and not np.linalg.norm(axis) > 0:
            raise InvalidRobot(f"joint {name!r} has an axis without a direction")
        origin = _origin(joint.find("origin"), name)
        elements.append(
            _Element(name, kind, parent.get("link", ""), child.get("link", ""), origin, axis, joint)
        )
    return elements


def _chain(elements: list[_Element], base: str, tip: str) -> list[_Element]:
    by_child = {entry.child: entry for entry in elements}
    chain: list[_Element] = []
    link = tip
    while link != base:
        if link not in by_child or len(chain) > len(elements):
            raise InvalidRobot(f"no chain of joints leads from link {base!r} to link {tip!r}")
        chain.append(by_child[link])
        link = chain[-1].parent
    for entry in chain:
        if entry.kind not in MOVING and entry.kind != "fixed":
            raise InvalidRobot(f"joint {entry.name!r} is {entry.kind!r}, which no serial arm has")
        if entry.element.find("mimic") is not None:
            raise InvalidRobot(f"joint {entry.name!r} mimics another")
    return chain[::-1]


def _frames_at_zero(chain: list[_Element]) -> tuple[list[Array], Array]:
    """Frames with the moving joints' axes as z, and the tip's, in the base frame at q = 0."""
    pose, frames = np.eye(4), []
    for entry in chain:
        pose = pose @ entry.origin
        if entry.kind in MOVING:
            frame = pose.copy()
            frame[:3, 2] = pose[:3, :3] @ (entry.axis / np.linalg.norm(entry.axis))
            frames.append(frame)
    return frames, pose


def _joint(
    entry: _Element, row: Row, accelerations: Mapping[str, float], link: Link | None
) -> Joint:
    limit = entry.element.find("limit")
    if limit is None or "velocity" not in limit.attrib:
        raise InvalidRobot(f"joint {entry.name!r} has no velocity limit")
    lower, upper = -math.pi, math.pi
    if entry.kind != "continuous":
        if "lower" not in limit.attrib or "upper" not in limit.attrib:
            raise InvalidRobot(f"joint {entry.name!r} has no position limits")
        lower = _number(limit.attrib["lower"], entry.name)
        upper = _number(limit.attrib["upper"], entry.name)
    kind = MOVING[entry.kind]
    return Joint(
        name=entry.name,
        a_m=row.a_m,
        alpha_rad=row.alpha_rad,
        d_m=row.d_m,
        offset_rad=row.offset_rad,
        lower=lower,
        upper=upper,
        velocity=_number(limit.attrib["velocity"], entry.name),
        acceleration=accelerations[kind],
        kind=kind,
        link=link,
    )


def _link(body: _Body, frame: Array) -> Link:
    """A body of the base frame at q = 0, in the frame of its row."""
    back = inverse(frame)
    x, y, z = (float(value) for value in back[:3, :3] @ body.centre + back[:3, 3])
    tensor = back[:3, :3] @ body.inertia @ back[:3, :3].T
    return Link(body.mass_kg, (x, y, z), tensor_entries(tensor))


def _robot(name: str, joints: tuple[Joint, ...], rows: Rows, tip: str) -> Robot:
    x, y, z = (float(value) for value in rows.mount[:3, 3])
    home = tuple(
        0.0 if joint.lower <= 0.0 <= joint.upper else (joint.lower + joint.upper) / 2
        for joint in joints
    )
    weighed = all(joint.link is not None for joint in joints)
    if not weighed:
        joints = tuple(replace(joint, link=None) for joint in joints)
    return Robot(
        name=name,
        description=f"{name}, {len(joints)} joints, from a URDF file",
        source="a URDF file",
        joints=joints,
        tools=(Tool(tip, rows.tool_length_m, "The chain's tip."),),
        default_tool=tip,
        home_joints=home,
        version="",
        mount_position_m=(x, y, z),
        mount_rpy_rad=roll_pitch_yaw(rows.mount[:3, :3]),
        flange_roll_rad=rows.roll_rad,
        mass_source="as in the URDF file" if weighed else "",
    )


def _compare(robot: Robot, chain: list[_Element]) -> None:
    """Raise InvalidRobot unless both chains lead to the same poses at random postures."""
    rng = np.random.default_rng(0)
    postures = rng.uniform(robot.lower, robot.upper, (CONVERTED_POSTURES, len(robot.joints)))
    ours = forward_kinematics(robot, robot.tools[0], postures)
    theirs = np.array([_pose(chain, posture) for posture in postures])
    apart = float(np.abs(ours - theirs).max())
    if not apart <= CONVERTED_POSE:
        raise InvalidRobot(f"the converted arm's tip is {apart:.3g} m away from the URDF's")


def _pose(chain: list[_Element], posture: Array) -> Array:
    """The tip's pose by the file's own joints, not by rows: Rodrigues' rotation about each axis."""
    pose, values = np.eye(4), iter(posture)
    for entry in chain:
        pose = pose @ entry.origin
        if entry.kind in MOVING:
            axis, value = entry.axis / np.linalg.norm(entry.axis), next(values)
            step = np.eye(4)
            if MOVING[entry.kind] == REVOLUTE:
                x, y, z = axis
                cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
                step[:3, :3] += math.sin(value) * cross + (1 - math.cos(value)) * cross @ cross
            else:
                step[:3, 3] = value * axis
            pose = pose @ step
    return pose


def _bodies(
    root: ET.Element, elements: list[_Element], chain: list[_Element]
) -> list[_Body | None]:
    """What each moving joint carries up to the next, in the base frame at q = 0."""
    inertials = {link.get("name", ""): link.find("inertial") for link in root.findall("link")}
    on_chain = {entry.child for entry in chain}
    groups: list[list[_Body]] = []
    pose = np.eye(4)
    for entry in chain:
        pose = pose @ entry.origin
        if entry.kind in MOVING:
            groups.append([])
        if groups:
            for link, place in _rigid(elements, entry.child, pose, on_chain):
                element = inertials.get(link)
                if element is not None:
                    groups[-1].append(_body(element, place, link))
    return [_sum(group) if group else None for group in groups]


def _rigid(
    elements: list[_Element], link: str, pose: Array, on_chain: set[str]
) -> Iterator[tuple[str, Array]]:
    """A link and what is fixed to it beside the chain, with their frames."""
    yield link, pose
    for entry in elements:
        if entry.parent == link and entry.kind == "fixed" and entry.child not in on_chain:
            yield from _rigid(elements, entry.child, pose @ entry.origin, on_chain)


def _body(inertial: ET.Element, place: Array, link: str) -> _Body:
    mass, inertia = inertial.find("mass"), inertial.find("inertia")
    if mass is None or inertia is None:
        raise InvalidRobot(f"link {link!r} has an <inertial> without mass or inertia")
    pose = place @ _origin(inertial.find("origin"), link)
    xx, yy, zz, xy, xz, yz = (
        _number(inertia.get(key, "0"), link) for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    )
    tensor = link_tensor(Link(0.0, (0.0, 0.0, 0.0), (xx, yy, zz, xy, xz, yz)))
    turn = pose[:3, :3]
    return _Body(_number(mass.get("value", ""), link), pose[:3, 3], turn @ tensor @ turn.T)


def _sum(bodies: list[_Body]) -> _Body:
    total = sum(body.mass_kg for body in bodies)
    if total == 0.0:
        return replace(bodies[0], inertia=np.sum([body.inertia for body in bodies], axis=0))
    centre = np.sum([body.mass_kg * body.centre for body in bodies], axis=0) / total
    inertia = np.sum(
        [body.inertia + body.mass_kg * shift_tensor(body.centre - centre) for body in bodies],
        axis=0,
    )
    return _Body(total, centre, inertia)


def _origin(element: ET.Element | None, where: str) -> Array:
    if element is None:
        return np.eye(4)
    position = _vector(element.get("xyz", "0 0 0"), where)
    angles = element.get("rpy", "0 0 0").split()
    if len(angles) != 3:
        raise InvalidRobot(f"{where!r} has an rpy that is not three numbers")
    return transform(position, [_angle(text, where) for text in angles])


def _vector(text: str, where: str) -> Array:
    numbers = [_number(part, where) for part in text.split()]
    if len(numbers) != 3:
        raise InvalidRobot(f"{where!r} has a vector that is not three numbers")
    return np.array(numbers)


def _angle(text: str, where: str) -> float:
    """The number, or the multiple of 15 degrees that it is a rounding of, to the digits written."""
    value = _number(text, where)
    multiple = round(value / (math.pi / 12)) * math.pi / 12
    digits = len(text.lower().partition("e")[0].partition(".")[2])
    plain = "e" not in text.lower() and digits >= URDF_DIGITS
    return (
        multiple if plain and abs(value - multiple) <= URDF_DIGIT_SHARE * 10.0**-digits else value
    )


def _number(text: str, where: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InvalidRobot(f"{where!r} has {text[:40]!r} where a number is due")
    return value
