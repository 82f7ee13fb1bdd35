"""Frames other than the robot's base: where they stand, checked.

A pose is written as a camera calibration gives it, `base_from_frame`: the frame's origin in the
base, and the rotation that turns directions of the frame into directions of the base. So

    p_base = R p_frame + position_m        d_base = R d_frame
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from solver.exceptions import Fault, InvalidProblem
from solver.frames.checks import position_faults, vector_fault
from solver.frames.tolerances import (
    FEW_DIGITS,
    ORTHONORMAL,
    SHORTEST_DIRECTION,
    SUSPICIOUS_M,
    UNIT_QUATERNION,
)
from solver.robots.model import Array

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation


@dataclass(frozen=True)
class RigidTransform:
    """Where a frame stands in another one.

    Attributes:
        position_m: the frame's origin [m].
        quaternion_xyzw: its orientation, of length one, the last number not negative.
    """

    position_m: tuple[float, float, float]
    quaternion_xyzw: tuple[float, float, float, float]

    def to_dict(self) -> dict[str, list[float]]:
        """As plain values, with the wire's names."""
        return {
            "position_m": list(self.position_m),
            "quaternion_xyzw": list(self.quaternion_xyzw),
        }

    @property
    def rotation(self) -> Array:
        """The rotation as a matrix, shape (3, 3); its columns are the frame's axes."""
        return np.asarray(_from_quaternion(self.quaternion_xyzw).as_matrix())

    @property
    def inverse(self) -> "RigidTransform":
        """The other frame in this one."""
        back = self.rotation.T
        return _transform(-back @ np.array(self.position_m), _from_matrix(back))

    def points(self, points_m: Array) -> Array:
        """Points of the frame in the other one, shape (n, 3) [m]."""
        return np.asarray(points_m @ self.rotation.T + np.array(self.position_m))

    def directions(self, directions: Array) -> Array:
        """Directions of the frame in the other one, shape (n, 3); lengths stay."""
        return np.asarray(directions @ self.rotation.T)


@dataclass(frozen=True)
class NamedFrame:
    """A frame that targets were sent in.

    Attributes:
        name: under which it is registered.
        base_from_frame: where it stands in the robot's base frame.
    """

    name: str
    base_from_frame: RigidTransform


@dataclass(frozen=True)
class FrameWarning:
    """Something about a frame that is probably wrong.

    Attributes:
        code: what it is, for programs; docs/frames.md has all.
        detail: what it is, for people.
    """

    code: str
    detail: str


def transform_from_quaternion(
    position_m: Sequence[float], quaternion_xyzw: Sequence[float]
) -> tuple[RigidTransform, tuple[FrameWarning, ...]]:
    """A frame's pose from its origin [m] and a unit quaternion, real part last.

    Raises:
        InvalidProblem: not three and four finite numbers, too far away, not of length one.
    """
    faults = list(position_faults(position_m, ("position_m",)))
    path = ("quaternion_xyzw",)
    if detail := vector_fault(quaternion_xyzw, 4):
        faults.append(Fault(path, detail))
    elif not abs(math.hypot(*quaternion_xyzw) - 1.0) <= UNIT_QUATERNION:
        detail = f"its length is not 1 (more than {UNIT_QUATERNION:g} off); no rotation"
        faults.append(Fault(path, detail))
    if faults:
        raise InvalidProblem(tuple(faults))
    given = np.array(quaternion_xyzw, dtype=float)
    kept = _from_quaternion(given)
    signed = kept.as_quat() if given @ kept.as_quat() > 0 else -kept.as_quat()
    return _transform(position_m, kept), _about(position_m, given, signed)


def transform_from_matrix(
    position_m: Sequence[float], rotation_matrix: Sequence[Sequence[float]]
) -> tuple[RigidTransform, tuple[FrameWarning, ...]]:
    """A frame's pose from its origin [m] and three rows of a rotation matrix.

    Raises:
        InvalidProblem: of another shape, not finite, too far away; scaled, mirrored or sheared.
    """
    faults = list(position_faults(position_m, ("position_m",)))
    path = ("rotation_matrix",)
    if len(rotation_matrix) != 3:
        faults.append(Fault(path, f"needs 3 rows, has {len(rotation_matrix)}"))
    else:
        rows = [(k, vector_fault(row, 3)) for k, row in enumerate(rotation_matrix)]
        of_rows = [Fault((*path, k), detail) for k, detail in rows if detail]
        detail = "" if of_rows else _matrix_fault(rotation_matrix)
        faults += of_rows or ([Fault(path, detail)] if detail else [])
    if faults:
        raise InvalidProblem(tuple(faults))
    given = np.array(rotation_matrix, dtype=float)
    left, _, right = np.linalg.svd(given)
    kept = left @ right
    return _transform(position_m, _from_matrix(kept)), _about(position_m, given, kept)


def _matrix_fault(rows: Sequence[Sequence[float]]) -> str:
    size = math.hypot(*(value for row in rows for value in row)) / math.sqrt(3.0)
    if not SHORTEST_DIRECTION < size < 1.0 / SHORTEST_DIRECTION:
        return "its rows have no usable length"
    unit = np.array(rows, dtype=float) / size
    if np.abs(unit @ unit.T - np.eye(3)).max() > ORTHONORMAL:
        return "its rows are not of one length and at right angles to each other; no rotation"
    mirrored = np.linalg.det(unit) < 0
    if np.abs(size * size - 1.0) > ORTHONORMAL:
        also = " and mirrored" if mirrored else ""
        return f"a rotation scaled by {size:.4g}{also}; a pose does not scale"
    if mirrored:
        return (
            "a reflection (determinant -1): an axis is flipped, or two are exchanged; "
            "a rotation keeps right-handed axes right-handed"
        )
    return ""


def transform_from_rotation(position_m: Array, rotation: Array) -> RigidTransform:
    """A pose from an origin [m] and an exact rotation, shape (3, 3)."""
    return _transform(position_m, _from_matrix(rotation))


# SciPy's rotations take a third of a second to import, in every process, and most know no frame.
def _from_quaternion(xyzw: Sequence[float] | Array) -> "Rotation":
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(xyzw)


def _from_matrix(rows: Array) -> "Rotation":
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(rows)


def _transform(position_m: Sequence[float] | Array, rotation: "Rotation") -> RigidTransform:
    x, y, z = (float(value) for value in position_m)
    # Adding zero makes a negative zero a plain one.
    i, j, k, real = (float(value) + 0.0 for value in rotation.as_quat(canonical=True))
    return RigidTransform((x + 0.0, y + 0.0, z + 0.0), (i, j, k, real))


def _about(position_m: Sequence[float], given: Array, kept: Array) -> tuple[FrameWarning, ...]:
    found = []
    change = float(np.abs(given - kept).max())
    if change > FEW_DIGITS:
        detail = f"made an exact rotation by changing its numbers by up to {change:.1g}"
        found.append(FrameWarning("few_digits", detail))
    if math.hypot(*position_m) > SUSPICIOUS_M:
        detail = f"the frame is more than {SUSPICIOUS_M:g} m away; positions are metres"
        found.append(FrameWarning("far", detail))
    return tuple(found)
