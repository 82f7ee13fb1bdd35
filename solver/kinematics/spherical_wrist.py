"""Closed-form inverse kinematics of six-joint arms with a spherical wrist: all eight branches.

Geometry covered, in classic Denavit-Hartenberg parameters (angles theta = q + offset):

    link   a    alpha   d           The last three axes meet in the wrist centre; axes 2 and 3 are
    1      a1   s1 90   d1          parallel. a1 is the elbow's offset from the waist axis, a3 one
    2      a2   0       d2          at the elbow (it only turns and lengthens the forearm), d2 + d3
    3      a3   s3 90   d3          the shoulder's offset sideways. s1, s3, s4, s5 are signs.
    4      0    s4 90   d4
    5      0    s5 90   0           T's arm: a3 = d2 = d3 = 0, s1 = s3 = s5 = 1, s4 = -1.
    6      0    0       d6 + tool

Derivation. The wrist centre c = p - (d6 + tool) z. In the arm's vertical plane it is the end of two
links a2 and l3 = hypot(a3, d4), the second turned by theta3 + beta, beta = atan2(-s3 d4, a3); the
plane stands `shoulder` = d2 + d3 beside the waist axis. With x = +-sqrt(cx^2 + cy^2 - shoulder^2):

    theta1 = atan2(cy, cx) - atan2(-s1 shoulder, x),   r = x - a1,   s = s1 (cz - d1)
    cos g = (r^2 + s^2 - a2^2 - l3^2) / (2 a2 l3),     theta3 = +-g - beta
    theta2 = atan2(s, r) - atan2(l3 sin g, a2 + l3 cos g)

and the wrist from R36 = R03^T R: its third column is (s5 cos4 sin5, s5 sin4 sin5, -s4 s5 cos5), its
third row (s4 sin5 cos6, -s4 sin5 sin6, .). T 3.5 with its misprints mended (d3 for d6, a3 s3 for
d4 s3), its second theta1 kept and its singular case (r13 and r23 both zero) done right.

Branch number = 4 shoulder + 2 elbow + wrist; 0 means x >= 0, +g and sin(q5) >= 0.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators
# mypy: no-check-untyped-defs

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.compiled import inlined, kernel
from solver.exceptions import UnsupportedKinematics
from solver.kinematics.arctangent import atan2
from solver.kinematics.tolerances import RIGHT_ANGLE_RAD, TINY_M2
from solver.robots.model import REVOLUTE, Array, Robot, Tool
from solver.robots.rigid import inverse
from solver.tolerances import REACH_ROUNDING_M, SINGULAR_WRIST

BRANCHES: Final = 8


class WristGeometry(NamedTuple):
    """What the kernels know of an arm: lengths [m], signs of twists, offsets, middles [rad]."""

    a1: float
    a2: float
    l3: float
    beta: float
    cos_beta: float
    sin_beta: float
    shoulder: float
    d1: float
    sign1: float
    sign3: float
    sign4: float
    sign5: float
    tool_length: float
    offsets: tuple[float, ...]
    middles: tuple[float, ...]


@dataclass(frozen=True)
class InverseSolutions:
    """All branches for n poses.

    Attributes:
        joints: shape (n, 8, 6) [rad], each within half a turn of the middle of its limits. Where a
            branch is out of reach, its posture stretched or folded towards the pose.
        reach_margin_m: shape (n, 4) by shoulder and elbow, branch // 2 [m]: how far the wrist
            centre is inside the reach; negative: by how much it is outside.
        singular: shape (n, 8); the wrist is straight and q4 was set to zero.
    """

    joints: Array
    reach_margin_m: Array
    singular: NDArray[np.bool_]

    @property
    def reachable(self) -> NDArray[np.bool_]:
        """Shape (n, 8): the pose has this branch, whatever the joint limits say."""
        return np.repeat(self.reach_margin_m >= -REACH_ROUNDING_M, 2, axis=1)


@lru_cache(maxsize=64)
def wrist_geometry(robot: Robot, tool: Tool) -> WristGeometry:
    """The kernels' parameters of an arm with a tool.

    Raises:
        UnsupportedKinematics: the arm is not of the family that the module documents.
    """
    if len(robot.joints) != 6:
        raise UnsupportedKinematics(robot.name, f"{len(robot.joints)} joints instead of six")
    if any(joint.kind != REVOLUTE for joint in robot.joints):
        raise UnsupportedKinematics(robot.name, "a joint slides")
    j1, j2, j3, j4, j5, j6 = robot.joints
    zeros = {
        "a4": j4.a_m,
        "a5": j5.a_m,
        "a6": j6.a_m,
        "d5": j5.d_m,
        "alpha2": j2.alpha_rad,
        "alpha6": j6.alpha_rad,
    }
    for name, value in zeros.items():
        if value != 0.0:
            raise UnsupportedKinematics(robot.name, f"{name} is not zero")
    for number, joint in ((1, j1), (3, j3), (4, j4), (5, j5)):
        if abs(abs(joint.alpha_rad) - math.pi / 2) > RIGHT_ANGLE_RAD:
            raise UnsupportedKinematics(robot.name, f"alpha{number} is not a right angle")
    if j2.a_m == 0.0 or math.hypot(j3.a_m, j4.d_m) == 0.0:
        raise UnsupportedKinematics(robot.name, "the upper arm or the forearm has no length")
    sign3 = math.copysign(1.0, j3.alpha_rad)
    beta = math.atan2(-sign3 * j4.d_m, j3.a_m)
    return WristGeometry(
        a1=j1.a_m,
        a2=j2.a_m,
        l3=math.hypot(j3.a_m, j4.d_m),
        beta=beta,
        cos_beta=math.cos(beta),
        sin_beta=math.sin(beta),
        shoulder=j2.d_m + j3.d_m,
        d1=j1.d_m,
        sign1=math.copysign(1.0, j1.alpha_rad),
        sign3=sign3,
        sign4=math.copysign(1.0, j4.alpha_rad),
        sign5=math.copysign(1.0, j5.alpha_rad),
        tool_length=j6.d_m + tool.length_m,
        # The last twist is zero, so the flange's roll is one more offset of the last joint.
        offsets=(
            *(joint.offset_rad for joint in robot.joints[:-1]),
            j6.offset_rad + robot.flange_roll_rad,
        ),
        middles=tuple(float(value) for value in (robot.lower + robot.upper) / 2),
    )


def inverse_kinematics(robot: Robot, tool: Tool, poses: Array) -> InverseSolutions:
    """Every branch of every pose; joint limits are not applied.

    Args:
        robot: an arm with a spherical wrist.
        tool: its tool.
        poses: tool frames in the base frame, shape (n, 4, 4) [m].

    Raises:
        UnsupportedKinematics: the arm is not of the family that the module documents.
    """
    geometry = wrist_geometry(robot, tool)
    poses = np.ascontiguousarray(inverse(robot.mount) @ poses, dtype=np.float64)
    joints = np.empty((len(poses), BRANCHES, 6))
    margins = np.empty((len(poses), BRANCHES // 2))
    singular = np.empty((len(poses), BRANCHES), dtype=np.bool_)
    all_branches(geometry, poses, joints, margins, singular)
    return InverseSolutions(joints, margins, singular)


@kernel
def wrap(angle: float) -> float:
    """The angle less whole turns, in [-pi, pi)."""
    return angle - 2 * math.pi * math.floor((angle + math.pi) / (2 * math.pi))


@inlined
def arm_turns(g, cx, cy, cz, shoulder):
    """The arm's angles but for the elbow's sign, as cosines and sines, for a wrist centre.

    Returns cos1, sin1, r, s, cos g, |sin g|, 1 / (distance of the wrist centre times the length of
    the stretched or folded arm towards it) [1/m2], and the reach margins [m]: of the two links, and
    of the shoulder's offset beside the waist's axis, infinite where there is none.
    """
    rho2 = cx * cx + cy * cy
    facing = 1.0 - 2.0 * shoulder
    x = facing * math.sqrt(max(rho2 - g.shoulder * g.shoulder, 0.0))
    away, divisor = rho2 > TINY_M2, max(rho2, TINY_M2)
    cos1 = (cx * x - g.sign1 * g.shoulder * cy) / divisor if away else facing
    sin1 = (cy * x + g.sign1 * g.shoulder * cx) / divisor if away else 0.0
    r, s = x - g.a1, g.sign1 * (cz - g.d1)
    d2 = r * r + s * s
    distance = math.sqrt(d2)
    margin = min(g.a2 + g.l3 - distance, distance - abs(g.a2 - g.l3))
    beside = math.sqrt(rho2) - abs(g.shoulder) if g.shoulder != 0.0 else math.inf
    cosine = (d2 - g.a2 * g.a2 - g.l3 * g.l3) / (2 * g.a2 * g.l3)
    cos_g = min(max(cosine, -1.0), 1.0)
    sin_g = math.sqrt(max((1.0 - cos_g) * (1.0 + cos_g), 0.0))
    length2 = d2
    if cosine != cos_g:
        length2 = distance * abs(g.a2 + g.l3 * cos_g)
    return cos1, sin1, r, s, cos_g, sin_g, 1.0 / max(length2, TINY_M2), margin, beside


@inlined
def elbow_turns(g, r, s, cos_g, sin_g, inverse2):
    """cos2, sin2, cos3, sin3, cos(2 + 3), sin(2 + 3); sin_g carries the elbow's sign."""
    k1, k2 = g.a2 + g.l3 * cos_g, g.l3 * sin_g
    cos2, sin2 = (r * k1 + s * k2) * inverse2, (s * k1 - r * k2) * inverse2
    cos3 = cos_g * g.cos_beta + sin_g * g.sin_beta
    sin3 = sin_g * g.cos_beta - cos_g * g.sin_beta
    return cos2, sin2, cos3, sin3, cos2 * cos3 - sin2 * sin3, sin2 * cos3 + cos2 * sin3


