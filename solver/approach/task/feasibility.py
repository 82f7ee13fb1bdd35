"""Kernels: one approach of one target on one branch, with its whole cut-in.

Everything here depends on the approach angle alone; a `CutInTask` holds the rest.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple

import numpy as np

from solver.approach.task.packed import LOWER, REFERENCE, UPPER
from solver.approach.task.tolerances import NEAR_FEASIBLE_RAD
from solver.compiled import kernel
from solver.kinematics.spherical_wrist import WristGeometry, one_branch, wrap
from solver.kinematics.straight_rates import between_rate_room, posture_rate_room, posture_rates
from solver.problem.effort import joint_cost
from solver.robots.model import Array


class CutInTask(NamedTuple):
    """One target seen from one reference posture, with the tool on one side, for the kernels.

    Attributes:
        geometry: the arm and tool.
        lower: lower limits less the margin asked for, shape (6,) [rad].
        upper: upper limits less the margin asked for, shape (6,) [rad].
        position: the target, shape (3,) [m].
        y_axis: the tool's y axis, shape (3,).
        outward: approach direction at angle zero, shape (3,).
        sideways: approach direction at a quarter turn, shape (3,).
        retreats: distances behind the target, from the standoff down to 0, shape (rows,) [m].
        reference: posture from which effort counts, shape (6,) [rad].
        weights: weight of each joint, shape (6,).
        squared: the norm is l2.
    """

    geometry: WristGeometry
    lower: Array
    upper: Array
    position: Array
    y_axis: Array
    outward: Array
    sideways: Array
    retreats: Array
    reference: Array
    weights: Array
    squared: bool


@kernel
def tool_axes(task, angle, axes):
    """Writes the tool frame's axes at an approach angle as columns of `axes`, shape (3, 3)."""
    cos, sin = math.cos(angle), math.sin(angle)
    for i in range(3):
        axes[i, 1] = task.y_axis[i]
        axes[i, 2] = cos * task.outward[i] + sin * task.sideways[i]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        axes[i, 0] = axes[j, 1] * axes[k, 2] - axes[k, 1] * axes[j, 2]


@kernel
def posture(task, axes, retreat, branch, q):
    """Writes the posture at a retreat to q, shape (6,); returns the reach margin [m]."""
    position = np.empty(3)
    for i in range(3):
        position[i] = task.position[i] - retreat * axes[i, 2]
    return one_branch(task.geometry, position, axes, branch, q)


@kernel
def limit_margin(task, q):
    """Smallest distance of a joint to its limit [rad], negative outside, and that joint's index."""
    margin, joint = math.inf, 0
    for i in range(6):
        inside = min(q[i] - task.lower[i], task.upper[i] - q[i])
        if inside < margin:
            margin, joint = inside, i
    return margin, joint


@kernel
def thinning(task, angle, branch, q):
    """Writes the thinning posture to q, on the turn nearest to the reference inside the limits.

    Returns the margin: the smallest of the joints' [rad] and the reach's [m].
    """
    axes = np.empty((3, 3))
    tool_axes(task, angle, axes)
    reach = posture(task, axes, 0.0, branch, q)
    nearest_turns(task, q)
    margin, _ = limit_margin(task, q)
    return min(margin, reach)


@kernel
def nearest_turns(task, q):
    """Moves each joint of a posture to the turn nearest to the reference inside its limits."""
    for i in range(6):
        for turn in (-2 * math.pi, 2 * math.pi):
            other = q[i] + turn
            inside = task.lower[i] <= other <= task.upper[i]
            if inside and abs(other - task.reference[i]) < abs(q[i] - task.reference[i]):
                q[i] = other


@kernel
def trace(task, angle, branch, retreats, rows):
    """Writes the cut-in to rows, shape (len(retreats), 6), without turns between rows.

    Retreats descend to 0, the thinning posture. A joint of more than one turn is on the turn
    nearest to the reference on which the whole cut-in is inside its limits.

    Returns the margin: the smallest of the joints' [rad], the reach's [m], and what joints are
    short of the highest rate, in the rows and between them (`rate_room`, `swing_room`).
    """
    axes = np.empty((3, 3))
    tool_axes(task, angle, axes)
    last = len(retreats) - 1
    margin = posture(task, axes, 0.0, branch, rows[last])
    for n in range(last - 1, -1, -1):
        q = rows[n]
        margin = min(margin, posture(task, axes, retreats[n], branch, q))
        for i in range(6):
            q[i] = rows[n + 1, i] + wrap(q[i] - rows[n + 1, i])
        spacing = retreats[n] - retreats[n + 1]
        margin = min(margin, between_rate_room(task.geometry, q, rows[n + 1], spacing))
    for n in range(last + 1):
        margin = min(margin, posture_rate_room(task.geometry, rows[n]))
    choose_turns(task.lower, task.upper, task.reference, rows)
    for n in range(last + 1):
        margin = min(margin, limit_margin(task, rows[n])[0])
    return margin


