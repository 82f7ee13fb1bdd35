"""Kernels: intervals that hold the postures of all approach angles of a cell, on one branch.

The closed form of `solver.kinematics.spherical_wrist`, its equations in its order, over intervals.
Every enclosure also holds what that module computes in floating point: quantities that a branch
decides on are widened by its rounding errors.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

from solver.approach.bounds.intervals import (
    WHOLE,
    add,
    j_add,
    j_arc_cosine,
    j_arc_tangent,
    j_cosine,
    j_multiply,
    j_root,
    j_scale,
    j_sine,
    j_square,
    j_subtract,
    multiply,
    number,
    outward,
    shifted,
    widened,
)
from solver.approach.bounds.tolerances import ENCLOSURE_ROUNDING, ENCLOSURE_SINGULAR_WRIST
from solver.compiled import kernel


@kernel
def _turning(cos, sin, at_zero, at_quarter):
    """Jet of cos(phi) at_zero + sin(phi) at_quarter."""
    return j_add(j_scale(at_zero, cos), j_scale(at_quarter, sin))


@kernel
def _arm(g, x, y, z, branch):
    """Jets of theta1, theta2, theta3, theta2 + theta3, and the most that the reach margin is."""
    across_squared = j_add(j_square(x), j_square(y))
    across = j_root(across_squared)
    forward = across
    beside = math.inf
    if g.shoulder != 0.0:
        forward = j_root(j_subtract(across_squared, j_square(number(g.shoulder))))
        beside = across[0][1] - abs(g.shoulder)
    if branch // 4 == 1:
        forward = j_scale(-1.0, forward)
    theta1 = j_subtract(j_arc_tangent(y, x), j_arc_tangent(number(-g.sign1 * g.shoulder), forward))
    r = j_subtract(forward, number(g.a1))
    s = j_scale(g.sign1, j_subtract(z, number(g.d1)))
    squared = j_add(j_square(r), j_square(s))
    distance = j_root(squared)
    reach = min(g.a2 + g.l3 - distance[0][0], distance[0][1] - abs(g.a2 - g.l3))
    links = j_add(j_square(number(g.a2)), j_square(number(g.l3)))
    cos_gamma = j_scale(1.0 / (2.0 * g.a2 * g.l3), j_subtract(squared, links))
    gamma = j_arc_cosine(widened(cos_gamma, ENCLOSURE_ROUNDING))
    if branch // 2 % 2 == 1:
        gamma = j_scale(-1.0, gamma)
    sine, cosine, elevation = j_sine(gamma), j_cosine(gamma), j_arc_tangent(s, r)
    at_shoulder = j_arc_tangent(j_scale(g.l3, sine), j_add(number(g.a2), j_scale(g.l3, cosine)))
    # The triangle's angle at the wrist, gamma less the one at the shoulder, as one function.
    at_wrist = j_arc_tangent(j_scale(g.a2, sine), j_add(number(g.l3), j_scale(g.a2, cosine)))
    theta2 = j_subtract(elevation, at_shoulder)
    theta3 = j_subtract(gamma, number(g.beta))
    return (
        theta1,
        theta2,
        theta3,
        j_subtract(j_add(elevation, at_wrist), number(g.beta)),
        min(reach, beside),
    )


@kernel
def _through(sine1, cosine1, sine23, cosine23, g, x, y, z):
    """Components of a direction (x, y, z) along the third frame's x and z axes."""
    level = j_add(j_multiply(cosine1, x), j_multiply(sine1, y))
    upright = j_scale(g.sign1, z)
    along_x = j_add(j_multiply(cosine23, level), j_multiply(sine23, upright))
    along_z = j_subtract(j_multiply(sine23, level), j_multiply(cosine23, upright))
    return along_x, j_scale(g.sign3, along_z)


