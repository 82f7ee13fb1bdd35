"""Kernels: what effort is at least for a branch in a cell of the approach angle.

It follows from the thinning posture at the cell's ends and one cell beyond them.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

from solver.approach.arcs.cells import enters_reach
from solver.approach.arcs.tolerances import CELL_SWING_COSINE
from solver.approach.arcs.turns import wrist_sign
from solver.approach.task.packed import REFERENCE, SQUARED, WEIGHTS, unpack_geometry
from solver.approach.tolerances import TURN_CHANGE_SHARE
from solver.compiled import inlined, kernel
from solver.kinematics.arctangent import atan2
from solver.problem.effort import joint_cost


@kernel
def write_reference(task, reference):
    """Writes cosine and sine of each joint's theta in the reference posture, shape (6, 2)."""
    offsets = unpack_geometry(task.numbers).offsets
    for i in range(6):
        theta = task.numbers[REFERENCE + i] + offsets[i]
        reference[i, 0], reference[i, 1] = math.cos(theta), math.sin(theta)


@inlined
def angle_of_cosine(cosine):
    """The angle between two directions, from its cosine [rad]."""
    return atan2(math.sqrt(max((1.0 - cosine) * (1.0 + cosine), 0.0)), cosine)


@kernel
def effort_at_least(task, reference, wrist, outer, j, left, k, right, m, beyond, n):
    """What effort is at least in a cell of the turn.

    A joint leaves the range between the cell's ends by a TURN_CHANGE_SHARE of what its turn changes
    from cell to cell, by all that it turns where the arm enters its reach; nothing is said of one
    that swings. A joint of more than one turn counts by its nearest.

    Args:
        task: the packed task.
        reference: what `write_reference` wrote, shape (6, 2).
        wrist: 0 or 1.
        outer: turns with the thinning posture one cell before the cell's lower end.
        j: its column there.
        left: the same at the lower end.
        k: its column.
        right: the same at the upper end.
        m: its column.
        beyond: the same one cell further.
        n: its column.
    """
    edge, total = enters_reach(left, k, right, m), 0.0
    for i in range(6):
        c, s = 2 * i, 2 * i + 1
        ca, sa, cb, sb = left[c, k], left[s, k], right[c, m], right[s, m]
        inside = ca * cb + sa * sb
        if inside < CELL_SWING_COSINE:
            continue
        cos = wrist_sign(wrist, i, True) * reference[i, 0]
        sin = wrist_sign(wrist, i, False) * reference[i, 1]
        ahead_a, ahead_b = ca * cos + sa * sin, cb * cos + sb * sin
        passes = (sa * cos < ca * sin) != (sb * cos < cb * sin)
        if passes and ahead_a > 0.0 and ahead_b > 0.0:
            continue
        if edge:
            before = outer[c, j] * ca + outer[s, j] * sa
            after = beyond[c, n] * cb + beyond[s, n] * sb
            slack = angle_of_cosine(min(inside, before, after))
        else:
            turn = sb * ca - cb * sa
            before = sa * outer[c, j] - ca * outer[s, j]
            after = beyond[s, n] * cb - beyond[c, n] * sb
            slack = TURN_CHANGE_SHARE * max(abs(turn - before), abs(after - turn))
        least = max(angle_of_cosine(max(ahead_a, ahead_b)) - slack, 0.0)
        total += task.numbers[WEIGHTS + i] * joint_cost(least, task.numbers[SQUARED] > 0.0)
    return total