@inlined
def wrist_turns(g, cos1, sin1, cos23, sin23, x_axis, y_axis, z_axis):
    """r13, r23, cos5, r31, r32 of R36, for tool axes as tuples."""
    x3 = (cos1 * cos23, sin1 * cos23, g.sign1 * sin23)
    y3 = (g.sign3 * g.sign1 * sin1, -g.sign3 * g.sign1 * cos1)
    z3 = (g.sign3 * sin23 * cos1, g.sign3 * sin23 * sin1, -g.sign3 * g.sign1 * cos23)
    r13 = x3[0] * z_axis[0] + x3[1] * z_axis[1] + x3[2] * z_axis[2]
    r23 = y3[0] * z_axis[0] + y3[1] * z_axis[1]
    r33 = z3[0] * z_axis[0] + z3[1] * z_axis[1] + z3[2] * z_axis[2]
    r31 = z3[0] * x_axis[0] + z3[1] * x_axis[1] + z3[2] * x_axis[2]
    r32 = z3[0] * y_axis[0] + z3[1] * y_axis[1] + z3[2] * y_axis[2]
    return r13, r23, -g.sign4 * g.sign5 * r33, r31, r32


@kernel
def wrist_angles(g, r13, r23, cos5, r31, r32, first):
    """theta4, theta5, theta6 with sin(theta5) >= 0, and whether the wrist is singular.

    Where it is, theta4 is joint 4's zero and theta6 does the turning; `first` is the direction of
    the tool's x axis in frame 3, (r11, r21).
    """
    sin5 = math.sqrt(r13 * r13 + r23 * r23)
    if sin5 < SINGULAR_WRIST:
        theta4 = g.offsets[3]
        turn = 0.0 if cos5 > 0 else math.pi
        same = -g.sign4 * g.sign5 * (1.0 if cos5 > 0 else -1.0)
        return theta4, turn, same * (atan2(first[1], first[0]) - theta4 - turn), True
    theta4 = atan2(g.sign5 * r23, g.sign5 * r13)
    return theta4, atan2(sin5, cos5), atan2(-g.sign4 * r32, g.sign4 * r31), False


