"""Kernels: how the joints of a posture turn when the tool moves.

The inverse of the Jacobian in closed form, from the wrist centre's decoupling: joints 1 to 3 move
the wrist centre, and joints 4 to 6 make up for how they turn the forearm.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.uncertainty.tolerances import SINGULAR_SINE
from solver.compiled import kernel
from solver.kinematics.spherical_wrist import one_branch, wrap
from solver.tolerances import LEAST_DIVISOR


@kernel
def joint_rates(g, q, axes, lever, turn, rates, reach):
    """Derivatives of one posture on its branch.

    Args:
        g: the arm.
        q: the posture, shape (6,) [rad].
        axes: the tool's axes as columns, shape (3, 3).
        lever: distance of the wrist centre behind the point that `turn` turns about [m].
        turn: unit axis through that point, normal to the tool's z, shape (3,).
        rates: written, shape (6, 4): derivative of each joint by a shift of the tool along the base
            axes at fixed orientation [rad/m], and by a turn [rad/rad].
        reach: written, shape (4,): the same derivatives of the reach margin [m/m, m/rad].

    Returns:
        The reach margin of the posture [m]; 0 for a posture that stands for one out of reach.
    """
    t1, t2, t3 = q[0] + g.offsets[0], q[1] + g.offsets[1], q[2] + g.offsets[2]
    t4, t5 = q[3] + g.offsets[3], q[4] + g.offsets[4]
    first = math.cos(t1), math.sin(t1)
    second, both = (math.cos(t2), math.sin(t2)), (math.cos(t2 + t3), math.sin(t2 + t3))
    fourth = math.cos(t4), math.sin(t4)
    return turned_rates(
        g, first, second, both, fourth, math.sin(t5), axes, lever, turn, rates, reach
    )


@kernel
def turned_rates(g, first, second, both, fourth, sin5, axes, lever, turn, rates, reach):
    """`joint_rates` from the posture's turns.

    Args:
        g: the arm.
        first: cosine and sine of theta1.
        second: of theta2.
        both: of theta2 + theta3.
        fourth: of theta4.
        sin5: sine of theta5, whose sign does not matter.
        axes: as for `joint_rates`, and so are the others.
        lever: distance [m].
        turn: axis.
        rates: written.
        reach: written.
    """
    c1, s1 = first
    c23, s23 = both
    c4, s4 = fourth
    fore_r = g.l3 * (c23 * g.cos_beta - s23 * g.sin_beta)
    fore_s = g.l3 * (s23 * g.cos_beta + c23 * g.sin_beta)
    r = g.a2 * second[0] + fore_r
    s = g.a2 * second[1] + fore_s
    x = r + g.a1
    x = math.copysign(max(abs(x), SINGULAR_SINE * g.a2), x)
    area = r * fore_s - s * fore_r  # a2 l3 sin(gamma): zero for a stretched or folded arm
    area = math.copysign(max(abs(area), SINGULAR_SINE * g.a2 * g.l3), area)
    x3 = (c1 * c23, s1 * c23, g.sign1 * s23)
    y3 = (g.sign3 * g.sign1 * s1, -g.sign3 * g.sign1 * c1, 0.0)
    z3 = (g.sign3 * s23 * c1, g.sign3 * s23 * s1, -g.sign3 * g.sign1 * c23)
    cos5 = z3[0] * axes[0, 2] + z3[1] * axes[1, 2] + z3[2] * axes[2, 2]
    square5 = max(sin5**2, SINGULAR_SINE**2)
    rho = math.hypot(x, g.shoulder)
    distance = math.hypot(r, s)
    outer, inner, post = g.a2 + g.l3 - distance, distance - abs(g.a2 - g.l3), rho - abs(g.shoulder)
    for k in range(4):
        if k < 3:
            vx, vy, vz = 1.0 * (k == 0), 1.0 * (k == 1), 1.0 * (k == 2)
            wx, wy, wz = 0.0, 0.0, 0.0
        else:
            wx, wy, wz = turn[0], turn[1], turn[2]
            vx = -lever * (wy * axes[2, 2] - wz * axes[1, 2])
            vy = -lever * (wz * axes[0, 2] - wx * axes[2, 2])
            vz = -lever * (wx * axes[1, 2] - wy * axes[0, 2])
        along = vx * c1 + vy * s1
        dq1 = (vy * c1 - vx * s1) / x
        ur = along - g.shoulder * g.sign1 * dq1
        us = g.sign1 * vz
        dq2 = (ur * fore_r + us * fore_s) / area
        dq3 = -(s * us + r * ur) / area
        tilt = (dq2 + dq3) * g.sign1
        wx, wy, wz = wx - tilt * s1, wy + tilt * c1, wz - dq1
        about3 = wx * z3[0] + wy * z3[1] + wz * z3[2]
        about5 = wx * axes[0, 2] + wy * axes[1, 2] + wz * axes[2, 2]
        rates[0, k], rates[1, k], rates[2, k] = dq1, dq2, dq3
        rates[3, k] = (about3 - cos5 * about5) / square5
        rates[4, k] = g.sign4 * (
            s4 * (wx * x3[0] + wy * x3[1] + wz * x3[2]) - c4 * (wx * y3[0] + wy * y3[1])
        )
        rates[5, k] = (about5 - cos5 * about3) / square5
        if post <= min(outer, inner):
            reach[k] = (along * x + g.shoulder * g.sign1 * (vx * s1 - vy * c1)) / max(
                rho, LEAST_DIVISOR
            )
        else:
            outward = (r * ur + s * us) / max(distance, LEAST_DIVISOR)
            reach[k] = -outward if outer <= inner else outward
    return min(outer, inner, post)


@kernel
def shifted(g, position, delta, axes, branch, near, q):
    """Writes the posture at a shifted tool position to q, on the turns nearest to `near`, (6,).

    Returns the reach margin [m].
    """
    place = np.empty(3)
    for i in range(3):
        place[i] = position[i] + delta[i]
    margin = one_branch(g, place, axes, branch, q)
    for i in range(6):
        q[i] = near[i] + wrap(q[i] - near[i])
    return margin