@kernel
def fastest_joint(geometry, retreats, rows):
    """The largest rate of a joint along a cut-in, in its rows or from row to row, and where.

    Returns:
        The rate [rad/m], the joint, and the row: the one behind where it is from row to row.
    """
    rates, fastest, joint, row = np.empty(6), -1.0, 0, 0
    for n in range(len(rows)):
        posture_rates(geometry, rows[n], rates)
        for i in range(6):
            rate = rates[i]
            if n + 1 < len(rows):
                travel = abs(rows[n, i] - rows[n + 1, i])
                rate = max(rate, travel / (retreats[n] - retreats[n + 1]))
            if rate > fastest:
                fastest, joint, row = rate, i, n
    return fastest, joint, row


@kernel
def choose_turns(lower, upper, reference, rows):
    """Moves joints of more than one turn by whole turns, as `trace` says; rows end at thinning."""
    for i in range(6):
        if upper[i] - lower[i] <= 2 * math.pi:
            continue
        low, high = rows[:, i].min(), rows[:, i].max()
        chosen, nearest = 0.0, math.inf
        for turn in (0.0, -2 * math.pi, 2 * math.pi):
            away = abs(rows[-1, i] + turn - reference[i])
            if low + turn >= lower[i] and high + turn <= upper[i] and away < nearest:
                chosen, nearest = turn, away
        rows[:, i] += chosen


@kernel
def choose_packed_turns(numbers, rows):
    """`choose_turns` for a packed task's numbers."""
    choose_turns(
        numbers[LOWER : LOWER + 6],
        numbers[UPPER : UPPER + 6],
        numbers[REFERENCE : REFERENCE + 6],
        rows,
    )


@kernel
def retreat_from(geometry, pose, branch, retreats, rows):
    """Writes the postures straight behind a pose to rows, shape (len(retreats), 6).

    Retreats descend to 0; the last row holds the thinning posture of the pose, shape (4, 4).
    """
    axes, position = pose[:3, :3], np.empty(3)
    for n in range(len(retreats) - 2, -1, -1):
        for i in range(3):
            position[i] = pose[i, 3] - retreats[n] * axes[i, 2]
        one_branch(geometry, position, axes, branch, rows[n])
        for i in range(6):
            rows[n, i] = rows[n + 1, i] + wrap(rows[n, i] - rows[n + 1, i])


@kernel
def retreat_reach(geometry, pose, branch, retreats, margins):
    """Writes how far the wrist centre is inside the reach behind a pose to margins, (n,) [m]."""
    axes, position, q = pose[:3, :3], np.empty(3), np.empty(6)
    for n in range(len(retreats)):
        for i in range(3):
            position[i] = pose[i, 3] - retreats[n] * axes[i, 2]
        margins[n] = one_branch(geometry, position, axes, branch, q)


@kernel
def retreat_from_many(geometry, poses, branches, retreats, paths):
    """`retreat_from` for n poses; `paths` is shape (n, len(retreats), 6)."""
    for k in range(len(paths)):
        retreat_from(geometry, poses[k], branches[k], retreats, paths[k])


@kernel
def effort(task, q):
    """Weighted joint travel from the reference to q (T's minimum effort; squared for l2)."""
    total = 0.0
    for i in range(6):
        total += task.weights[i] * joint_cost(q[i] - task.reference[i], task.squared)
    return total


@kernel
def evaluate(task, angle, branch, rows):
    """Margin of the whole cut-in and effort of its thinning posture; `rows` is scratch.

    Where the thinning posture alone is far from feasible its margin is returned.
    """
    margin = thinning(task, angle, branch, rows[-1])
    if margin >= -NEAR_FEASIBLE_RAD:
        margin = trace(task, angle, branch, task.retreats, rows)
    return margin, effort(task, rows[-1])


@kernel
def sample(task, angles, margins, efforts):
    """Fills margins and efforts, shape (8, len(angles)), for all branches."""
    rows = np.empty((len(task.retreats), 6))
    for branch in range(8):
        for k in range(len(angles)):
            margins[branch, k], efforts[branch, k] = evaluate(task, angles[k], branch, rows)
