"""Kernels: distances of capsules to each other, and of their axes to boxes and planes."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

from solver.compiled import inlined, kernel
from solver.scene.tolerances import BOX_HALVINGS, INSIDE_STEPS
from solver.tolerances import LEAST_DIVISOR

_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


@inlined
def clamped(share):
    """The nearest number from 0 to 1."""
    return min(max(share, 0.0), 1.0)


@inlined
def squared_between(ax, ay, az, dx, dy, dz, bx, by, bz, ex, ey, ez):
    """Squared distance of segments a + s d and b + t e, s and t from 0 to 1; any may be a point.

    Source: C. Ericson, Real-Time Collision Detection (2005), section 5.1.9, without its branches:
    the nearest point of the one is found for the lines, held inside, and that of the other for it;
    once more the other way round, as the second may have been held.
    """
    rx, ry, rz = ax - bx, ay - by, az - bz
    dd, ee = dx * dx + dy * dy + dz * dz, ex * ex + ey * ey + ez * ez
    de = dx * ex + dy * ey + dz * ez
    rd, re = rx * dx + ry * dy + rz * dz, rx * ex + ry * ey + rz * ez
    s = clamped((de * re - rd * ee) / max(dd * ee - de * de, LEAST_DIVISOR))
    t = clamped((de * s + re) / max(ee, LEAST_DIVISOR))
    s = clamped((de * t - rd) / max(dd, LEAST_DIVISOR))
    x, y, z = rx + s * dx - t * ex, ry + s * dy - t * ey, rz + s * dz - t * ez
    return x * x + y * y + z * z


@inlined
def may_be_within(one, other, most):
    """Whether the balls around two capsules are nearer to each other than `most`."""
    x, y, z = one[7] - other[7], one[8] - other[8], one[9] - other[9]
    near = max(one[10] + other[10] + most, 0.0)
    return x * x + y * y + z * z < near * near


@inlined
def between_capsules(one, other):
    """Distance of two capsules; how deep they are in each other, below zero [m]."""
    squared = squared_between(
        one[0], one[1], one[2], one[3], one[4], one[5],
        other[0], other[1], other[2], other[3], other[4], other[5],
    )  # fmt: skip
    return math.sqrt(squared) - one[6] - other[6]


@kernel
def beyond_box(box, i, x, y, z):
    """How far a place, seen from a box's centre, is along the box's edge i, and beyond its end."""
    place = x * box[3 + 3 * i] + y * box[4 + 3 * i] + z * box[5 + 3 * i]
    return place, place - min(max(place, -box[12 + i]), box[12 + i])


@kernel
def depth_in_box(box, x, y, z):
    """How deep a place, seen from a box's centre, is in it: how far it is to the nearest face."""
    depth = math.inf
    for i in range(3):
        place, _ = beyond_box(box, i, x, y, z)
        depth = min(depth, box[12 + i] - abs(place))
    return depth


@kernel
def distance_to_box(one, box):
    """Distance of a capsule's axis to a solid box [m]; where it enters, less the largest depth.

    The squared distance is convex along the axis, so its slope is bisected. The depth inside is
    concave.

    Args:
        one: a row of `Obstacles.capsules`.
        box: a row of `Obstacles.boxes`.
    """
    px, py, pz = one[0] - box[0], one[1] - box[1], one[2] - box[2]
    dx, dy, dz = one[3], one[4], one[5]
    low, high, s = 0.0, 1.0, 0.5
    for _ in range(BOX_HALVINGS):
        slope = 0.0
        for i in range(3):
            along, _ = beyond_box(box, i, dx, dy, dz)
            _, beyond = beyond_box(box, i, px + s * dx, py + s * dy, pz + s * dz)
            slope += beyond * along
        if slope < 0.0:
            low = s
        elif slope > 0.0:
            high = s
        else:
            break
        s = (low + high) / 2
    total = 0.0
    for i in range(3):
        _, beyond = beyond_box(box, i, px + s * dx, py + s * dy, pz + s * dz)
        total += beyond * beyond
    if total > 0.0:
        return math.sqrt(total)
    low, high = 0.0, 1.0
    for _ in range(INSIDE_STEPS):
        one, two = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        at_one = depth_in_box(box, px + one * dx, py + one * dy, pz + one * dz)
        at_two = depth_in_box(box, px + two * dx, py + two * dy, pz + two * dz)
        if at_one < at_two:
            low = one
        else:
            high = two
    s = (low + high) / 2
    return -depth_in_box(box, px + s * dx, py + s * dy, pz + s * dz)


@inlined
def distance_to_plane(one, plane):
    """Distance of a capsule's axis to what is behind a plane, a row of `Obstacles.planes` [m]."""
    start = one[0] * plane[0] + one[1] * plane[1] + one[2] * plane[2] - plane[3]
    return start + min(one[3] * plane[0] + one[4] * plane[1] + one[5] * plane[2], 0.0)
