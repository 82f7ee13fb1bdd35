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

from solver.approach.task.constraints import JOINTS
from solver.compiled import inlined
from solver.kinematics.spherical_wrist import WristGeometry
from solver.robots.model import Array
from solver.tolerances import JOINT_RATE_RAD_M

NEVER_LIMITS: Final = -2.0
"""Cosine of half a range of a full turn or more: below every cosine."""

NO_ROOM: Final = 2.0
"""Cosine of half a range that the margin asked for has emptied: above every cosine."""


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


_SIX: Final = ("cos_middle", "sin_middle", "cos_half", "lower", "upper", "reference", "weights")

LAYOUT: Final[tuple[tuple[str, int], ...]] = (
    *((name, JOINTS if name in ("offsets", "middles") else 1) for name in WristGeometry._fields),
    *((name, 3) for name in ApproachCircle._fields),
    *((name, JOINTS) for name in _SIX),
    ("squared", 1),
)
"""Fields of a row of numbers with their widths: the arm's, the circle's, cosine and sine of the
middle of each joint's limits, cosine of half their range, limits [rad], reference [rad], weights,
and whether the norm is l2."""

COLUMNS: Final = {name: sum(width for _, width in LAYOUT[:k]) for k, (name, _) in enumerate(LAYOUT)}
"""The first column of each field."""

NUMBERS: Final = sum(width for _, width in LAYOUT)
"""Columns of a row of numbers."""

# As plain numbers, which Numba compiles in.
COS_MIDDLE: Final = COLUMNS["cos_middle"]
SIN_MIDDLE: Final = COLUMNS["sin_middle"]
COS_HALF: Final = COLUMNS["cos_half"]
LOWER: Final = COLUMNS["lower"]
UPPER: Final = COLUMNS["upper"]
REFERENCE: Final = COLUMNS["reference"]
WEIGHTS: Final = COLUMNS["weights"]
SQUARED: Final = COLUMNS["squared"]
_ARM: Final = WristGeometry._make(COLUMNS[name] for name in WristGeometry._fields)
_CIRCLE: Final = ApproachCircle._make(COLUMNS[name] for name in ApproachCircle._fields)


class PackedTask(NamedTuple):
    """One target with the tool on one side, seen from a reference posture, for the inner loops.

    Attributes:
        numbers: shape (NUMBERS,).
        retreats: distances behind the target, from the standoff down to 0, shape (rows,) [m].
        cos_steps: cosine of the farthest that a joint may turn from row to row, shape (rows - 1,);
            below -1 where that is half a turn or more.
    """

    numbers: Array
    retreats: Array
    cos_steps: Array


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
    fields = geometry._asdict() | {
        "position": positions,
        "y": y,
        "outward": outward,
        "sideways": sideways,
        "x_outward": np.cross(y, outward),
        "x_sideways": np.cross(y, sideways),
        "cos_middle": np.cos(middle),
        "sin_middle": np.sin(middle),
        "cos_half": np.where(half >= 0.0, cos_half, NO_ROOM),
        "lower": lower,
        "upper": upper,
        "reference": references,
        "weights": weights,
        "squared": squared,
    }
    rows = np.empty((len(positions), NUMBERS))
    for name, width in LAYOUT:
        first = COLUMNS[name]
        rows[:, first : first + width] = fields[name]
    return rows


def jump_cosines(retreats: Sequence[float] | Array) -> Array:
    """Cosine of the farthest that a joint may turn from row to row, shape (rows - 1,)."""
    travel = JOINT_RATE_RAD_M * np.abs(np.diff(np.asarray(retreats)))
    return np.asarray(np.where(travel < math.pi, np.cos(travel), NEVER_LIMITS))


@inlined
def three(n, k):
    """Three numbers of a row from column k on."""
    return n[k], n[k + 1], n[k + 2]


@inlined
def six(n, k):
    """Six numbers of a row from column k on."""
    return n[k], n[k + 1], n[k + 2], n[k + 3], n[k + 4], n[k + 5]


@inlined
def unpack_geometry(n):
    """The arm and tool of a row of numbers."""
    return WristGeometry(
        a1=n[_ARM.a1],
        a2=n[_ARM.a2],
        l3=n[_ARM.l3],
        beta=n[_ARM.beta],
        cos_beta=n[_ARM.cos_beta],
        sin_beta=n[_ARM.sin_beta],
        shoulder=n[_ARM.shoulder],
        d1=n[_ARM.d1],
        sign1=n[_ARM.sign1],
        sign3=n[_ARM.sign3],
        sign4=n[_ARM.sign4],
        sign5=n[_ARM.sign5],
        tool_length=n[_ARM.tool_length],
        offsets=six(n, _ARM.offsets),
        middles=six(n, _ARM.middles),
    )


@inlined
def unpack_circle(n):
    """The circle of a row of numbers."""
    return ApproachCircle(
        position=three(n, _CIRCLE.position),
        y=three(n, _CIRCLE.y),
        outward=three(n, _CIRCLE.outward),
        sideways=three(n, _CIRCLE.sideways),
        x_outward=three(n, _CIRCLE.x_outward),
        x_sideways=three(n, _CIRCLE.x_sideways),
    )


@inlined
def tool_place(circle, cos, sin, retreat):
    """Tool centre point and axes x, y, z at an approach angle and a retreat, as tuples."""
    u, v, p = circle.outward, circle.sideways, circle.position
    z = (cos * u[0] + sin * v[0], cos * u[1] + sin * v[1], cos * u[2] + sin * v[2])
    a, b = circle.x_outward, circle.x_sideways
    x = (cos * a[0] + sin * b[0], cos * a[1] + sin * b[1], cos * a[2] + sin * b[2])
    place = (p[0] - retreat * z[0], p[1] - retreat * z[1], p[2] - retreat * z[2])
    return place, x, circle.y, z