@kernel
def _wrist(task, theta1, theta23, cos, sin, z_axis, wrist):
    """Jets of theta4, theta5, theta6."""
    g = task.geometry
    c1, s1, c23, s23 = j_cosine(theta1), j_sine(theta1), j_cosine(theta23), j_sine(theta23)
    y, u, v = task.y_axis, task.outward, task.sideways
    x_axis = (
        _turning(cos, sin, y[1] * u[2] - y[2] * u[1], y[1] * v[2] - y[2] * v[1]),
        _turning(cos, sin, y[2] * u[0] - y[0] * u[2], y[2] * v[0] - y[0] * v[2]),
        _turning(cos, sin, y[0] * u[1] - y[1] * u[0], y[0] * v[1] - y[1] * v[0]),
    )
    r13, r33 = _through(s1, c1, s23, c23, g, z_axis[0], z_axis[1], z_axis[2])
    _, r31 = _through(s1, c1, s23, c23, g, x_axis[0], x_axis[1], x_axis[2])
    _, r32 = _through(s1, c1, s23, c23, g, number(y[0]), number(y[1]), number(y[2]))
    beside = j_subtract(j_multiply(s1, z_axis[0]), j_multiply(c1, z_axis[1]))
    r13 = widened(r13, ENCLOSURE_ROUNDING)
    r23 = widened(j_scale(g.sign3 * g.sign1, beside), ENCLOSURE_ROUNDING)
    r31, r32 = widened(r31, ENCLOSURE_ROUNDING), widened(r32, ENCLOSURE_ROUNDING)
    sin5 = j_root(j_add(j_square(r13), j_square(r23)))
    cos5 = widened(j_scale(-g.sign4 * g.sign5, r33), ENCLOSURE_ROUNDING)
    sign = 1.0 if wrist == 0 else -1.0
    theta5 = j_arc_tangent(j_scale(sign, sin5), cos5)
    theta4 = j_arc_tangent(j_scale(sign * g.sign5, r23), j_scale(sign * g.sign5, r13))
    theta6 = j_arc_tangent(j_scale(-sign * g.sign4, r32), j_scale(sign * g.sign4, r31))
    if sin5[0][0] < ENCLOSURE_SINGULAR_WRIST:
        theta4 = WHOLE, theta4[1]
        theta6 = WHOLE, theta6[1]
    return theta4, theta5, theta6


@kernel
def natural_enclosure(task, low, high, retreat, branch, q, slopes):
    """Writes intervals of the joints over the angles low to high, and of their derivatives.

    Args:
        task: a `CutInTask`.
        low: least approach angle of the cell [rad].
        high: largest [rad].
        retreat: distance behind the target [m].
        branch: inverse kinematics branch.
        q: written, shape (6, 2) [rad], whole turns open; `WHOLE` where nothing is known.
        slopes: written, shape (6, 2), derivatives with respect to the approach angle.

    Returns:
        The most that the reach margin is in the cell [m]. Out of reach the intervals are those of
        the posture stretched or folded towards the pose.
    """
    g = task.geometry
    angle = (low, high), (1.0, 1.0)
    cos, sin = j_cosine(angle), j_sine(angle)
    u, v, p = task.outward, task.sideways, task.position
    z_axis = (
        _turning(cos, sin, u[0], v[0]),
        _turning(cos, sin, u[1], v[1]),
        _turning(cos, sin, u[2], v[2]),
    )
    back = g.tool_length + retreat
    theta1, theta2, theta3, theta23, reach = _arm(
        g,
        j_subtract(number(p[0]), j_scale(back, z_axis[0])),
        j_subtract(number(p[1]), j_scale(back, z_axis[1])),
        j_subtract(number(p[2]), j_scale(back, z_axis[2])),
        branch,
    )
    theta4, theta5, theta6 = _wrist(task, theta1, theta23, cos, sin, z_axis, branch % 2)
    for joint, theta in enumerate((theta1, theta2, theta3, theta4, theta5, theta6)):
        q[joint, 0], q[joint, 1] = shifted(theta[0], -g.offsets[joint])
        if q[joint, 1] - q[joint, 0] >= 2 * math.pi:
            q[joint, 0], q[joint, 1] = WHOLE
        slopes[joint, 0], slopes[joint, 1] = theta[1]
    return reach


@kernel
def half_length(low, high):
    """The largest distance of an angle of a cell from its middle, (low + high) / 2 as rounded."""
    angle = (low + high) / 2
    return outward(0.0, max(high - angle, angle - low))[1]


@kernel
def enclosure(task, low, high, retreat, branch, q, slopes, middle):
    """As `natural_enclosure`, cut with the mean value form q(m) + q'(cell) (phi - m).

    Also writes the intervals at the middle angle m of the cell, shape (6, 2), on the same turns.
    """
    angle = (low + high) / 2
    natural_enclosure(task, angle, angle, retreat, branch, middle, slopes)
    reach = natural_enclosure(task, low, high, retreat, branch, q, slopes)
    half = half_length(low, high)
    for i in range(6):
        if q[i, 1] - q[i, 0] >= math.pi or middle[i, 1] - middle[i, 0] >= math.pi:
            continue
        apart = (q[i, 0] + q[i, 1] - middle[i, 0] - middle[i, 1]) / 2
        turns = 2 * math.pi * math.floor(apart / (2 * math.pi) + 0.5)
        middle[i, 0], middle[i, 1] = shifted((middle[i, 0], middle[i, 1]), turns)
        change = multiply((slopes[i, 0], slopes[i, 1]), (-half, half))
        low_end, high_end = add((middle[i, 0], middle[i, 1]), change)
        q[i, 0], q[i, 1] = max(q[i, 0], low_end), min(q[i, 1], high_end)
    return reach
