"""A frame's pose from points measured in both frames, and what the points say against a pose."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from solver.exceptions import Fault, InvalidProblem
from solver.frames.point_pairs import (
    Fit,
    PointPair,
    fit,
    point_arrays,
    residuals,
    root_mean_square,
    why_no_rotation,
)
from solver.frames.tolerances import (
    CLEARLY_BETTER,
    LARGE_RESIDUAL_M,
    LEAST_PAIRS,
    MOST_ROTATION_STD_RAD,
    OUTLIER_FACTOR,
    OUTLIER_PAIRS,
    POOR_ROTATION_STD_RAD,
    UNIT_NEARNESS,
)
from solver.frames.transforms import FrameWarning, RigidTransform
from solver.robots.model import Array

UNITS: Final = {
    "millimetres": 1e-3,
    "centimetres": 1e-2,
    "inches": 0.0254,
    "feet": 0.3048,
}
"""Lengths of units that are taken for metres [m]."""


@dataclass(frozen=True)
class Agreement:
    """How pairs of points agree with a frame's pose.

    Attributes:
        base_from_frame: the pose.
        residuals_m: how far each pair's base point is from where the pose puts it [m].
        warnings: what is probably wrong.
        scale: spread of the points in the base over that in the frame; None where the points are
            too few or on a line.
        rotation_std_rad: standard deviation of an estimated rotation about the axis where it is
            known worst [rad]; None for a pose that was given.
    """

    base_from_frame: RigidTransform
    residuals_m: Array
    warnings: tuple[FrameWarning, ...]
    scale: float | None = None
    rotation_std_rad: float | None = None

    @property
    def rms_residual_m(self) -> float:
        """Root mean square of the residuals [m]."""
        return root_mean_square(self.residuals_m)

    @property
    def max_residual_m(self) -> float:
        """The largest residual [m]."""
        return float(self.residuals_m.max())


def register_frame(pairs: Sequence[PointPair], *, reach_m: float | None = None) -> Agreement:
    """The pose that least squares finds for pairs of points; the scale stays one.

    Args:
        pairs: three or more that are on no line.
        reach_m: how far the arm reaches at most. Which of the two points is the frame's shows
            nowhere in the residuals, only where one set is out of reach and the other is not.

    Raises:
        InvalidProblem: too few or too many pairs, points on a line or in one place, mirror images,
            or residuals as large as the spread of the points. Paths begin with "pairs".
    """
    path = ("pairs",)
    frame_m, base_m = point_arrays(pairs, path, LEAST_PAIRS)
    lines = [
        Fault(path, f"the points of {name} are {detail}")
        for name, points in (("frame_m", frame_m), ("base_m", base_m))
        if (detail := why_no_rotation(points))
    ]
    if lines:
        raise InvalidProblem(tuple(lines))
    found = fit(frame_m, base_m)
    if found.is_mirrored:
        raise InvalidProblem((Fault(path, f"{_mirrored(found)}; no pose is true of them"),))
    if found.rotation_std_rad > MOST_ROTATION_STD_RAD:
        raise InvalidProblem((Fault(path, _undetermined(found)),))
    return Agreement(
        found.base_from_frame,
        found.residuals_m,
        tuple(_warnings_of_fit(found, reach_m)),
        found.scale,
        found.rotation_std_rad,
    )


def check_frame(base_from_frame: RigidTransform, pairs: Sequence[PointPair]) -> Agreement:
    """What pairs of points say about a pose that is given; one pair says something already.

    Raises:
        InvalidProblem: no pairs, too many, or points that are none. Paths begin with "check_pairs".
    """
    frame_m, base_m = point_arrays(pairs, ("check_pairs",), 1)
    left = residuals(base_from_frame, frame_m, base_m)
    found = None
    if not why_no_rotation(frame_m) and not why_no_rotation(base_m):
        found = fit(frame_m, base_m)
    warnings = tuple(_warnings_of_check(base_from_frame, frame_m, base_m, left, found))
    return Agreement(base_from_frame, left, warnings, None if found is None else found.scale)


def _warnings_of_fit(found: Fit, reach_m: float | None) -> list[FrameWarning]:
    warnings = []
    if found.count == LEAST_PAIRS:
        detail = "three pairs: only the sides of one triangle are compared; take four or more"
        warnings.append(FrameWarning("few_pairs", detail))
    scaled = found.is_scaled
    if scaled:
        warnings.append(FrameWarning("scaled", _scaled(found.scale)))
    elif reach_m is not None and (detail := _out_of_reach(found, reach_m)):
        warnings.append(FrameWarning("inverted", detail))
    outlier = _outlier(found)
    if outlier is not None:
        warnings.append(outlier)
    elif not scaled and found.residuals_m.max() > LARGE_RESIDUAL_M:
        warnings.append(FrameWarning("large_residual", _largest(found.residuals_m)))
    if found.rotation_std_rad > POOR_ROTATION_STD_RAD:
        detail = f"the rotation is known to {found.rotation_std_rad:.2g} rad only; {_SPREAD}"
        warnings.append(FrameWarning("uncertain_rotation", detail))
    return warnings


_SPREAD: Final = "take points further apart, in more than one direction"


def _warnings_of_check(
    base_from_frame: RigidTransform,
    frame_m: Array,
    base_m: Array,
    left: Array,
    found: Fit | None,
) -> list[FrameWarning]:
    warnings = []
    rms = root_mean_square(left)
    large = bool(left.max() > LARGE_RESIDUAL_M)
    inverted = root_mean_square(residuals(base_from_frame.inverse, frame_m, base_m))
    if large and rms > CLEARLY_BETTER * inverted:
        detail = (
            f"the inverse of this pose leaves {inverted:.2g} m of the pairs, the pose itself "
            f"{rms:.2g} m: this seems to be frame_from_base, wanted is base_from_frame"
        )
        warnings.append(FrameWarning("inverted", detail))
        large = False
    if found is not None and found.is_mirrored:
        warnings.append(FrameWarning("mirrored", _mirrored(found)))
    elif found is not None and found.is_scaled:
        warnings.append(FrameWarning("scaled", _scaled(found.scale)))
    if large:
        detail = _largest(left)
        best = None if found is None else root_mean_square(found.residuals_m)
        if best is not None and rms > CLEARLY_BETTER * best:
            detail += f"; a pose estimated from the pairs leaves {best:.2g} m of them"
        warnings.append(FrameWarning("large_residual", detail))
    return warnings


def _outlier(found: Fit) -> FrameWarning | None:
    """The pair without which the others agree much better, if there is one."""
    if found.count < OUTLIER_PAIRS:
        return None
    # A wrong unit is told apart; it must not make a pair look wrong.
    frame_m = found.frame_m * (found.scale if found.is_scaled else 1.0)
    rms = root_mean_square(fit(frame_m, found.base_m).residuals_m)
    suspect = -1
    least = rms / OUTLIER_FACTOR
    for k in range(found.count):
        kept = np.arange(found.count) != k
        others, base = frame_m[kept], found.base_m[kept]
        if why_no_rotation(others) or why_no_rotation(base):
            continue
        without = root_mean_square(fit(others, base).residuals_m)
        if without < least:
            suspect, least = k, without
    if suspect < 0:
        return None
    kept = np.arange(found.count) != suspect
    others_say = fit(frame_m[kept], found.base_m[kept]).base_from_frame
    (miss,) = residuals(others_say, frame_m[[suspect]], found.base_m[[suspect]])
    if miss <= LARGE_RESIDUAL_M:
        return None
    detail = (
        f"pair {suspect} (the first is 0) is {miss:.2g} m from where the others put it; without it "
        f"they agree to {least:.2g} m (root mean square), with it to {rms:.2g} m"
    )
    return FrameWarning("large_residual", detail)


def _largest(left: Array) -> str:
    k = int(left.argmax())
    return f"pair {k} (the first is 0) is {left[k]:.2g} m from where the pose puts it"


def _scaled(scale: float) -> str:
    detail = (
        f"distances in the base are {scale:.4g} times those in the frame; a pose does not scale"
    )
    for unit, size in UNITS.items():
        for name, expected in (("frame_m", size), ("base_m", 1.0 / size)):
            if abs(scale / expected - 1.0) < UNIT_NEARNESS:
                detail += f"; {name} seems to be {unit}, not metres"
    return detail


def _mirrored(found: Fit) -> str:
    return (
        f"the pairs are mirror images: a reflection leaves {found.rms_mirrored_m:.2g} m, the best "
        f"rotation {found.rms_scaled_m:.2g} m; in frame_m or base_m an axis is flipped, or two are "
        "exchanged"
    )


def _undetermined(found: Fit) -> str:
    return (
        f"the pairs agree to {found.rms_scaled_m:.2g} m only (root mean square), and across their "
        f"longest direction they spread by {found.base_spreads_m[1]:.2g} m, so the rotation is "
        f"known to {found.rotation_std_rad:.2g} rad: either the points are nearly on a line, or "
        "they are not the same points in both frames"
    )


def _out_of_reach(found: Fit, reach_m: float) -> str:
    frame = np.linalg.norm(found.frame_m, axis=1)
    beyond = int(np.sum(np.linalg.norm(found.base_m, axis=1) > reach_m))
    if not beyond or frame.max() > reach_m:
        return ""
    return (
        f"{beyond} of {found.count} base_m are beyond the reach of {reach_m:.3g} m, and all "
        "frame_m within it: the two seem to be exchanged"
    )
