"""What an approach can fail at, numbered alike wherever kernels tell Python."""

from enum import IntEnum
from typing import Final

JOINTS: Final = 6
"""A joint counts by its index, 0 to 5."""

LIMITS: Final = 2 * JOINTS + 1
"""Limits of one row: 2 i is joint i's lower one, 2 i + 1 its upper one, the last is the reach."""


class Constraint(IntEnum):
    """What ends an arc, or stops a displacement, where it is no joint."""

    NONE = -1
    REACH = JOINTS
    BESIDE = JOINTS + 1
    JUMP = JOINTS + 2


# Kernels write them to arrays of floats, which Numba does with plain numbers only.
REACH: Final = int(Constraint.REACH)
"""The reach of the two links."""

BESIDE: Final = int(Constraint.BESIDE)
"""The reach beside the waist's axis, where the shoulder stands off it."""

JUMP: Final = int(Constraint.JUMP)
"""A joint that turns faster along the cut-in than it may."""

WHOLE_TURN: Final = int(Constraint.NONE)
"""Nothing: the arc is the whole turn."""
