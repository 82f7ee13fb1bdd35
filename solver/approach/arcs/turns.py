"""Kernels: cosines and sines of all joints for many angles or retreats at once, and their margins.

Rows of a `turns` array, shape (TURN_ROWS, n): cosine and sine of theta1, 2, 3, of theta4, 5, 6 with
sin(theta5) >= 0 (wrist 0; the other wrist mirrors them), both reach margins [m], and a row of
working memory. Written this way round so that loops over n are vectorised, which is to say stored:
15 ns a posture instead of 150.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

from solver.approach.task.constraints import BESIDE, JUMP, REACH
from solver.approach.task.packed import (
    COS_HALF,
    COS_MIDDLE,
    SIN_MIDDLE,
    tool_place,
    unpack_circle,
    unpack_geometry,
)
from solver.compiled import inlined, kernel, minimum
from solver.kinematics.arctangent import atan2
from solver.kinematics.spherical_wrist import arm_turns, elbow_turns, wrist_turns
from solver.kinematics.straight_rates import ahead_share, rate_room, swing_room
from solver.tolerances import SINGULAR_WRIST

TURN_ROWS = 15
_WORK = 14

CONSTRAINTS = JUMP + 1
"""Margins of one branch: six joints (cosine form), the reach [m], the shoulder's offset beside the
waist's axis [m], and how fast joints turn along the cut-in."""

ROW_CONSTRAINTS = 11
WRIST_ROWS = 5
JOINT_OF_ROW = (-1, -1, 0, 1, 2, 3, 4, 5, 3, 4, 5)
"""Constraints of one row of the cut-in for both wrists: the two reaches, joints 1 to 3, joints 4 to
6 of wrist 0, then of wrist 1."""


@kernel
def write_turns(task, count, arm, turns):
    """Turns of one arm branch (0 to 3) in the first `count` columns, in the place of their places.

    A straight wrist, where theta4 and theta6 are one axis, has theta4 at joint 4's zero.

    Args:
        task: the packed task.
        count: how many columns are in use.
        arm: twice the shoulder's number plus the elbow's.
        turns: shape (TURN_ROWS, count or more). Given: cosine and sine of the approach angle and
            the retreat [m] in the first three rows; all others are written.
    """
    g, circle = unpack_geometry(task.numbers), unpack_circle(task.numbers)
    shoulder, elbow = arm // 2, 1.0 - 2.0 * (arm % 2)
    # The compiler makes a vector loop of this as long as nothing in it is called with an array, and
    # no further array has to be told apart from the rows.
    for n in range(count):
        place, x, y, z = tool_place(circle, turns[0, n], turns[1, n], turns[2, n])
        cx = place[0] - g.tool_length * z[0]
        cy = place[1] - g.tool_length * z[1]
        cz = place[2] - g.tool_length * z[2]
        cos1, sin1, r, s, cos_g, sin_g, inverse2, reach, beside = arm_turns(g, cx, cy, cz, shoulder)
        sin_g = sin_g * elbow
        cos2, sin2, cos3, sin3, cos23, sin23 = elbow_turns(g, r, s, cos_g, sin_g, inverse2)
        r13, r23, cos5, r31, r32 = wrist_turns(g, cos1, sin1, cos23, sin23, x, y, z)
        sin5 = math.sqrt(r13 * r13 + r23 * r23)
        inverse5 = 1.0 / max(sin5, SINGULAR_WRIST)
        turns[0, n], turns[1, n] = cos1, sin1
        turns[2, n], turns[3, n] = cos2, sin2
        turns[4, n], turns[5, n] = cos3, sin3
        turns[6, n], turns[7, n] = g.sign5 * r13 * inverse5, g.sign5 * r23 * inverse5
        turns[8, n], turns[9, n] = cos5, sin5
        turns[10, n], turns[11, n] = g.sign4 * r31 * inverse5, -g.sign4 * r32 * inverse5
        turns[12, n], turns[13, n] = reach, beside


@kernel
def reaches_at_angles(task, cosines, sines, shoulder, values):
    """Both reach margins of the thinning posture, shared by the elbows, into rows of values."""
    g, circle = unpack_geometry(task.numbers), unpack_circle(task.numbers)
    for n in range(len(cosines)):
        place, _, _, z = tool_place(circle, cosines[n], sines[n], 0.0)
        cx = place[0] - g.tool_length * z[0]
        cy = place[1] - g.tool_length * z[1]
        cz = place[2] - g.tool_length * z[2]
        _, _, _, _, _, _, _, values[0, n], values[1, n] = arm_turns(g, cx, cy, cz, shoulder)


