"""Kernel: whether joints certainly turn too fast along the cut-in in all postures of a box.

The equations of `solver.kinematics.straight_rates` over intervals.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

from solver.approach.bounds.intervals import (
    add,
    cosine,
    multiply,
    outward,
    scale,
    shifted,
    sine,
    subtract,
)
from solver.approach.bounds.tolerances import ACCEPTED_RATE_RAD_M
from solver.compiled import kernel

_UNKNOWN = (-1e30, 1e30)


@kernel
def least_size(a):
    """The least absolute value of an interval."""
    return max(a[0], -a[1], 0.0)


@kernel
def most_size(a):
    """The largest absolute value of an interval."""
    return max(-a[0], a[1])


@kernel
def quotient(a, b):
    """Quotient a / b; unbounded where b may be 0."""
    if b[0] <= 0.0 <= b[1]:
        return _UNKNOWN
    return multiply(a, outward(1.0 / b[1], 1.0 / b[0]))


@kernel
def exceeds(numerator, denominator):
    """Whether a rate, the quotient of two intervals, is certainly above what is accepted."""
    return least_size(numerator) > ACCEPTED_RATE_RAD_M * most_size(denominator)


@kernel
def too_fast(g, q):
    """Whether a joint turns faster than is accepted in every posture of a box, shape (6, 2)."""
    t2, t3 = shifted((q[1, 0], q[1, 1]), g.offsets[1]), shifted((q[2, 0], q[2, 1]), g.offsets[2])
    t4, t5 = shifted((q[3, 0], q[3, 1]), g.offsets[3]), shifted((q[4, 0], q[4, 1]), g.offsets[4])
    elbow, t23 = shifted(t3, g.beta), add(t2, t3)
    t2g = add(t2, elbow)
    sin_g, cos23, sin23 = sine(elbow), cosine(t23), sine(t23)
    cos4, sin4, sin5 = cosine(t4), sine(t4), sine(t5)
    r13, r23 = scale(g.sign5, multiply(cos4, sin5)), scale(g.sign5, multiply(sin4, sin5))
    r33 = scale(-g.sign4 * g.sign5, cosine(t5))
    reach = add(scale(g.a2, cosine(t2)), scale(g.l3, cosine(t2g)))
    x, across = shifted(reach, g.a1), scale(-g.sign1 * g.sign3, r23)
    if exceeds(across, x):
        return True
    rate1 = quotient(across, x)
    r = add(multiply(cos23, r13), scale(g.sign3, multiply(sin23, r33)))
    if g.shoulder != 0.0:
        r = subtract(r, scale(g.sign1 * g.shoulder, rate1))
    s = subtract(multiply(sin23, r13), scale(g.sign3, multiply(cos23, r33)))
    at2 = scale(1.0 / g.a2, add(multiply(cosine(t2g), r), multiply(sine(t2g), s)))
    at23 = scale(-1.0 / g.l3, add(multiply(cosine(t2), r), multiply(sine(t2), s)))
    if exceeds(at2, sin_g) or exceeds(subtract(at23, at2), sin_g):
        return True
    rate23 = quotient(at23, sin_g)
    wx, wy = scale(g.sign1, multiply(sin23, rate1)), scale(g.sign3, rate23)
    wz = scale(-g.sign1 * g.sign3, multiply(cos23, rate1))
    along = scale(g.sign5, add(multiply(wx, cos4), multiply(wy, sin4)))
    about4 = subtract(multiply(r33, along), multiply(wz, sin5))
    return exceeds(along, sin5) or exceeds(about4, sin5)
