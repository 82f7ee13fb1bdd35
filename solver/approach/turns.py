"""Kernels: cosines and sines of all joints for many angles or retreats at once, and their margins.

Rows of a `turns` array, shape (TURN_ROWS, n): cosine and sine of theta1, 2, 3, of theta4, 5, 6 with
sin(theta5) >= 0 (wrist 0; the other wrist mirrors them), and the reach margin [m]. Written this way
round so that loops over n are vectorised: 15 ns a posture instead of 150.
"""

import math

from solver.approach.packed import (
    COS_HALF,
    COS_MIDDLE,
    SIN_MIDDLE,
    tool_place,
    unpack_circle,
    unpack_geometry,
)
from solver.compiled import inlined, kernel
from solver.kinematics.arctangent import atan2
from solver.kinematics.spherical_wrist import arm_turns, elbow_turns, wrist_turns
from solver.tolerances import SINGULAR_WRIST

TURN_ROWS = 13
REACH = 6
JUMP = 7
CONSTRAINTS = 8
"""Margins of one branch: six joints (cosine form), the reach [m], the wrist jump (cosine form)."""


@inlined
def write_turns(g, circle, cos, sin, retreat, shoulder, elbow, turns, n):
    """Writes column n of turns for an approach angle by its cosine and sine; elbow is 1.0 or -1.0.

    A straight wrist, where theta4 and theta6 are one axis, has theta4 at joint 4's zero.
    """
    place, x, y, z = tool_place(circle, cos, sin, retreat)
    cx = place[0] - g.tool_length * z[0]
    cy = place[1] - g.tool_length * z[1]
    cz = place[2] - g.tool_length * z[2]
    cos1, sin1, r, s, cos_g, sin_g, inverse2, reach = arm_turns(g, cx, cy, cz, shoulder)
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
    turns[12, n] = reach


@kernel
def turns_at_angles(task, cosines, sines, count, retreat, arm, turns):
    """Turns of one arm branch (0 to 3) at the first `count` approach angles, one retreat."""
    g, circle = unpack_geometry(task.numbers), unpack_circle(task.numbers)
    shoulder, elbow = arm // 2, 1.0 - 2.0 * (arm % 2)
    for n in range(count):
        write_turns(g, circle, cosines[n], sines[n], retreat, shoulder, elbow, turns, n)


@kernel
def turns_along_path(task, angle, arm, turns):
    """Turns of one arm branch at one approach angle, for every retreat of the task."""
    shoulder, elbow = arm // 2, 1.0 - 2.0 * (arm % 2)
    cos, sin = math.cos(angle), math.sin(angle)
    g, circle = unpack_geometry(task.numbers), unpack_circle(task.numbers)
    retreats = task.retreats
    for n in range(len(retreats)):
        write_turns(g, circle, cos, sin, retreats[n], shoulder, elbow, turns, n)


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
def row_margin(task, turns, n, wrist, i):
    """Margin of constraint i (a joint or REACH) in column n."""
    return turns[12, n] if i == REACH else turn_margin(task, turns, n, wrist, i)


@kernel
def path_margins(task, turns, wrist, margins):
    """Smallest margins over a whole cut-in's columns, into margins, shape (CONSTRAINTS,)."""
    rows = len(task.retreats)
    for i in range(6):
        cos = wrist_sign(wrist, i, True) * task.numbers[COS_MIDDLE + i]
        sin = wrist_sign(wrist, i, False) * task.numbers[SIN_MIDDLE + i]
        least = math.inf
        for n in range(rows):
            least = min(least, cos * turns[2 * i, n] + sin * turns[2 * i + 1, n])
        margins[i] = least - task.numbers[COS_HALF + i]
    least = math.inf
    for n in range(rows):
        least = min(least, turns[12, n])
    margins[REACH] = least
    least = math.inf
    for n in range(rows - 1):
        allowed = task.cos_steps[n]
        for i in range(6):
            change = (
                turns[2 * i, n] * turns[2 * i, n + 1]
                + turns[2 * i + 1, n] * turns[2 * i + 1, n + 1]
            )
            least = min(least, change - allowed)
    margins[JUMP] = least


@kernel
def swings(before, after, rows, least_cosine):
    """Whether a joint turns far between two angles in some row: arccos(least_cosine) or more.

    It does beside a straight wrist, or with the wrist centre near the waist's axis.
    """
    for i in range(6):
        for n in range(rows):
            change = before[2 * i, n] * after[2 * i, n] + before[2 * i + 1, n] * after[2 * i + 1, n]
            if change < least_cosine:
                return True
    return False


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
