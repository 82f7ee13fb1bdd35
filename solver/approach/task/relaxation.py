"""How much of the relaxations a thinning pose uses: strike zone, and swing of the tool's y axis.

A pose is taken apart as S R(phi): R(phi) has y along the branch, and the swing S is the smallest
rotation that takes that direction to the pose's y axis, so its rotation vector is normal to the
branch. The approach angle is that of the tool before it leans.
"""

from dataclasses import dataclass

import numpy as np

from solver.approach.task.frame import ApproachFrame
from solver.robots.model import Array


@dataclass(frozen=True)
class Placement:
    """A tool pose seen from a target.

    Attributes:
        approach_angle_rad: the approach angle, in [-pi, pi].
        strike_m: how far the tool centre point is beyond the target along z.
        swing_rad: rotation vector of the swing, normal to the branch, shape (3,).
    """

    approach_angle_rad: float
    strike_m: float
    swing_rad: Array

    @property
    def tilt_rad(self) -> float:
        """Angle between the tool's y axis and the branch."""
        return float(np.linalg.norm(self.swing_rad))


def placement(frame: ApproachFrame, position: Array, tool_side: int, pose: Array) -> Placement:
    """Takes a tool pose apart.

    Args:
        frame: the target's approach frame.
        position: the target, shape (3,) [m].
        tool_side: 1 or -1.
        pose: the tool frame at thinning, shape (4, 4) [m].
    """
    axes, place = pose[:3, :3], pose[:3, 3]
    along = tool_side * frame.branch
    axis = np.cross(along, axes[:, 1])
    sine, cosine = float(np.linalg.norm(axis)), float(along @ axes[:, 1])
    swing = axis * (np.arctan2(sine, cosine) / sine) if sine > 0 else np.zeros(3)
    upright = rotation(swing).T @ axes[:, 2]
    angle = float(np.arctan2(upright @ frame.sideways, upright @ frame.outward))
    return Placement(angle, float((place - position) @ axes[:, 2]), swing)


def shortened(vector: Array, longest: float) -> Array:
    """The vector, shortened to `longest` where it is longer."""
    length = float(np.linalg.norm(vector))
    return vector if length <= longest else np.asarray(vector * (longest / length))


def rotation(vector: Array) -> Array:
    """The rotation by a rotation vector, shape (3,) [rad], as a matrix (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    # sin(a)/a and (1 - cos a)/a^2, both without cancellation at zero.
    first, second = np.sinc(angle / np.pi), np.sinc(angle / (2 * np.pi)) ** 2 / 2
    return np.asarray(np.eye(3) + first * skew + second * (skew @ skew))
