"""From the axes of any serial arm to classic Denavit-Hartenberg rows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.robots.rigid import Array, inverse
from solver.urdf.tolerances import SAME_AXIS


@dataclass(frozen=True)
class Row:
    """One Denavit-Hartenberg row: a, alpha, d, offset [m, rad], and its frame at q = 0, (4, 4)."""

    a_m: float
    alpha_rad: float
    d_m: float
    offset_rad: float
    frame: Array


@dataclass(frozen=True)
class Rows:
    """A whole arm at q = 0.

    Attributes:
        mount: the first joint's frame in the base frame, shape (4, 4) [m].
        rows: one a joint; the last leads to the tip's z axis.
        tool_length_m: what is left along that axis to the tip.
        roll_rad: what is left about it: the flange's roll.
    """

    mount: Array
    rows: tuple[Row, ...]
    tool_length_m: float
    roll_rad: float


def denavit_hartenberg(axes: Sequence[Array], tip: Array) -> Rows:
    """Rows whose frames have the joints' axes as z axes.

    Args:
        axes: frames at q = 0 in the base frame, each with its joint's axis as z, shape (4, 4).
        tip: the tool frame at q = 0.

    The common normal of neighbouring axes is the x axis between them. Parallel axes have many: the
    one through the frame before is taken. Where an axis comes twice, x stays as it is, and after
    the last joint it is the tip's own, so that a tip on the last axis leaves nothing over.
    """
    mount = _first_frame(axes[0])
    before, rows = mount, []
    targets = [*axes[1:], tip]
    for i, target in enumerate(targets):
        along = tip[:3, 0] if i == len(targets) - 1 else before[:3, 0]
        frame = _next_frame(before, target, along)
        rows.append(_row(before, frame))
        before = frame
    rest = inverse(before) @ tip
    roll = _clean_angle(math.atan2(rest[1, 0], rest[0, 0]))
    return Rows(mount, tuple(rows), _clean(rest[2, 3]), roll)


def _first_frame(axis: Array) -> Array:
    """A frame on the first axis, the base frame itself where that axis is the base's z axis."""
    z, place = axis[:3, 2], axis[:3, 3]
    x = np.eye(3)[0] - z[0] * z
    if np.linalg.norm(x) < math.sqrt(0.5):
        x = np.eye(3)[1] - z[1] * z
    return _frame(x, z, place - (place @ z) * z)


def _next_frame(before: Array, target: Array, along: Array) -> Array:
    z0, o0 = before[:3, 2], before[:3, 3]
    z1, o1 = target[:3, 2], target[:3, 3]
    normal = np.cross(z0, z1)
    between = o1 - o0
    sine = float(np.linalg.norm(normal))
    if sine > SAME_AXIS:
        x = normal / sine
        # Foot of the common normal on the second axis.
        share = np.linalg.solve(np.column_stack((z0, -z1, x)), between)
        if share[2] < -SAME_AXIS or (abs(share[2]) <= SAME_AXIS and x @ before[:3, 0] < -SAME_AXIS):
            x = -x
        return _frame(x, z1, o1 + share[1] * z1)
    across = between - (between @ z0) * z0
    if np.linalg.norm(across) > SAME_AXIS:
        return _frame(across, z1, o0 + across)
    # One and the same axis: the target's own place on it, so that no length is left over.
    return _frame(along - (along @ z1) * z1, z1, o1)


def _row(before: Array, frame: Array) -> Row:
    step = inverse(before) @ frame
    return Row(
        a_m=_clean(float(step[:2, 3] @ step[:2, 0])),
        alpha_rad=_clean_angle(math.atan2(step[2, 1], step[2, 2])),
        d_m=_clean(float(step[2, 3])),
        offset_rad=_clean_angle(math.atan2(step[1, 0], step[0, 0])),
        frame=frame,
    )


def _frame(x: Array, z: Array, origin: Array) -> Array:
    frame = np.eye(4)
    unit_z = z / np.linalg.norm(z)
    unit_x = x / np.linalg.norm(x)
    frame[:3, :3] = np.column_stack((unit_x, np.cross(unit_z, unit_x), unit_z))
    frame[:3, 3] = origin
    return frame


def _clean(value: float) -> float:
    return 0.0 if abs(value) < SAME_AXIS else float(value)


def _clean_angle(angle: float) -> float:
    quarter = round(angle / (math.pi / 2)) * math.pi / 2
    return quarter if abs(angle - quarter) < SAME_AXIS else float(angle)