@kernel
def x_in_frame_3(g, cos1, sin1, cos23, sin23, x_axis):
    """r11, r21: only a singular wrist needs them."""
    r11 = cos1 * cos23 * x_axis[0] + sin1 * cos23 * x_axis[1] + g.sign1 * sin23 * x_axis[2]
    r21 = g.sign3 * g.sign1 * (sin1 * x_axis[0] - cos1 * x_axis[1])
    return r11, r21


@kernel
def pose_branch(g, place, x_axis, y_axis, z_axis, branch, q):
    """Writes the posture of one branch for a pose in tuples to q; returns the reach margin [m]."""
    cx = place[0] - g.tool_length * z_axis[0]
    cy = place[1] - g.tool_length * z_axis[1]
    cz = place[2] - g.tool_length * z_axis[2]
    cos1, sin1, r, s, cos_g, sin_g, inverse2, reach, beside = arm_turns(g, cx, cy, cz, branch // 4)
    if branch // 2 % 2 == 1:
        sin_g = -sin_g
    cos2, sin2, cos3, sin3, cos23, sin23 = elbow_turns(g, r, s, cos_g, sin_g, inverse2)
    turns = wrist_turns(g, cos1, sin1, cos23, sin23, x_axis, y_axis, z_axis)
    first = x_in_frame_3(g, cos1, sin1, cos23, sin23, x_axis)
    theta4, theta5, theta6, flat = wrist_angles(g, *turns, first)
    theta1, theta2, theta3 = atan2(sin1, cos1), atan2(sin2, cos2), atan2(sin3, cos3)
    _write(g, q, theta1, theta2, theta3, theta4, theta5, theta6, branch % 2 == 1 and not flat)
    return min(reach, beside)


@kernel
def one_branch(g, position, axes, branch, q):
    """Writes the posture of one branch to q, shape (6,) [rad]; returns the reach margin [m].

    `axes` has the tool's x, y, z as columns, shape (3, 3).
    """
    place = (position[0], position[1], position[2])
    x_axis, y_axis = (axes[0, 0], axes[1, 0], axes[2, 0]), (axes[0, 1], axes[1, 1], axes[2, 1])
    return pose_branch(g, place, x_axis, y_axis, (axes[0, 2], axes[1, 2], axes[2, 2]), branch, q)


@kernel
def all_branches(g, poses, joints, margins, singular):
    """Fills joints (n, 8, 6), margins (n, 4) and singular (n, 8) for poses of shape (n, 4, 4)."""
    for n in range(len(poses)):
        pose = poses[n]
        x_axis = (pose[0, 0], pose[1, 0], pose[2, 0])
        y_axis = (pose[0, 1], pose[1, 1], pose[2, 1])
        z_axis = (pose[0, 2], pose[1, 2], pose[2, 2])
        cx = pose[0, 3] - g.tool_length * z_axis[0]
        cy = pose[1, 3] - g.tool_length * z_axis[1]
        cz = pose[2, 3] - g.tool_length * z_axis[2]
        for shoulder in range(2):
            cos1, sin1, r, s, cos_g, sin_g, inverse2, reach, beside = arm_turns(
                g, cx, cy, cz, shoulder
            )
            theta1 = atan2(sin1, cos1)
            for elbow in range(2):
                arm = 2 * shoulder + elbow
                margins[n, arm] = min(reach, beside)
                turns = elbow_turns(g, r, s, cos_g, sin_g if elbow == 0 else -sin_g, inverse2)
                cos2, sin2, cos3, sin3, cos23, sin23 = turns
                theta2, theta3 = atan2(sin2, cos2), atan2(sin3, cos3)
                wrist = wrist_turns(g, cos1, sin1, cos23, sin23, x_axis, y_axis, z_axis)
                first = x_in_frame_3(g, cos1, sin1, cos23, sin23, x_axis)
                theta4, theta5, theta6, flat = wrist_angles(g, *wrist, first)
                for flip in range(2):
                    q = joints[n, 2 * arm + flip]
                    turned = flip == 1 and not flat
                    _write(g, q, theta1, theta2, theta3, theta4, theta5, theta6, turned)
                    singular[n, 2 * arm + flip] = flat


@kernel
def _write(g, q, theta1, theta2, theta3, theta4, theta5, theta6, turned):
    # The other wrist: half a turn of joints 4 and 6, joint 5 mirrored.
    half = math.pi if turned else 0.0
    q[0] = g.middles[0] + wrap(theta1 - g.offsets[0] - g.middles[0])
    q[1] = g.middles[1] + wrap(theta2 - g.offsets[1] - g.middles[1])
    q[2] = g.middles[2] + wrap(theta3 - g.offsets[2] - g.middles[2])
    q[3] = g.middles[3] + wrap(theta4 + half - g.offsets[3] - g.middles[3])
    q[4] = g.middles[4] + wrap((-theta5 if turned else theta5) - g.offsets[4] - g.middles[4])
    q[5] = g.middles[5] + wrap(theta6 + half - g.offsets[5] - g.middles[5])
