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

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.compiled import kernel
from solver.exceptions import UnsupportedKinematics
from solver.robots.model import REVOLUTE, Array, Robot, Tool
from solver.robots.rigid import inverse
from solver.tolerances import REACH_ROUNDING_M, RIGHT_ANGLE_RAD, SINGULAR_WRIST

BRANCHES: Final = 8


class WristGeometry(NamedTuple):
    """What the kernels know of an arm: lengths [m], signs of twists, offsets, middles [rad]."""

    a1: float
    a2: float
    l3: float
    beta: float
    shoulder: float
    d1: float
    sign1: float
    sign3: float
    sign4: float
    sign5: float
    tool_length: float
    offsets: Array
    middles: Array


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
    return WristGeometry(
        a1=j1.a_m,
        a2=j2.a_m,
        l3=math.hypot(j3.a_m, j4.d_m),
        beta=math.atan2(-sign3 * j4.d_m, j3.a_m),
        shoulder=j2.d_m + j3.d_m,
        d1=j1.d_m,
        sign1=math.copysign(1.0, j1.alpha_rad),
        sign3=sign3,
        sign4=math.copysign(1.0, j4.alpha_rad),
        sign5=math.copysign(1.0, j5.alpha_rad),
        tool_length=j6.d_m + tool.length_m,
        # The last twist is zero, so the flange's roll is one more offset of the last joint.
        offsets=np.array([joint.offset_rad for joint in robot.joints])
        + np.array([0.0, 0.0, 0.0, 0.0, 0.0, robot.flange_roll_rad]),
        middles=(robot.lower + robot.upper) / 2,
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


@kernel
def arm_joints(g, cx, cy, cz, shoulder, elbow):
    """theta1, theta2, theta3 and the reach margin [m] for a wrist centre on one arm branch."""
    rho = math.hypot(cx, cy)
    x = math.sqrt(max(rho * rho - g.shoulder * g.shoulder, 0.0))
    if shoulder == 1:
        x = -x
    theta1 = math.atan2(cy, cx) - math.atan2(-g.sign1 * g.shoulder, x)
    r = x - g.a1
    s = g.sign1 * (cz - g.d1)
    distance = math.hypot(r, s)
    margin = min(g.a2 + g.l3 - distance, distance - abs(g.a2 - g.l3), rho - abs(g.shoulder))
    cos_g = (distance * distance - g.a2 * g.a2 - g.l3 * g.l3) / (2 * g.a2 * g.l3)
    gamma = math.acos(min(max(cos_g, -1.0), 1.0))
    if elbow == 1:
        gamma = -gamma
    theta2 = math.atan2(s, r) - math.atan2(g.l3 * math.sin(gamma), g.a2 + g.l3 * math.cos(gamma))
    return theta1, theta2, gamma - g.beta, margin


@kernel
def wrist_joints(g, theta1, theta23, axes, wrist):
    """theta4, theta5, theta6, and whether the wrist is singular; `axes` has x, y, z as columns."""
    c1, s1 = math.cos(theta1), math.sin(theta1)
    c23, s23 = math.cos(theta23), math.sin(theta23)
    x3x, x3y, x3z = c1 * c23, s1 * c23, g.sign1 * s23
    y3x, y3y = g.sign3 * g.sign1 * s1, -g.sign3 * g.sign1 * c1
    z3x, z3y, z3z = g.sign3 * s23 * c1, g.sign3 * s23 * s1, -g.sign3 * g.sign1 * c23
    r13 = x3x * axes[0, 2] + x3y * axes[1, 2] + x3z * axes[2, 2]
    r23 = y3x * axes[0, 2] + y3y * axes[1, 2]
    r33 = z3x * axes[0, 2] + z3y * axes[1, 2] + z3z * axes[2, 2]
    sin5 = math.hypot(r13, r23)
    cos5 = -g.sign4 * g.sign5 * r33
    if sin5 < SINGULAR_WRIST:
        theta4 = g.offsets[3]
        r11 = x3x * axes[0, 0] + x3y * axes[1, 0] + x3z * axes[2, 0]
        r21 = y3x * axes[0, 0] + y3y * axes[1, 0]
        first = math.atan2(r21, r11)
        turn = 0.0 if cos5 > 0 else math.pi
        same = -g.sign4 * g.sign5 * (1.0 if cos5 > 0 else -1.0)
        return theta4, turn, same * (first - theta4 - turn), True
    sign = 1.0 if wrist == 0 else -1.0
    r31 = z3x * axes[0, 0] + z3y * axes[1, 0] + z3z * axes[2, 0]
    r32 = z3x * axes[0, 1] + z3y * axes[1, 1] + z3z * axes[2, 1]
    theta4 = math.atan2(sign * g.sign5 * r23, sign * g.sign5 * r13)
    theta5 = math.atan2(sign * sin5, cos5)
    theta6 = math.atan2(-sign * g.sign4 * r32, sign * g.sign4 * r31)
    return theta4, theta5, theta6, False


@kernel
def one_branch(g, position, axes, branch, q):
    """Writes the posture of one branch to q, shape (6,) [rad]; returns the reach margin [m]."""
    cx = position[0] - g.tool_length * axes[0, 2]
    cy = position[1] - g.tool_length * axes[1, 2]
    cz = position[2] - g.tool_length * axes[2, 2]
    theta1, theta2, theta3, margin = arm_joints(g, cx, cy, cz, branch // 4, branch // 2 % 2)
    theta4, theta5, theta6, _ = wrist_joints(g, theta1, theta2 + theta3, axes, branch % 2)
    _write(g, q, theta1, theta2, theta3, theta4, theta5, theta6)
    return margin


@kernel
def all_branches(g, poses, joints, margins, singular):
    """Fills joints (n, 8, 6), margins (n, 4) and singular (n, 8) for poses of shape (n, 4, 4)."""
    for n in range(len(poses)):
        axes = poses[n, :3, :3]
        cx = poses[n, 0, 3] - g.tool_length * axes[0, 2]
        cy = poses[n, 1, 3] - g.tool_length * axes[1, 2]
        cz = poses[n, 2, 3] - g.tool_length * axes[2, 2]
        for arm in range(BRANCHES // 2):
            theta1, theta2, theta3, margin = arm_joints(g, cx, cy, cz, arm // 2, arm % 2)
            margins[n, arm] = margin
            for wrist in range(2):
                theta4, theta5, theta6, flat = wrist_joints(g, theta1, theta2 + theta3, axes, wrist)
                singular[n, 2 * arm + wrist] = flat
                q = joints[n, 2 * arm + wrist]
                _write(g, q, theta1, theta2, theta3, theta4, theta5, theta6)


@kernel
def _write(g, q, theta1, theta2, theta3, theta4, theta5, theta6):
    q[0], q[1], q[2] = theta1, theta2, theta3
    q[3], q[4], q[5] = theta4, theta5, theta6
    for i in range(6):
        q[i] = g.middles[i] + wrap(q[i] - g.offsets[i] - g.middles[i])