@kernel
def turns_at_angles(task, angles, count, retreat, arm, turns):
    """Turns of one arm branch at the first `count` of some approach angles, at one retreat."""
    for n in range(count):
        turns[0, n], turns[1, n], turns[2, n] = math.cos(angles[n]), math.sin(angles[n]), retreat
    write_turns(task, count, arm, turns)


@inlined
def path_columns(rows):
    """Columns of the turns of a cut-in of that many rows: a multiple of what a vector holds.

    And so many that the vector loop is worth its preparations: 16 columns take twice as long as 24.
    """
    return max(24, 8 * ((rows + 7) // 8))


@kernel
def turns_along_path(task, angle, arm, turns):
    """Turns of one arm branch at one approach angle, for every retreat of the task.

    `turns` has `path_columns` columns; those beyond the retreats are the thinning posture's.
    """
    rows, columns = len(task.retreats), turns.shape[1]
    turns[0], turns[1], turns[2] = math.cos(angle), math.sin(angle), 0.0
    turns[2, :rows] = task.retreats
    write_turns(task, columns, arm, turns)


@inlined
def wrist_sign(wrist, i, is_cosine):
    """-1 for what the other wrist mirrors: joints 4 and 6 by half a turn, joint 5 its sign."""
    mirrored = i == 3 or i == 5 or (i == 4 and not is_cosine)
    return -1.0 if wrist == 1 and mirrored else 1.0


@inlined
def turn_margin(task, turns, n, wrist, i):
    """Cosine-form margin of joint i in column n: not negative inside the limits."""
    cos = wrist_sign(wrist, i, True) * task.numbers[COS_MIDDLE + i]
    sin = wrist_sign(wrist, i, False) * task.numbers[SIN_MIDDLE + i]
    return cos * turns[2 * i, n] + sin * turns[2 * i + 1, n] - task.numbers[COS_HALF + i]


@kernel
def row_constraints(task, turns, count, values):
    """Margins of one row's constraints at many angles, shape (ROW_CONSTRAINTS, count)."""
    for n in range(count):
        values[0, n], values[1, n] = turns[12, n], turns[13, n]
    for row in range(2, ROW_CONSTRAINTS):
        i, wrist = JOINT_OF_ROW[row], 1 if row >= WRIST_ROWS + 3 else 0
        cos = wrist_sign(wrist, i, True) * task.numbers[COS_MIDDLE + i]
        sin = wrist_sign(wrist, i, False) * task.numbers[SIN_MIDDLE + i]
        half = task.numbers[COS_HALF + i]
        for n in range(count):
            values[row, n] = cos * turns[2 * i, n] + sin * turns[2 * i + 1, n] - half


@kernel
def row_margin(task, turns, n, wrist, i):
    """Margin of constraint i (a joint, REACH or BESIDE) in column n."""
    return turns[6 + i, n] if i >= REACH else turn_margin(task, turns, n, wrist, i)


@minimum
def path_margins(task, turns, wrist, margins):
    """Smallest margins over a whole cut-in's columns, into margins, shape (CONSTRAINTS,)."""
    # Columns beyond the cut-in's are the thinning posture's, which is one of its own.
    columns = turns.shape[1]
    for i in range(6):
        cos = wrist_sign(wrist, i, True) * task.numbers[COS_MIDDLE + i]
        sin = wrist_sign(wrist, i, False) * task.numbers[SIN_MIDDLE + i]
        for n in range(columns):
            turns[_WORK, n] = cos * turns[2 * i, n] + sin * turns[2 * i + 1, n]
        margins[i] = least_of(turns, _WORK) - task.numbers[COS_HALF + i]
    for i in (REACH, BESIDE):
        margins[i] = least_of(turns, 6 + i)
    margins[JUMP] = jump_margin(task, turns, wrist)


@inlined
def least_of(turns, row):
    """The least value in a row of turns, whose columns are a multiple of 8, four by four."""
    first, second, third, fourth = turns[row, 0], turns[row, 1], turns[row, 2], turns[row, 3]
    for n in range(4, turns.shape[1], 4):
        first, second = min(first, turns[row, n]), min(second, turns[row, n + 1])
        third, fourth = min(third, turns[row, n + 2]), min(fourth, turns[row, n + 3])
    return min(min(first, second), min(third, fourth))


@inlined
def row_room(g, turns, n):
    """What joints are short of JOINT_RATE_RAD_M in column n; the same for both wrists."""
    return rate_room(
        g, turns[2, n], turns[3, n], turns[4, n], turns[5, n],
        turns[6, n], turns[7, n], turns[8, n], turns[9, n],
    )  # fmt: skip


@minimum
def jump_margin(task, turns, wrist):
    """Smallest room that joints have below JOINT_RATE_RAD_M, in the rows and between them.

    Joints 1, 4 and 6 swing by half a turn in no distance where the wrist centre passes the waist's
    axis, or the wrist is straight: they are slow in all rows then, so they are looked at between
    rows too, as if the row's direction went straight on to the next one's. What that is off by
    is left to those who look closer. A joint that is inside its limits in two rows, and outside on
    the short way between them, has jumped as well.
    """
    steps, columns, widest = len(task.retreats) - 1, turns.shape[1], math.inf
    g = unpack_geometry(task.numbers)
    for n in range(columns):
        turns[_WORK, n] = row_room(g, turns, n)
    least = least_of(turns, _WORK)
    for n in range(steps):
        m = n + 1
        per_metre = 1.0 / (task.retreats[n] - task.retreats[m])
        sin5, sin5_next = turns[9, n], turns[9, m]
        at4 = swing_room(
            sin5 * turns[6, n], sin5 * turns[7, n],
            sin5_next * turns[6, m], sin5_next * turns[7, m], per_metre,
        )  # fmt: skip
        at6 = swing_room(
            sin5 * turns[10, n], sin5 * turns[11, n],
            sin5_next * turns[10, m], sin5_next * turns[11, m], per_metre,
        )  # fmt: skip
        x, x_next = ahead_of_waist(g, turns, n), ahead_of_waist(g, turns, m)
        at1 = swing_room(
            x * turns[0, n], x * turns[1, n], x_next * turns[0, m], x_next * turns[1, m], per_metre
        )
        turns[_WORK, n] = min(at1, min(at4, at6))
    least = min(least, least_of(turns, _WORK))
    for n in range(steps):
        widest = min(widest, task.cos_steps[n])
    for i in range(6):
        half = task.numbers[COS_HALF + i]
        if half < 0.0 and widest < 2 * half * half - 1.0:
            for n in range(steps):
                if passes_behind(task, turns, n, turns, n + 1, wrist, i):
                    least = min(least, -1.0)
    return least


@inlined
def ahead_of_waist(g, turns, n):
    """How far the wrist centre is ahead of the waist's axis in column n, over the arm's length."""
    return ahead_share(g, turns[2, n], turns[3, n], turns[4, n], turns[5, n])


@kernel
def passes_behind(task, left, m, right, n, wrist, i):
    """Whether a joint passes what it may not reach on the short way from column m to column n.

    It does where it is on both sides of the direction opposite to the middle of its limits, and
    nearer to that than to the middle.
    """
    cos = wrist_sign(wrist, i, True)
    sin = wrist_sign(wrist, i, False)
    middle_cos, middle_sin = task.numbers[COS_MIDDLE + i], task.numbers[SIN_MIDDLE + i]
    ca, sa = cos * left[2 * i, m], sin * left[2 * i + 1, m]
    cb, sb = cos * right[2 * i, n], sin * right[2 * i + 1, n]
    side_a, side_b = sa * middle_cos - ca * middle_sin, sb * middle_cos - cb * middle_sin
    ahead_a, ahead_b = ca * middle_cos + sa * middle_sin, cb * middle_cos + sb * middle_sin
    free = task.numbers[COS_HALF + i] <= -1.0
    return not free and (side_a < 0.0) != (side_b < 0.0) and ahead_a < 0.0 and ahead_b < 0.0


@minimum
def turn_cosine(before, after, rows):
    """Cosine of the farthest that a joint turns between two angles in some row.

    It turns far beside a straight wrist, or with the wrist centre near the waist's axis.
    """
    least = 1.0
    for i in range(6):
        for n in range(rows):
            change = before[2 * i, n] * after[2 * i, n] + before[2 * i + 1, n] * after[2 * i + 1, n]
            least = min(least, change)
    return least


@inlined
def turned(cos, sin, offset, middle):
    """The joint value for the cosine and sine of theta, within half a turn of the middle [rad]."""
    angle = atan2(sin, cos) - offset - middle
    return middle + angle - 2 * math.pi * math.floor((angle + math.pi) / (2 * math.pi))


@kernel
def joints_of_turns(task, turns, count, wrist, q):
    """Joint vectors into q, shape (6, count), each within half a turn of its limits' middle."""
    g = unpack_geometry(task.numbers)
    for i in range(6):
        flip_cos, flip_sin = wrist_sign(wrist, i, True), wrist_sign(wrist, i, False)
        offset, middle = g.offsets[i], g.middles[i]
        for n in range(count):
            q[i, n] = turned(
                flip_cos * turns[2 * i, n], flip_sin * turns[2 * i + 1, n], offset, middle
            )
