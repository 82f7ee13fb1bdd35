"""A robot from a URDF file: one serial chain of it, as Denavit-Hartenberg rows.

URDF has no acceleration limits and no home posture; both are said by the caller or follow a rule.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from solver.exceptions import InvalidRobot
from solver.kinematics.forward import forward_kinematics
from solver.robots.model import PRISMATIC, REVOLUTE, Array, Joint, Link, Robot, Tool, check_robot
from solver.robots.rigid import roll_pitch_yaw, transform
from solver.robots.toml_writing import with_version
from solver.urdf.axes import Row, Rows, denavit_hartenberg
from solver.urdf.bodies import carried_bodies, link_of
from solver.urdf.elements import MOVING, Element, joint_elements, number_in, parsed, serial_chain
from solver.urdf.tolerances import CONVERTED_POSE, CONVERTED_POSTURES


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
    root = parsed(document)
    elements = joint_elements(root)
    chain = serial_chain(elements, base, tip)
    moving = [entry for entry in chain if entry.kind in MOVING]
    if not moving:
        raise InvalidRobot(f"no joint moves between {base!r} and {tip!r}")
    frames, tip_frame = _frames_at_zero(chain)
    rows = denavit_hartenberg(frames, tip_frame)
    bodies = carried_bodies(root, elements, chain)
    limits = {REVOLUTE: acceleration_rad_s2, PRISMATIC: acceleration_m_s2}
    # The last link's frame is turned with the flange.
    flange = rows.rows[-1].frame @ transform((0.0, 0.0, 0.0), (0.0, 0.0, rows.roll_rad))
    frames = [*(row.frame for row in rows.rows[:-1]), flange]
    joints = tuple(
        _joint(entry, row, limits, None if body is None else link_of(body, frame))
        for entry, row, body, frame in zip(moving, rows.rows, bodies, frames, strict=True)
    )
    robot = _robot(name or root.get("name") or "robot", joints, rows, tip)
    check_robot(robot)
    _compare(robot, chain)
    return with_version(robot)


def _frames_at_zero(chain: list[Element]) -> tuple[list[Array], Array]:
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
    entry: Element, row: Row, accelerations: Mapping[str, float], link: Link | None
) -> Joint:
    limit = entry.element.find("limit")
    if limit is None or "velocity" not in limit.attrib:
        raise InvalidRobot(f"joint {entry.name!r} has no velocity limit")
    lower, upper = -math.pi, math.pi
    if entry.kind != "continuous":
        if "lower" not in limit.attrib or "upper" not in limit.attrib:
            raise InvalidRobot(f"joint {entry.name!r} has no position limits")
        lower = number_in(limit.attrib["lower"], entry.name)
        upper = number_in(limit.attrib["upper"], entry.name)
    kind = MOVING[entry.kind]
    return Joint(
        name=entry.name,
        a_m=row.a_m,
        alpha_rad=row.alpha_rad,
        d_m=row.d_m,
        offset_rad=row.offset_rad,
        lower=lower,
        upper=upper,
        velocity=number_in(limit.attrib["velocity"], entry.name),
        acceleration=accelerations[kind],
        kind=kind,
        link=link,
    )


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


def _compare(robot: Robot, chain: list[Element]) -> None:
    """Raise InvalidRobot unless both chains lead to the same poses at random postures."""
    rng = np.random.default_rng(0)
    postures = rng.uniform(robot.lower, robot.upper, (CONVERTED_POSTURES, len(robot.joints)))
    ours = forward_kinematics(robot, robot.tools[0], postures)
    theirs = np.array([_pose(chain, posture) for posture in postures])
    apart = float(np.abs(ours - theirs).max())
    if not apart <= CONVERTED_POSE:
        raise InvalidRobot(f"the converted arm's tip is {apart:.3g} m away from the URDF's")


def _pose(chain: list[Element], posture: Array) -> Array:
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
