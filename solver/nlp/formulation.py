"""The task definition as a nonlinear programme, built once for a robot and fed parameters.

Variables    q        thinning posture          (6)
             q_s      standby posture           (6)
             phi      approach angle            (1)
             t        effort of each joint      (6), l1 only: t >= |q - reference|
Parameters   p, y, u, v   target, tool y axis, approach direction at 0 and at a quarter turn
             reference, weights, standoff, tool length
Minimise     sum w t  (l1)   or   sum w (q - reference)^2  (l2)
Subject to   position(q)   = p                 axes(q)   = [y x z, y, z](phi)
             position(q_s) = p - standoff z    axes(q_s) = the same
             limits of q and q_s, phi inside the warm start's arc
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca

from solver.robots.model import REVOLUTE, Robot
from solver.robots.rigid import transform
from solver.tolerances import EXACT_ZERO


@dataclass(frozen=True)
class Programme:
    """A CasADi programme: what `casadi.nlpsol` takes, and the sizes of its parts.

    Attributes:
        nlp: symbols x, p and expressions f, g.
        equalities: the first this many constraints are 0; the others are not negative.
        slacks: how many effort variables stand at the end of x.
    """

    nlp: dict[str, ca.SX]
    equalities: int
    slacks: int


@lru_cache(maxsize=16)
def build_programme(robot: Robot, norm: str) -> Programme:
    """The programme of a robot for one norm; expressions only, so it is shared by all tools."""
    n = len(robot.joints)
    q, q_standby, phi = ca.SX.sym("q", n), ca.SX.sym("q_s", n), ca.SX.sym("phi")
    position, y_axis = ca.SX.sym("p", 3), ca.SX.sym("y", 3)
    outward, sideways = ca.SX.sym("u", 3), ca.SX.sym("v", 3)
    reference, weights = ca.SX.sym("reference", n), ca.SX.sym("weights", n)
    standoff, tool_length = ca.SX.sym("standoff"), ca.SX.sym("tool_length")

    z_axis = ca.cos(phi) * outward + ca.sin(phi) * sideways
    axes = ca.horzcat(ca.cross(y_axis, z_axis), y_axis, z_axis)
    equalities = []
    for posture, retreat in ((q, 0.0), (q_standby, standoff)):
        place, turn = symbolic_pose(robot, posture, tool_length)
        equalities.append(place - (position - retreat * z_axis))
        equalities.append(axes_error(turn, axes))

    change = q - reference
    variables, inequalities, slacks = [q, q_standby, phi], [], 0
    if norm == "l1":
        slack = ca.SX.sym("t", n)
        variables.append(slack)
        inequalities += [slack - change, slack + change]
        cost, slacks = ca.dot(weights, slack), n
    else:
        cost = ca.dot(weights, change**2)

    parameters = ca.vertcat(
        position, y_axis, outward, sideways, reference, weights, standoff, tool_length
    )
    nlp = {
        "x": ca.vertcat(*variables),
        "p": parameters,
        "f": cost,
        "g": ca.vertcat(*equalities, *inequalities),
    }
    return Programme(nlp, equalities=12, slacks=slacks)


def symbolic_pose(robot: Robot, q: ca.SX, tool_length: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Tool centre point (3) and axes (3, 3) as expressions of q (T equation 1)."""
    place, turn = ca.SX(robot.mount[:3, 3]), ca.SX(robot.mount[:3, :3])
    for i, joint in enumerate(robot.joints):
        angle, slide = (q[i], 0.0) if joint.kind == REVOLUTE else (ca.SX(0.0), q[i])
        cos, sin = ca.cos(angle + joint.offset_rad), ca.sin(angle + joint.offset_rad)
        cos_twist, sin_twist = _twist(joint.alpha_rad)
        place = place + turn @ ca.vertcat(joint.a_m * cos, joint.a_m * sin, joint.d_m + slide)
        rows = (
            ca.horzcat(cos, -sin * cos_twist, sin * sin_twist),
            ca.horzcat(sin, cos * cos_twist, -cos * sin_twist),
            ca.horzcat(0.0, sin_twist, cos_twist),
        )
        turn = turn @ ca.vertcat(*rows)
    place = place + turn @ ca.vertcat(0.0, 0.0, tool_length)
    if robot.flange_roll_rad:
        turn = turn @ transform((0.0, 0.0, 0.0), (0.0, 0.0, robot.flange_roll_rad))[:3, :3]
    return place, turn


def axes_error(turn: ca.SX, wanted: ca.SX) -> ca.SX:
    """Half the sum of cross products of like axes: the small rotation between two frames (3)."""
    error = ca.SX.zeros(3)
    for i in range(3):
        error = error + ca.cross(turn[:, i], wanted[:, i]) / 2
    return error


def _twist(alpha: float) -> tuple[float, float]:
    cos, sin = math.cos(alpha), math.sin(alpha)
    return (0.0 if abs(cos) < EXACT_ZERO else cos), (0.0 if abs(sin) < EXACT_ZERO else sin)
