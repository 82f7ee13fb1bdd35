"""What the inner loops know of a target: numbers in one row, for one or for many targets.

The circle of tool frames about the branch, joint limits as cosines, and the arm. A joint is inside
its limits where cos(q - middle) >= cos(half the range); cosines and sines of all joints follow from
the wrist centre by roots and divisions alone, so a margin in this form needs no arctangent and is
smooth where the joint's own margin has a corner.

A kernel gets two or three arrays instead of a hundred numbers, and takes out what it needs before
its loops.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from solver.compiled import inlined
from solver.kinematics.spherical_wrist import WristGeometry
from solver.robots.model import Array
from solver.tolerances import JOINT_RATE_RAD_M

NEVER_LIMITS: Final = -2.0
"""Cosine of half a range of a full turn or more: below every cosine."""

NO_ROOM: Final = 2.0
"""Cosine of half a range that the margin asked for has emptied: above every cosine."""

_SCALARS: Final = 13
COS_MIDDLE: Final = 43
SIN_MIDDLE: Final = 49
COS_HALF: Final = 55
LOWER: Final = 61
UPPER: Final = 67
REFERENCE: Final = 73
WEIGHTS: Final = 79
SQUARED: Final = 85
NUMBERS: Final = 86
"""Columns of a row of numbers: the arm's 25, the circle's 18, limits as cosines 18, then these."""


class PackedTask(NamedTuple):
    """One target with the tool on one side, seen from a reference posture, for the inner loops.

    Attributes:
        numbers: shape (NUMBERS,).
        retreats: distances behind the target, from the standoff down to 0, shape (rows,) [m].
        cos_steps: cosine of the turn that counts as a wrist jump, between row and row, shape
            (rows - 1,); below -1 where half a turn does not.
    """

    numbers: Array
    retreats: Array
    cos_steps: Array


class ApproachCircle(NamedTuple):
    """A target with the tool on one side: position [m], and axes at angle 0 and a quarter turn.

    The tool's z is cos(phi) outward + sin(phi) sideways, its x is cos(phi) x_outward + sin(phi)
    x_sideways, its y is fixed; three numbers each.
    """

    position: tuple[float, float, float]
    y: tuple[float, float, float]
    outward: tuple[float, float, float]
    sideways: tuple[float, float, float]
    x_outward: tuple[float, float, float]
    x_sideways: tuple[float, float, float]


def pack(
    geometry: WristGeometry,
    limits: tuple[Array, Array],
    frames: tuple[Array, Array, Array, Array],
    references: Array,
    weights: Array,
    squared: bool,
) -> Array:
    """Rows of numbers for n targets, shape (n, NUMBERS).

    Args:
        geometry: the arm and tool.
        limits: lower and upper limits less the margin asked for, shape (6,) each [rad].
        frames: positions [m], tool y axes, approach directions at angle 0 and at a quarter turn,
            shape (n, 3) each.
        references: postures from which effort counts, shape (n, 6) or (6,) [rad].
        weights: weight of each joint, shape (6,).
        squared: the norm is l2.
    """
    positions, y, outward, sideways = frames
    lower, upper = limits
    middle, half = (lower + upper) / 2 + np.asarray(geometry.offsets), (upper - lower) / 2
    cos_half = np.where(half < math.pi, np.cos(half), NEVER_LIMITS)
    parts = (
        np.array([*geometry[:_SCALARS], *geometry.offsets, *geometry.middles]),
        *(positions, y, outward, sideways, np.cross(y, outward), np.cross(y, sideways)),
        *(np.cos(middle), np.sin(middle), np.where(half >= 0.0, cos_half, NO_ROOM)),
        *(lower, upper, references, weights, np.array([float(squared)])),
    )
    rows = [np.broadcast_to(part, (len(positions), part.shape[-1])) for part in parts]
    return np.ascontiguousarray(np.concatenate(rows, axis=1))


def jump_cosines(retreats: Sequence[float] | Array) -> Array:
    """Cosine of the joint travel that counts as a wrist jump, between rows, shape (rows - 1,)."""
    travel = JOINT_RATE_RAD_M * np.abs(np.diff(np.asarray(retreats)))
    return np.asarray(np.where(travel < math.pi, np.cos(travel), NEVER_LIMITS))


@inlined
def unpack_geometry(n):
    """The arm and tool of a row of numbers."""
    return WristGeometry(
        n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8], n[9], n[10], n[11], n[12],
        (n[13], n[14], n[15], n[16], n[17], n[18]), (n[19], n[20], n[21], n[22], n[23], n[24]),
    )  # fmt: skip


@inlined
def unpack_circle(n):
    """The circle of a row of numbers."""
    return ApproachCircle(
        (n[25], n[26], n[27]), (n[28], n[29], n[30]), (n[31], n[32], n[33]),
        (n[34], n[35], n[36]), (n[37], n[38], n[39]), (n[40], n[41], n[42]),
    )  # fmt: skip


@inlined
def tool_place(circle, cos, sin, retreat):
    """Tool centre point and axes x, y, z at an approach angle and a retreat, as tuples."""
    u, v, p = circle.outward, circle.sideways, circle.position
    z = (cos * u[0] + sin * v[0], cos * u[1] + sin * v[1], cos * u[2] + sin * v[2])
    a, b = circle.x_outward, circle.x_sideways
    x = (cos * a[0] + sin * b[0], cos * a[1] + sin * b[1], cos * a[2] + sin * b[2])
    place = (p[0] - retreat * z[0], p[1] - retreat * z[1], p[2] - retreat * z[2])
    return place, x, circle.y, z
