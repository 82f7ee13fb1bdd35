"""Points measured in two frames, and how well rotation, scale and reflection explain them.

The fit is Kabsch's and Umeyama's: with both sets about their centres and U S V' the singular value
decomposition of sum(b f'), the rotation is U diag(1, 1, d) V' with d = det(U V'). The reflection
that fits best is the same with -d. Reference: S. Umeyama, Least-squares estimation of
transformation parameters between two point patterns, IEEE PAMI 13 (1991), 376-380.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.exceptions import Fault, InvalidProblem
from solver.frames.checks import position_faults
from solver.frames.tolerances import (
    COLLINEAR,
    EXACT_FIT,
    LEAST_PAIRS,
    MIRROR_FACTOR,
    MOST_PAIRS,
    SAME_PLACE_M,
    SCALE_FALSE_ALARM,
    SCALE_LEAST,
)
from solver.frames.transforms import RigidTransform, transform_from_rotation
from solver.robots.model import Array


@dataclass(frozen=True)
class PointPair:
    """One point, measured in two frames.

    Attributes:
        frame_m: in the frame, say the camera's [m].
        base_m: in the robot's base frame [m].
    """

    frame_m: Sequence[float]
    base_m: Sequence[float]


@dataclass(frozen=True)
class Fit:
    """How the base points follow from those of the frame.

    Attributes:
        frame_m: points in the frame, shape (n, 3) [m].
        base_m: the same points in the base, shape (n, 3) [m].
        base_from_frame: the rigid transform of least squares.
        scale: spread in the base over spread in the frame; both may be noisy alike.
        rms_scaled_m: what rotation, scale and shift leave, root mean square over the pairs [m].
        rms_mirrored_m: the same with the best reflection for the rotation [m].
        frame_spreads_m: root mean square extent of the frame's points about their centre, along
            the longest direction, across it, and across both [m].
        base_spreads_m: the same in the base [m].
    """

    frame_m: Array
    base_m: Array
    base_from_frame: RigidTransform
    scale: float
    rms_scaled_m: float
    rms_mirrored_m: float
    frame_spreads_m: Array
    base_spreads_m: Array

    @property
    def count(self) -> int:
        """How many pairs there are."""
        return len(self.frame_m)

    @property
    def residuals_m(self) -> Array:
        """How far each base point is from where the rigid transform puts it [m]."""
        return residuals(self.base_from_frame, self.frame_m, self.base_m)

    @property
    def noise_m(self) -> float:
        """Standard deviation of one coordinate of a pair, from what the scaled fit leaves [m]."""
        freedom = 3 * self.count - 7
        return self.rms_scaled_m * math.sqrt(self.count / freedom)

    @property
    def rotation_std_rad(self) -> float:
        """Standard deviation of the rotation about the axis where it is known worst [rad]."""
        across = math.hypot(*self.base_spreads_m[1:]) * math.sqrt(self.count)
        return self.noise_m / across

    @property
    def is_mirrored(self) -> bool:
        """Whether a reflection explains the pairs far better than any rotation."""
        scale = self.scale
        depth = min(self.frame_spreads_m[2] * scale, self.base_spreads_m[2])
        left = max(self.rms_mirrored_m, EXACT_FIT * self.base_spreads_m[0])
        return bool(self.rms_scaled_m > MIRROR_FACTOR * left and depth > MIRROR_FACTOR * left)

    @property
    def is_scaled(self) -> bool:
        """Whether the scale is off one by more than the noise explains."""
        freedom = 3 * self.count - 7
        from scipy.special import stdtrit  # as slow to import as rotations: transforms.py

        quantile = float(stdtrit(freedom, 1.0 - SCALE_FALSE_ALARM / 2.0))
        extent = math.hypot(*self.base_spreads_m) * math.sqrt(self.count)
        return abs(math.log(self.scale)) > max(SCALE_LEAST, quantile * self.noise_m / extent)


def residuals(base_from_frame: RigidTransform, frame_m: Array, base_m: Array) -> Array:
    """How far base points are from where a transform puts the frame's, shape (n,) [m]."""
    return np.asarray(np.linalg.norm(base_from_frame.points(frame_m) - base_m, axis=1))


