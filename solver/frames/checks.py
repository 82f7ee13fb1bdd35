"""What keeps numbers from being a place or a direction in space."""

import math
from collections.abc import Sequence

from solver.exceptions import Fault
from solver.frames.tolerances import FURTHEST_M, SHORTEST_DIRECTION


def position_faults(position_m: Sequence[float], path: tuple[str | int, ...]) -> Sequence[Fault]:
    """What keeps three numbers from being a place in space [m]."""
    if detail := vector_fault(position_m, 3):
        return (Fault(path, detail),)
    if max(map(abs, position_m)) > FURTHEST_M:
        return (Fault(path, f"more than {FURTHEST_M:g} m away; positions are metres"),)
    return ()


def direction_fault(values: Sequence[float]) -> str | None:
    """What keeps a sequence from giving a direction in space, of whatever length."""
    if fault := vector_fault(values, 3):
        return fault
    if not SHORTEST_DIRECTION < math.hypot(*values) < math.inf:
        return "the direction has no usable length"
    return None


def vector_fault(values: Sequence[float], length: int) -> str | None:
    """What keeps a sequence from being a vector of that length."""
    if len(values) != length:
        return f"needs {length} numbers, has {len(values)}"
    if not all(math.isfinite(value) for value in values):
        return "has a value that is not finite"
    return None
