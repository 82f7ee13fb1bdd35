"""Kernels: interval arithmetic with outward rounding, and jets: a value with its derivative.

An interval is a tuple (low, high); a jet is a tuple of two intervals, (value, slope), that enclose
a function of the approach angle and its derivative over a cell of angles. A result is moved outward
by more than its rounding error: ROUNDING_STEP of itself for the four operations and the square
root, which IEEE 754 rounds to the nearest number, LIBRARY_STEPS times that for sin, cos, acos and
atan2. A slope that has no bound is STEEPEST_SLOPE long.

Source: R. E. Moore, Interval Analysis, 1966, chapters 4 and 6.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

from solver.approach.bounds.tolerances import (
    ANGLE_ROUNDING_RAD,
    LEAST_WIDTH,
    LIBRARY_STEPS,
    ROUNDING_STEP,
    STEEPEST_SLOPE,
)
from solver.compiled import kernel

_TURN = 2.0 * math.pi
WHOLE = (-1e3, 1e3)
"""An angle of which nothing is known: longer than a turn, whatever is added to it."""


@kernel
def outward(low, high, steps=1.0):
    """The interval with both ends moved outward by `steps` relative rounding steps."""
    return (
        low - (steps * ROUNDING_STEP * abs(low) + LEAST_WIDTH),
        high + (steps * ROUNDING_STEP * abs(high) + LEAST_WIDTH),
    )


@kernel
def add(a, b):
    """Sum a + b."""
    return outward(a[0] + b[0], a[1] + b[1])


@kernel
def subtract(a, b):
    """Difference a - b."""
    return outward(a[0] - b[1], a[1] - b[0])


@kernel
def multiply(a, b):
    """Product a b."""
    p, q, r, s = a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]
    return outward(min(min(p, q), min(r, s)), max(max(p, q), max(r, s)))


@kernel
def scale(factor, a):
    """Product of a number and an interval."""
    if factor >= 0.0:
        return outward(factor * a[0], factor * a[1])
    return outward(factor * a[1], factor * a[0])


@kernel
def square(a):
    """Square of an interval, never negative."""
    low, high = outward(min(a[0] * a[0], a[1] * a[1]), max(a[0] * a[0], a[1] * a[1]))
    return (0.0 if a[0] <= 0.0 <= a[1] else max(low, 0.0)), high


@kernel
def root(a):
    """Square root over the part of an interval that is not negative."""
    low, high = outward(math.sqrt(max(a[0], 0.0)), math.sqrt(max(a[1], 0.0)))
    return max(low, 0.0), high


@kernel
def over_positive(a, b):
    """Quotient a / b for b > 0, unbounded where b may be all but 0."""
    if b[0] < LEAST_WIDTH:
        return -STEEPEST_SLOPE, STEEPEST_SLOPE
    low, high = multiply(a, outward(1.0 / b[1], 1.0 / b[0]))
    return max(low, -STEEPEST_SLOPE), min(high, STEEPEST_SLOPE)


@kernel
def cosine(a):
    """Cosine of an interval."""
    if a[1] - a[0] >= _TURN:
        return -1.0, 1.0
    first, last = math.cos(a[0]), math.cos(a[1])
    low, high = outward(min(first, last), max(first, last), LIBRARY_STEPS)
    if math.floor(a[1] / _TURN) > math.floor(a[0] / _TURN):
        high = 1.0
    if math.floor(a[1] / _TURN - 0.5) > math.floor(a[0] / _TURN - 0.5):
        low = -1.0
    return max(low, -1.0), min(high, 1.0)


@kernel
def sine(a):
    """Sine of an interval."""
    return cosine(outward(a[0] - math.pi / 2, a[1] - math.pi / 2))


@kernel
def shifted(a, angle):
    """An interval of angles plus an angle, all within a few turns, whatever cancels in the sum."""
    return a[0] + angle - ANGLE_ROUNDING_RAD, a[1] + angle + ANGLE_ROUNDING_RAD


@kernel
def number(value):
    """The jet of a constant."""
    return (value, value), (0.0, 0.0)


@kernel
def widened(a, width):
    """A jet with its value wider by `width` at both ends."""
    return (a[0][0] - width, a[0][1] + width), a[1]


@kernel
def j_add(a, b):
    """Sum of two jets."""
    return add(a[0], b[0]), add(a[1], b[1])


@kernel
def j_subtract(a, b):
    """Difference of two jets."""
    return subtract(a[0], b[0]), subtract(a[1], b[1])


@kernel
def j_multiply(a, b):
    """Product of two jets."""
    return multiply(a[0], b[0]), add(multiply(a[0], b[1]), multiply(a[1], b[0]))


@kernel
def j_scale(factor, a):
    """Product of a number and a jet."""
    return scale(factor, a[0]), scale(factor, a[1])


@kernel
def j_square(a):
    """Square of a jet."""
    return square(a[0]), scale(2.0, multiply(a[0], a[1]))


@kernel
def j_root(a):
    """Square root over the part of a jet that is not negative."""
    value = root(a[0])
    return value, over_positive(a[1], scale(2.0, value))


@kernel
def j_cosine(a):
    """Cosine of a jet."""
    return cosine(a[0]), scale(-1.0, multiply(sine(a[0]), a[1]))


@kernel
def j_sine(a):
    """Sine of a jet."""
    return sine(a[0]), multiply(cosine(a[0]), a[1])


@kernel
def j_arc_cosine(a):
    """Arc cosine over the part of a jet inside -1 to 1."""
    low, high = max(min(a[0][0], 1.0), -1.0), max(min(a[0][1], 1.0), -1.0)
    value = outward(math.acos(high), math.acos(low), LIBRARY_STEPS)
    sine_squared = multiply(subtract((1.0, 1.0), (low, high)), add((1.0, 1.0), (low, high)))
    closest = subtract((1.0, 1.0), square((low, high)))
    # Each encloses 1 - a^2: the first is exact near its roots, the second not too wide elsewhere.
    both = max(sine_squared[0], closest[0]), min(sine_squared[1], closest[1])
    slope = over_positive(scale(-1.0, a[1]), root(both))
    return (max(value[0], 0.0), value[1]), slope


@kernel
def j_arc_tangent(y, x):
    """Angle atan2(y, x) without jumps; `WHOLE` where the box of x and y holds the origin.

    A box without the origin is seen from it under less than half a turn, between two corners.
    """
    if y[0][0] <= 0.0 <= y[0][1] and x[0][0] <= 0.0 <= x[0][1]:
        return WHOLE, (-STEEPEST_SLOPE, STEEPEST_SLOPE)
    middle = math.atan2(y[0][0] + y[0][1], x[0][0] + x[0][1])
    low, high = 0.0, 0.0
    for corner_y in y[0]:
        for corner_x in x[0]:
            turned = math.atan2(corner_y, corner_x) - middle
            turned -= _TURN * math.floor(turned / _TURN + 0.5)
            low, high = min(low, turned), max(high, turned)
    # The steps are of pi: the corner's and the middle's angles have errors of their own size.
    slack = 2.0 * LIBRARY_STEPS * ROUNDING_STEP * math.pi
    value = outward(middle + low - slack, middle + high + slack)
    across = subtract(multiply(x[0], y[1]), multiply(y[0], x[1]))
    return value, over_positive(across, add(square(x[0]), square(y[0])))
