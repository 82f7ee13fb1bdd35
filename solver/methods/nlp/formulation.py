"""The task definition as a nonlinear programme, built once for a robot and a shape, fed parameters.

Variables    q_0, q_1   thinning and standby posture             (n each)
             q_r        posture at a further row of the cut-in   (n each), `Shape.rows` of them
             phi        approach angle                           (1)
             sigma      share of the strike zone                 (1), 0 to 1, `Shape.strike`
             eta        swing, shares of the tolerance           (2), `Shape.tilt`
             t          travel of each joint                     (n), l1: t >= |q_0 - reference|
             t'         travel to the next target                (n), l1 and `Shape.coupled`
Parameters   p, y, u, v   target, tool y axis, approach direction at 0 and at a quarter turn
             reference, next thinning posture, weights, retreat of each posture, tool length,
             strike zone, half-angle tangent of the tilt tolerance
Minimise     sum w t  (+ sum w t')      (l1)
             sum w (q_0 - reference)^2  (+ sum w (next - q_1)^2)      (l2)
Subject to   position(q_k) = p + (strike zone sigma - retreat_k) z      axes(q_k) = [y' x z, y', z]
             |eta| <= 1, limits of every posture, bounds of phi; a rail stands still

The swing is the smallest rotation that takes b to the leaning y axis: its rotation vector is normal
to b. S(g) turns by 2 atan |g| about g = tan(tolerance / 2) (eta_1 u + eta_2 v), a rational
function, smooth at zero. z = S z(phi) and y' = S y, so phi keeps its meaning.

A relaxation that is off has no variable: the unrelaxed programme is as small as if there were none.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from solver.robots.model import PRISMATIC, REVOLUTE, Joint, Robot
from solver.robots.rigid import transform
from solver.tolerances import EXACT_ZERO


@dataclass(frozen=True)
class Shape:
    """What decides a programme's variables, beside the robot.

    Attributes:
        norm: "l1" or "l2".
        strike: the target may lie along the forks.
        tilt: the tool's y axis may lean off the branch.
        rows: further postures of the cut-in that have to be feasible.
        coupled: the travel from this standby to a next thinning posture counts too.
    """

    norm: str
    strike: bool = False
    tilt: bool = False
    rows: int = 0
    coupled: bool = False


@dataclass(frozen=True)
class Programme:
    """A CasADi programme: expressions only, so it is shared by all tools and backends.

    Attributes:
        shape: what it was built for.
        joints: joints of the robot, n.
        nlp: symbols x, p and expressions f, g, as `casadi.nlpsol` takes them.
        equalities: the first this many constraints are 0; the others are not negative.
        inequalities: how many others there are.
        kinematic: how many variables stand before the slacks of the l1 norm.
        slack_of: for each slack, the index of the joint in x whose travel it bounds.
    """

    shape: Shape
    joints: int
    nlp: dict[str, Any]
    equalities: int
    inequalities: int
    kinematic: int
    slack_of: NDArray[np.intp]

    @property
    def postures(self) -> int:
        """How many postures stand at the beginning of x."""
        return 2 + self.shape.rows

    @property
    def angle(self) -> int:
        """Index of the approach angle in x; the relaxations follow it."""
        return self.postures * self.joints

    @property
    def slacks(self) -> int:
        """How many slacks stand at the end of x."""
        return len(self.slack_of)


@lru_cache(maxsize=64)
def build_programme(robot: Robot, shape: Shape) -> Programme:
    """The programme of a robot for one shape."""
    n, postures = len(robot.joints), 2 + shape.rows
    q = [ca.SX.sym(f"q_{k}", n) for k in range(postures)]
    phi, sigma, eta = ca.SX.sym("phi"), ca.SX.sym("sigma"), ca.SX.sym("eta", 2)
    position, y_axis = ca.SX.sym("p", 3), ca.SX.sym("y", 3)
    outward, sideways = ca.SX.sym("u", 3), ca.SX.sym("v", 3)
    reference, following = ca.SX.sym("reference", n), ca.SX.sym("next", n)
    weights, retreats = ca.SX.sym("weights", n), ca.SX.sym("retreats", postures)
    tool_length, zone = ca.SX.sym("tool_length"), ca.SX.sym("zone")
    half_tangent = ca.SX.sym("half_tangent")

    variables, inequalities = [*q, phi], []
    z_axis = ca.cos(phi) * outward + ca.sin(phi) * sideways
    beyond = ca.SX(0.0)
    if shape.strike:
        variables.append(sigma)
        beyond = zone * sigma
    if shape.tilt:
        variables.append(eta)
        swing = half_tangent * (eta[0] * outward + eta[1] * sideways)
        y_axis_used, z_axis = turned(y_axis, swing), turned(z_axis, swing)
        inequalities.append(1.0 - ca.dot(eta, eta))
    else:
        y_axis_used = y_axis
    axes = ca.horzcat(ca.cross(y_axis_used, z_axis), y_axis_used, z_axis)
    equalities = []
    for k, posture in enumerate(q):
        place, turn = symbolic_pose(robot, posture, tool_length)
        equalities.append(place - (position + (beyond - retreats[k]) * z_axis))
        equalities.append(axes_error(turn, axes))
    if robot.joints[0].kind == PRISMATIC:
        equalities += [posture[0] - q[0][0] for posture in q[1:]]

    travels = [(0, reference)] + ([(1, following)] if shape.coupled else [])
    kinematic = sum(part.numel() for part in variables)
    cost, slack_of = ca.SX(0.0), list[int]()
    for k, other in travels:
        change = q[k] - other
        if shape.norm == "l1":
            slack = ca.SX.sym("t", n)
            variables.append(slack)
            inequalities += [slack - change, slack + change]
            cost = cost + ca.dot(weights, slack)
            slack_of += range(k * n, (k + 1) * n)
        else:
            cost = cost + ca.dot(weights, change**2)

    parameters = [position, y_axis, outward, sideways, reference, following, weights, retreats]
    parameters += [tool_length, zone, half_tangent]
    nlp = {
        "x": ca.vertcat(*variables),
        "p": ca.vertcat(*parameters),
        "f": cost,
        "g": ca.vertcat(*equalities, *inequalities),
    }
    count = sum(part.numel() for part in equalities)
    return Programme(
        shape,
        n,
        nlp,
        equalities=count,
        inequalities=nlp["g"].numel() - count,
        kinematic=kinematic,
        slack_of=np.array(slack_of, dtype=np.intp),
    )


def symbolic_pose(robot: Robot, q: Any, tool_length: Any) -> tuple[Any, Any]:
    """Tool centre point (3) and axes (3, 3) as expressions of q (T equation 1)."""
    place, turn = ca.SX(robot.mount[:3, 3]), ca.SX(robot.mount[:3, :3])
    for i, joint in enumerate(robot.joints):
        offset, link = symbolic_link(joint, q[i])
        place, turn = place + turn @ offset, turn @ link
    place = place + turn @ ca.vertcat(0.0, 0.0, tool_length)
    if robot.flange_roll_rad:
        turn = turn @ transform((0.0, 0.0, 0.0), (0.0, 0.0, robot.flange_roll_rad))[:3, :3]
    return place, turn


def symbolic_link(joint: Joint, value: Any) -> tuple[Any, Any]:
    """Origin (3) and axes (3, 3) of a joint's frame in the frame before it.

    The one place that knows which Denavit-Hartenberg parameter a joint's value adds to.

    Args:
        joint: the joint and its link.
        value: its expression [rad or m].
    """
    angle, slide = (value, 0.0) if joint.kind == REVOLUTE else (ca.SX(0.0), value)
    cos, sin = ca.cos(angle + joint.offset_rad), ca.sin(angle + joint.offset_rad)
    cos_twist, sin_twist = _twist(joint.alpha_rad)
    rows = (
        ca.horzcat(cos, -sin * cos_twist, sin * sin_twist),
        ca.horzcat(sin, cos * cos_twist, -cos * sin_twist),
        ca.horzcat(0.0, sin_twist, cos_twist),
    )
    origin = ca.vertcat(joint.a_m * cos, joint.a_m * sin, joint.d_m + slide)
    return origin, ca.vertcat(*rows)


def turned(vector: Any, gibbs: Any) -> Any:
    """A vector (3) turned about `gibbs` (3) by twice the arc tangent of its length."""
    across = ca.cross(gibbs, vector)
    return vector + 2 / (1 + ca.dot(gibbs, gibbs)) * (across + ca.cross(gibbs, across))


def axes_error(turn: Any, wanted: Any) -> Any:
    """The rotation between two frames, 2 tan(angle / 2) along its axis (3).

    The sum of the cross products of like axes alone, 2 sin(angle), is zero at half a turn too.
    """
    across, along = ca.SX.zeros(3), ca.SX(1.0)
    for i in range(3):
        across = across + ca.cross(turn[:, i], wanted[:, i])
        along = along + ca.dot(turn[:, i], wanted[:, i])
    return 2 * across / along


def _twist(alpha: float) -> tuple[float, float]:
    cos, sin = math.cos(alpha), math.sin(alpha)
    return (0.0 if abs(cos) < EXACT_ZERO else cos), (0.0 if abs(sin) < EXACT_ZERO else sin)
