"""Kernels: how far a target may be moved until one posture meets one of its limits.

The distance, in the space of the target's displacements at fixed orientation, to a limit: a
nearest-point problem, solved by successive linearisation (the iteration of Hasofer, Lind, Rackwitz
and Fiessler, known from structural reliability).
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.task.constraints import REACH
from solver.approach.uncertainty.sensitivity import joint_rates, shifted
from solver.approach.uncertainty.tolerances import (
    DISPLACEMENT_ROUNDS,
    DISPLACEMENT_STEP_M,
    DISPLACEMENT_STEP_RELATIVE,
    STRAIGHT_WRIST_SINE,
)
from solver.compiled import kernel
from solver.tolerances import LEAST_DIVISOR

LOWER_5, UPPER_5 = 2 * 4, 2 * 4 + 1
"""The limits of joint 5, in whose place a straight wrist may stand."""


@kernel
def limit_distance(g, position, axes, branch, q, kind, limit, delta):
    """Length of the smallest shift of the tool at which a joint, or the reach, meets its limit [m].

    Args:
        g: the arm.
        position: of the tool, shape (3,) [m].
        axes: its orientation, shape (3, 3).
        branch: inverse kinematics branch.
        q: the posture there, shape (6,) [rad].
        kind: index of the joint; REACH for the reach margin.
        limit: the joint's limit [rad]; 0 for the reach.
        delta: where the search starts, a shift inside the reach; written, the shift found, shape
            (3,) [m].
    """
    rates, reach_rates, turn = np.empty((6, 4)), np.empty(4), np.zeros(3)
    at, new = np.empty(6), np.zeros(3)
    shifted(g, position, delta, axes, branch, q, at)
    for _ in range(DISPLACEMENT_ROUNDS):
        reach = joint_rates(g, at, axes, 0.0, turn, rates, reach_rates)
        gradient = reach_rates if kind == REACH else rates[kind]
        missing = limit - (reach if kind == REACH else at[kind])
        square = 0.0
        for i in range(3):
            square += gradient[i] * gradient[i]
            missing += gradient[i] * delta[i]
        for i in range(3):
            new[i] = gradient[i] * missing / square
        change, length = step_inside(g, position, axes, branch, q, delta, new, at)
        if change <= DISPLACEMENT_STEP_RELATIVE**2 * length:
            break
    return math.sqrt(delta[0] ** 2 + delta[1] ** 2 + delta[2] ** 2)


@kernel
def step_inside(g, position, axes, branch, q, delta, new, at):
    """Moves delta to `new`, or as far as stays inside the reach; writes the posture there to `at`.

    Returns the squares of how far it moved and of its length [m^2].
    """
    change, length = 0.0, 0.0
    for i in range(3):
        change += (new[i] - delta[i]) ** 2
        length += new[i] * new[i]
    while shifted(g, position, new, axes, branch, q, at) < 0.0 and change > DISPLACEMENT_STEP_M**2:
        change, length = change / 4, 0.0
        for i in range(3):
            new[i] = (new[i] + delta[i]) / 2
            length += new[i] * new[i]
    delta[:] = new
    return change, length


@kernel
def straight_wrist_distance(g, position, axes, branch, q, delta):
    """Length of the smallest shift of the tool at which the wrist is straight [m].

    Two equations, sin q5 cos q4 = sin q5 sin q4 = 0: q5 itself is a cone with its tip there, which
    no linearisation meets. Arguments as for `limit_distance`; delta starts at zero.
    """
    rates, reach_rates, at = np.empty((6, 4)), np.empty(4), q.copy()
    first, second, new = np.empty(3), np.empty(3), np.zeros(3)
    for _ in range(DISPLACEMENT_ROUNDS):
        joint_rates(g, at, axes, 0.0, axes[:, 1], rates, reach_rates)
        turn4, turn5 = at[3] + g.offsets[3], at[4] + g.offsets[4]
        c4, s4, c5, s5 = math.cos(turn4), math.sin(turn4), math.cos(turn5), math.sin(turn5)
        value1, value2 = -s5 * c4, -s5 * s4
        m11, m12, m22 = 0.0, 0.0, 0.0
        for i in range(3):
            first[i] = c5 * c4 * rates[4, i] - s5 * s4 * rates[3, i]
            second[i] = c5 * s4 * rates[4, i] + s5 * c4 * rates[3, i]
            value1 += first[i] * delta[i]
            value2 += second[i] * delta[i]
            m11 += first[i] * first[i]
            m12 += first[i] * second[i]
            m22 += second[i] * second[i]
        determinant = max(m11 * m22 - m12 * m12, LEAST_DIVISOR)
        along = (m22 * value1 - m12 * value2) / determinant
        across = (m11 * value2 - m12 * value1) / determinant
        for i in range(3):
            new[i] = along * first[i] + across * second[i]
        change, length = step_inside(g, position, axes, branch, q, delta, new, at)
        near_tip = abs(math.sin(at[4] + g.offsets[4])) < STRAIGHT_WRIST_SINE
        if near_tip or change <= DISPLACEMENT_STEP_RELATIVE**2 * length:
            break
    return math.sqrt(delta[0] ** 2 + delta[1] ** 2 + delta[2] ** 2)


@kernel
def first_order(g, lower, upper, q, axes, rates, reach_rates, distances):
    """Fills the distances at which each limit is met to first order, shape (LIMITS,) [m].

    Negative where a limit is broken. A straight wrist before a limit of joint 5 stands in its
    place: to keep the direction that joint 4 gives, the way there is normal to that one's gradient.
    """
    reach = joint_rates(g, q, axes, 0.0, axes[:, 1], rates, reach_rates)
    for i in range(6):
        slope = math.sqrt(rates[i, 0] ** 2 + rates[i, 1] ** 2 + rates[i, 2] ** 2)
        distances[2 * i] = (q[i] - lower[i]) / max(slope, LEAST_DIVISOR)
        distances[2 * i + 1] = (upper[i] - q[i]) / max(slope, LEAST_DIVISOR)
    below, above = straight_wrists(g, q)
    if below > lower[4] or above < upper[4]:
        a, b, ab = 0.0, 0.0, 0.0
        for i in range(3):
            a += rates[4, i] * rates[4, i]
            b += rates[3, i] * rates[3, i]
            ab += rates[4, i] * rates[3, i]
        slope = math.sqrt(max(a - ab * ab / max(b, LEAST_DIVISOR), 0.0))
        if below > lower[4]:
            distances[LOWER_5] = (q[4] - below) / max(slope, LEAST_DIVISOR)
        if above < upper[4]:
            distances[UPPER_5] = (above - q[4]) / max(slope, LEAST_DIVISOR)
    slope = math.sqrt(reach_rates[0] ** 2 + reach_rates[1] ** 2 + reach_rates[2] ** 2)
    distances[2 * REACH] = reach / max(slope, LEAST_DIVISOR)


@kernel
def straight_wrists(g, q):
    """The values of joint 5 around a posture's at which the wrist is straight [rad].

    On one branch sin q5 keeps its sign: the tool cannot pass a straight wrist without a jump.
    """
    below = math.pi * math.floor((q[4] + g.offsets[4]) / math.pi) - g.offsets[4]
    return below, below + math.pi


@kernel
def behind(pose, retreat, position):
    """Writes the tool's place at a retreat behind a pose, shape (3,) [m]."""
    for i in range(3):
        position[i] = pose[i, 3] - retreat * pose[i, 2]