def root_mean_square(values: Array) -> float:
    """Of some residuals."""
    return float(np.sqrt(np.mean(np.square(values))))


def point_arrays(
    pairs: Sequence[PointPair], path: tuple[str | int, ...], least: int
) -> tuple[Array, Array]:
    """The pairs' points in the frame and in the base, each of shape (n, 3) [m].

    Raises:
        InvalidProblem: fewer than `least`, more than MOST_PAIRS, or points that are none.
    """
    faults: list[Fault] = []
    if len(pairs) < least:
        faults.append(Fault(path, f"needs {least} pairs or more, has {len(pairs)}"))
    elif len(pairs) > MOST_PAIRS:
        faults.append(Fault(path, f"has more than {MOST_PAIRS} pairs"))
    else:
        for k, pair in enumerate(pairs):
            faults += position_faults(pair.frame_m, (*path, k, "frame_m"))
            faults += position_faults(pair.base_m, (*path, k, "base_m"))
    if faults:
        raise InvalidProblem(tuple(faults))
    frame_m = np.array([pair.frame_m for pair in pairs], dtype=float).reshape(-1, 3)
    base_m = np.array([pair.base_m for pair in pairs], dtype=float).reshape(-1, 3)
    return frame_m, base_m


def why_no_rotation(points_m: Array) -> str:
    """Why no rotation follows from points, shape (n, 3); empty if one does."""
    if len(points_m) < LEAST_PAIRS:
        return f"{LEAST_PAIRS} are needed"
    along, across = spreads(points_m)[:2]
    if along < SAME_PLACE_M:
        return f"all within {1000 * SAME_PLACE_M:g} mm of one place"
    if across < COLLINEAR * along:
        return (
            f"on a line: across it they spread by less than {100 * COLLINEAR:g} % of their spread "
            "along it, and the rotation about it stays open"
        )
    return ""


def spreads(points_m: Array) -> Array:
    """Root mean square extents about the centre along the principal axes, longest first [m]."""
    centred = points_m - points_m.mean(axis=0)
    return np.asarray(np.linalg.svd(centred, compute_uv=False) / math.sqrt(len(points_m)))


def fit(frame_m: Array, base_m: Array) -> Fit:
    """The best transforms from points in the frame to points in the base, both (n, 3) [m].

    Neither set may be on a line; see `why_no_rotation`.
    """
    frame_centre, base_centre = frame_m.mean(axis=0), base_m.mean(axis=0)
    frame, base = frame_m - frame_centre, base_m - base_centre
    left, _, right = np.linalg.svd(base.T @ frame)
    hand = math.copysign(1.0, float(np.linalg.det(left @ right)))
    rotation = left @ np.diag([1.0, 1.0, hand]) @ right
    reflection = left @ np.diag([1.0, 1.0, -hand]) @ right
    return Fit(
        frame_m=frame_m,
        base_m=base_m,
        base_from_frame=transform_from_rotation(base_centre - rotation @ frame_centre, rotation),
        scale=math.sqrt(float(np.sum(base * base) / np.sum(frame * frame))),
        rms_scaled_m=_rms_scaled(rotation, frame, base),
        rms_mirrored_m=_rms_scaled(reflection, frame, base),
        frame_spreads_m=spreads(frame_m),
        base_spreads_m=spreads(base_m),
    )


def _rms_scaled(turn: Array, frame: Array, base: Array) -> float:
    turned = frame @ turn.T
    scale = np.sum(turned * base) / np.sum(frame * frame)
    return root_mean_square(np.linalg.norm(base - scale * turned, axis=1))
