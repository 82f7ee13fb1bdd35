"""Kernels: whether a cut-in sampled at even rows may break a limit between two of them."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

from solver.approach.cut_in.tolerances import (
    BETWEEN_ROWS_CUSHION,
    BETWEEN_ROWS_REACH,
    MARGIN_CUSHION,
    MARGIN_REACH,
)
from solver.compiled import kernel


@kernel
def may_leave_between(rows, lower, upper):
    """Whether a joint may turn back beyond its limit between two rows.

    Through each three neighbouring rows goes one parabola for each joint. Only one with its vertex
    between two rows, or close to one, and near a limit there, has to be looked at closely.

    Args:
        rows: evenly spaced along the cut-in, shape (rows, 6) [rad].
        lower: lower limits, shape (6,) [rad].
        upper: upper limits, shape (6,) [rad].
    """
    count = len(rows)
    if count < 3:
        return True
    for i in range(rows.shape[1]):
        for n in range(count - 1):
            slope = rows[n + 1, i] - rows[n, i]
            for middle in (max(n, 1), min(n + 1, count - 2)):
                bend = rows[middle + 1, i] - 2 * rows[middle, i] + rows[middle - 1, i]
                if bend == 0.0:
                    continue
                place = 0.5 - slope / bend
                if place < -BETWEEN_ROWS_REACH or place > 1.0 + BETWEEN_ROWS_REACH:
                    continue
                place = min(max(place, 0.0), 1.0)
                vertex = rows[n, i] + slope * place + bend / 2 * place * (place - 1.0)
                cushion = BETWEEN_ROWS_CUSHION * abs(bend)
                if vertex - cushion < lower[i] or vertex + cushion > upper[i]:
                    return True
    return False


@kernel
def may_fall_below_zero_between(room):
    """Whether a margin may be negative between two even rows: of the reach, or a rate's room.

    Args:
        room: the margin in each row, shape (rows,).
    """
    count = len(room)
    for n in range(count - 1):
        slope = room[n + 1] - room[n]
        for middle in (max(n, 1), min(n + 1, count - 2)):
            bend = room[middle + 1] - 2 * room[middle] + room[middle - 1]
            if bend <= 0.0:
                continue
            place = 0.5 - slope / bend
            if place < -MARGIN_REACH or place > 1.0 + MARGIN_REACH:
                continue
            place = min(max(place, 0.0), 1.0)
            vertex = room[n] + slope * place + bend / 2 * place * (place - 1.0)
            if vertex < MARGIN_CUSHION * bend:
                return True
    return False
