"""How fast the joints of an arm with a spherical wrist turn while its tool moves along its z axis.

The orientation is kept, so all follows from where the tool's z axis points in the forearm's frame:
joints 1 to 3 move the wrist centre along it, joints 4 to 6 make up for how they turn the forearm.
With R36's third column (r13, r23, r33), x = r + a1 the wrist centre ahead of the waist's axis and g
the elbow's angle (as in `solver.kinematics.spherical_wrist`), for a unit of tool travel:

    x q1' = -s1 s3 r23               r' = cos23 r13 + s3 sin23 r33 - s1 shoulder q1'
                                     s' = sin23 r13 - s3 cos23 r33
    a2 sin g q2' = cos(2 + g) r' + sin(2 + g) s'
    l3 sin g (q2' + q3') = -(cos2 r' + sin2 s')
    w = (s1 sin23 q1', s3 (q2' + q3'), -s1 s3 cos23 q1')   the forearm's turning, in its frame
    sin5 q4' = r33 (w . e) - w_z sin5,   q5' = w x e,   sin5 q6' = -(w . e),   e = s5 (cos4, sin4)

Rates are quotients. Their numerators and denominators stay finite and smooth where the arm is
singular, so a margin made of them does as well.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.compiled import inlined, kernel
from solver.kinematics.tolerances import SWING_SHARE
from solver.tolerances import JOINT_RATE_RAD_M, LEAST_DIVISOR

_MOST = 2.0 * JOINT_RATE_RAD_M
_SLOWNESS = 1.0 / JOINT_RATE_RAD_M
# Divisions by what is the same for all rows are products with a quotient, which the compiler takes
# out of a loop over rows.


@inlined
def _held(value):
    """A rate cut where no posture is feasible: twice the limit, which q2' + q3' may still reach."""
    return min(max(value, -_MOST), _MOST)


@inlined
def _divisor(value):
    return math.copysign(max(abs(value), LEAST_DIVISOR), value)


@inlined
def straight_rates(g, cos2, sin2, cos3, sin3, cos4, sin4, cos5, sin5):
    """Rates as quotients: x, x q1', sin g, sin g q2', sin g q3', sin5 q4', q5', sin5 q6' [rad/m].

    Cosines and sines are those of theta2 to theta5; x and what is multiplied by it in metres.
    """
    r13, r23, r33 = g.sign5 * cos4 * sin5, g.sign5 * sin4 * sin5, -g.sign4 * g.sign5 * cos5
    cos23, sin23 = cos2 * cos3 - sin2 * sin3, sin2 * cos3 + cos2 * sin3
    cos_g, sin_g = cos3 * g.cos_beta - sin3 * g.sin_beta, sin3 * g.cos_beta + cos3 * g.sin_beta
    cos2g, sin2g = cos2 * cos_g - sin2 * sin_g, sin2 * cos_g + cos2 * sin_g
    x = g.a1 + g.a2 * cos2 + g.l3 * cos2g
    across = -g.sign1 * g.sign3 * r23
    rate1 = _held(across / _divisor(x))
    r = cos23 * r13 + g.sign3 * sin23 * r33 - g.sign1 * g.shoulder * rate1
    s = sin23 * r13 - g.sign3 * cos23 * r33
    at2 = (cos2g * r + sin2g * s) * (1.0 / g.a2)
    at23 = -(cos2 * r + sin2 * s) * (1.0 / g.l3)
    rate23 = _held(at23 / _divisor(sin_g))
    wx, wy, wz = g.sign1 * sin23 * rate1, g.sign3 * rate23, -g.sign1 * g.sign3 * cos23 * rate1
    along = g.sign5 * (wx * cos4 + wy * sin4)
    rate5 = g.sign5 * (wx * sin4 - wy * cos4)
    return x, across, sin_g, at2, at23 - at2, r33 * along - wz * sin5, rate5, -along


@inlined
def rate_room(g, cos2, sin2, cos3, sin3, cos4, sin4, cos5, sin5):
    """What the joints are short of JOINT_RATE_RAD_M: not negative where none turns faster.

    The smallest denominator less numerator over the limit: a sine, x as a share of the arm's links.
    """
    x, at1, sin_g, at2, at3, at4, rate5, at6 = straight_rates(
        g, cos2, sin2, cos3, sin3, cos4, sin4, cos5, sin5
    )
    waist = (abs(x) - abs(at1) * _SLOWNESS) * (1.0 / (g.a2 + g.l3))
    elbow = abs(sin_g) - max(abs(at2), abs(at3)) * _SLOWNESS
    wrist = abs(sin5) - max(abs(at4), abs(at6)) * _SLOWNESS
    return min(min(waist, elbow), min(wrist, 1.0 - abs(rate5) * _SLOWNESS))


@inlined
def ahead_share(g, cos2, sin2, cos3, sin3):
    """x, how far the wrist centre is ahead of the waist's axis, as a share of the arm's links."""
    cos_g, sin_g = cos3 * g.cos_beta - sin3 * g.sin_beta, sin3 * g.cos_beta + cos3 * g.sin_beta
    length = 1.0 / (g.a2 + g.l3)
    return (g.a1 + g.a2 * cos2 + g.l3 * (cos2 * cos_g - sin2 * sin_g)) * length


@inlined
def swing_room(ax, ay, bx, by, per_metre):
    """What a point's direction in the plane is short of the highest rate as it moves from a to b.

    Where it comes nearest to the origin, its distance less what that would have to be, for joints
    that swing round a singular posture between two rows of a cut-in, so many a metre.
    """
    dx, dy = bx - ax, by - ay
    share = -(ax * dx + ay * dy) / max(dx * dx + dy * dy, LEAST_DIVISOR)
    share = min(max(share, 0.0), 1.0)
    x, y = ax + share * dx, ay + share * dy
    nearest = math.sqrt(x * x + y * y)
    swing = SWING_SHARE * _SLOWNESS * per_metre * abs(ax * by - ay * bx)
    return nearest - swing / max(nearest, LEAST_DIVISOR)


@kernel
def posture_rate_room(g, q):
    """`rate_room` of a posture, shape (6,) [rad]."""
    t2, t3, t4, t5 = (
        q[1] + g.offsets[1],
        q[2] + g.offsets[2],
        q[3] + g.offsets[3],
        q[4] + g.offsets[4],
    )
    return rate_room(
        g, math.cos(t2), math.sin(t2), math.cos(t3), math.sin(t3),
        math.cos(t4), math.sin(t4), math.cos(t5), math.sin(t5),
    )  # fmt: skip


@kernel
def posture_rates(g, q, rates):
    """Writes how fast each joint turns, as magnitudes, shape (6,) [rad/m]; held where infinite."""
    t2, t3, t4, t5 = (
        q[1] + g.offsets[1],
        q[2] + g.offsets[2],
        q[3] + g.offsets[3],
        q[4] + g.offsets[4],
    )
    x, at1, sin_g, at2, at3, at4, rate5, at6 = straight_rates(
        g, math.cos(t2), math.sin(t2), math.cos(t3), math.sin(t3),
        math.cos(t4), math.sin(t4), math.cos(t5), math.sin(t5),
    )  # fmt: skip
    sin5 = max(abs(math.sin(t5)), LEAST_DIVISOR)
    rates[0] = abs(at1 / _divisor(x))
    rates[1], rates[2] = abs(at2 / _divisor(sin_g)), abs(at3 / _divisor(sin_g))
    rates[3], rates[4], rates[5] = abs(at4) / sin5, abs(rate5), abs(at6) / sin5


@kernel
def rows_rate_room(g, rows, room):
    """Writes `posture_rate_room` of rows of shape (n, 6) to room, shape (n,)."""
    for n in range(len(rows)):
        room[n] = posture_rate_room(g, rows[n])


@kernel
def between_rate_room(g, before, after, spacing):
    """The smallest `swing_room` of joints 1, 4 and 6 between two postures, shape (6,) [rad]."""
    least = math.inf
    for joint in (0, 3, 5):
        place = np.empty(4)
        for end, q in enumerate((before, after)):
            if joint == 0:
                t2, t3 = q[1] + g.offsets[1], q[2] + g.offsets[2]
                size = ahead_share(g, math.cos(t2), math.sin(t2), math.cos(t3), math.sin(t3))
            else:
                size = math.sin(q[4] + g.offsets[4])
            turn = q[joint] + g.offsets[joint]
            place[2 * end], place[2 * end + 1] = size * math.cos(turn), size * math.sin(turn)
        least = min(least, swing_room(place[0], place[1], place[2], place[3], 1.0 / spacing))
    return least
