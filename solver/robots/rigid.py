"""Rigid transforms from positions and roll, pitch, yaw angles, and back (URDF's convention)."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from solver.tolerances import EXACT_ZERO

Array = NDArray[np.float64]


def transform(position_m: Sequence[float] | Array, rpy_rad: Sequence[float]) -> Array:
    """The frame at a position, turned about the fixed axes x, then y, then z; shape (4, 4)."""
    (roll_c, roll_s), (pitch_c, pitch_s), (yaw_c, yaw_s) = (_circle(angle) for angle in rpy_rad)
    about_x = np.array([[1, 0, 0], [0, roll_c, -roll_s], [0, roll_s, roll_c]])
    about_y = np.array([[pitch_c, 0, pitch_s], [0, 1, 0], [-pitch_s, 0, pitch_c]])
    about_z = np.array([[yaw_c, -yaw_s, 0], [yaw_s, yaw_c, 0], [0, 0, 1]])
    pose = np.eye(4)
    pose[:3, :3] = about_z @ about_y @ about_x
    pose[:3, 3] = position_m
    return pose


def link_transform(a_m: float, alpha_rad: float, d_m: float, theta_rad: float) -> Array:
    """Rot_z(theta) Trans_z(d) Trans_x(a) Rot_x(alpha), shape (4, 4) (T equation 1)."""
    turn = transform((0.0, 0.0, d_m), (0.0, 0.0, theta_rad))
    return np.asarray(turn @ transform((a_m, 0.0, 0.0), (alpha_rad, 0.0, 0.0)))


def quaternion_matrix(xyzw: Sequence[float]) -> Array:
    """The rotation of a quaternion of any length but zero, shape (3, 3)."""
    x, y, z, w = np.array(xyzw, dtype=np.float64) / math.hypot(*xyzw)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def inverse(pose: Array) -> Array:
    """The inverse of a rigid transform, shape (4, 4)."""
    back = np.eye(4)
    back[:3, :3] = pose[:3, :3].T
    back[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return back


def roll_pitch_yaw(turn: Array) -> tuple[float, float, float]:
    """Angles about the fixed axes x, y, z that make a rotation, shape (3, 3) [rad].

    With the pitch at a right angle the roll is zero and the yaw has the whole turn.
    """
    cos_pitch = math.hypot(turn[0, 0], turn[1, 0])
    pitch = math.atan2(0.0 - turn[2, 0], cos_pitch)  # 0.0 - x and not -x: no negative zero
    if cos_pitch < math.sqrt(EXACT_ZERO):
        return 0.0, pitch, math.atan2(-turn[0, 1], turn[1, 1])
    return math.atan2(turn[2, 1], turn[2, 2]), pitch, math.atan2(turn[1, 0], turn[0, 0])


def _circle(angle: float) -> tuple[float, float]:
    cos, sin = math.cos(angle), math.sin(angle)
    return (0.0 if abs(cos) < EXACT_ZERO else cos), (0.0 if abs(sin) < EXACT_ZERO else sin)
