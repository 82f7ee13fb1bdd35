"""Targets: blossoms to remove, in the robot's base frame or brought there."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.frames.checks import direction_fault, position_faults
from solver.frames.transforms import RigidTransform


@dataclass(frozen=True)
class Target:
    """A blossom to remove.

    Attributes:
        id: any non-empty text, once in a batch.
        position_m: the blossom in the base frame, three numbers [m].
        branch_direction: along the branch, three numbers of any length above zero; the approach
            angle turns about it as given.
        position_std_m: how uncertain the position is, a standard deviation in every direction [m];
            None: not at all.
    """

    id: str
    position_m: Sequence[float]
    branch_direction: Sequence[float]
    position_std_m: float | None = None


def targets_in_base(
    targets: Sequence[Target], base_from_frame: RigidTransform
) -> tuple[Target, ...]:
    """Targets of a frame in the robot's base frame; branch directions come out as unit vectors.

    Uncertainties are the same in every direction and stay. What is no vector, has no length or is
    too far away for any frame stays as it is, for `Problem` to refuse it where it was sent.
    """
    placed = [k for k, target in enumerate(targets) if _is_place(target)]
    if not placed:
        return tuple(targets)
    positions = base_from_frame.points(np.array([targets[k].position_m for k in placed]))
    directions = np.array([targets[k].branch_direction for k in placed], dtype=float)
    lengths = [math.hypot(*targets[k].branch_direction) for k in placed]
    directions = base_from_frame.directions(directions / np.array(lengths)[:, None])
    moved = list(targets)
    for k, position, direction in zip(placed, positions.tolist(), directions.tolist(), strict=True):
        old = targets[k]
        moved[k] = Target(old.id, tuple(position), tuple(direction), old.position_std_m)
    return tuple(moved)


def _is_place(target: Target) -> bool:
    return not (position_faults(target.position_m, ()) or direction_fault(target.branch_direction))
