"""Reference kernels, written apart from the solver: T's arm, a sweep of angles, a ladder graph.

Plain on purpose. Every angle is tried and nothing is refined, so what they find is a witness
against the solver's arcs and optima. One file, because Numba's cache notices a changed file and not
a changed callee in another one.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.compiled import kernel

Array = NDArray[np.float64]

BRANCHES = 8
STRIDE = 257
RATE_STEP_M = 1e-6
"""Half the tool travel over which a joint's rate is taken; the rate is good to 1e-7."""


class SweepTask(NamedTuple):
    """What every target of a batch shares.

    Attributes:
        arm: a1, a2, d1, d4, d6 with the tool [m].
        lower: limits less the margin asked for, shape (6,) [rad].
        upper: the same at the other end.
        weights: weight of each joint in the l1 effort, shape (6,).
        cosines: of the approach angles tried, shape (angles,).
        sines: the same.
        retreats: rows of the cut-in, from the standoff down to 0, shape (rows,) [m].
        between: retreats between those rows at which limits hold as well, shape (n,) [m].
        rate: joint travel for tool travel that counts as a wrist jump [rad/m].
    """

    arm: tuple[float, float, float, float, float]
    lower: Array
    upper: Array
    weights: Array
    cosines: Array
    sines: Array
    retreats: Array
    between: Array
    rate: float


@kernel
def wrist_centre_joints(arm, cx, cy, cz, shoulder, elbow):
    """q1, q2, q3 that put the wrist centre there, and whether it is within reach.

    The wrist centre is at r = a2 cos q2 + d4 cos(q2 + q3), h = a2 sin q2 + d4 sin(q2 + q3) in the
    arm's plane, measured from joint 2 (T 3.5 with a3 = d2 = d3 = 0).
    """
    a1, a2, d1, d4, _ = arm
    r, h = math.sqrt(cx * cx + cy * cy), cz - d1
    if shoulder == 1:
        r = -r
    r -= a1
    cosine = (r * r + h * h - a2 * a2 - d4 * d4) / (2 * a2 * d4)
    if abs(cosine) > 1.0:
        return 0.0, 0.0, 0.0, False
    q1, q3 = math.atan2(cy, cx), math.acos(cosine)
    if shoulder == 1:
        q1 -= math.copysign(math.pi, q1)
    if elbow == 1:
        q3 = -q3
    q2 = math.atan2(h, r) - math.atan2(d4 * math.sin(q3), a2 + d4 * cosine)
    if q2 > math.pi:
        q2 -= 2 * math.pi
    elif q2 < -math.pi:
        q2 += 2 * math.pi
    return q1, q2, q3, True


@kernel
def wrist_joints(q1, e, axes, flip):
    """q4, q5, q6 for tool axes; e = q2 + q3 is the forearm's elevation.

    R36 = Rz(q4) Ry(q5) Rz(q6): its third column is (cos4 sin5, sin4 sin5, cos5), its third row
    (-sin5 cos6, sin5 sin6, cos5).
    """
    x, y, z = axes
    c1, s1, ce, se = math.cos(q1), math.sin(q1), math.cos(e), math.sin(e)
    r13 = -c1 * se * z[0] - s1 * se * z[1] + ce * z[2]
    r23 = s1 * z[0] - c1 * z[1]
    r33 = c1 * ce * z[0] + s1 * ce * z[1] + se * z[2]
    r31 = c1 * ce * x[0] + s1 * ce * x[1] + se * x[2]
    r32 = c1 * ce * y[0] + s1 * ce * y[1] + se * y[2]
    sign = 1.0 if flip == 0 else -1.0
    q5 = math.atan2(sign * math.hypot(r13, r23), r33)
    return math.atan2(sign * r23, sign * r13), q5, math.atan2(sign * r32, -sign * r31)


@kernel
def inside(task, i, q):
    """Whether a joint's value is inside its limits."""
    return task.lower[i] <= q <= task.upper[i]


@kernel
def axes_at(frame, cos, sin):
    """The tool's x, y, z as tuples; a frame is position, y, outward and sideways, shape (12,)."""
    y = (frame[3], frame[4], frame[5])
    z = (
        cos * frame[6] + sin * frame[9],
        cos * frame[7] + sin * frame[10],
        cos * frame[8] + sin * frame[11],
    )
    x = (y[1] * z[2] - y[2] * z[1], y[2] * z[0] - y[0] * z[2], y[0] * z[1] - y[1] * z[0])
    return x, y, z


@kernel
def posture(task, frame, axes, retreat, branch, q):
    """Writes a posture of the cut-in to q, shape (6,); returns whether it is inside the limits."""
    z = axes[2]
    back = retreat + task.arm[4]
    cx, cy, cz = frame[0] - back * z[0], frame[1] - back * z[1], frame[2] - back * z[2]
    arm = wrist_centre_joints(task.arm, cx, cy, cz, branch // 4, branch // 2 % 2)
    q[0], q[1], q[2], reached = arm
    if not (reached and inside(task, 0, q[0]) and inside(task, 1, q[1]) and inside(task, 2, q[2])):
        return False
    q[3], q[4], q[5] = wrist_joints(q[0], q[1] + q[2], axes, branch % 2)
    return inside(task, 3, q[3]) and inside(task, 4, q[4]) and inside(task, 5, q[5])


@kernel
def slow_enough(task, frame, axes, retreat, branch):
    """Whether no joint turns faster than it may at a retreat, from the postures just beside it."""
    z, before, after = axes[2], np.empty(6), np.empty(6)
    for side, q in ((-RATE_STEP_M, before), (RATE_STEP_M, after)):
        back = retreat + side + task.arm[4]
        cx, cy, cz = frame[0] - back * z[0], frame[1] - back * z[1], frame[2] - back * z[2]
        arm = wrist_centre_joints(task.arm, cx, cy, cz, branch // 4, branch // 2 % 2)
        q[0], q[1], q[2], reached = arm
        if not reached:
            return False
        q[3], q[4], q[5] = wrist_joints(q[0], q[1] + q[2], axes, branch % 2)
    for i in range(6):
        turn = abs(after[i] - before[i])
        if min(turn, 2 * math.pi - turn) > task.rate * 2 * RATE_STEP_M:
            return False
    return True


@kernel
def cut_in_holds(task, frame, axes, branch, rows):
    """Writes the cut-in to rows, shape (rows, 6); whether all of it is inside, and slow enough.

    No joint of this arm turns as far as once, so inside the limits a posture has one value a joint.
    """
    last = len(task.retreats) - 1
    for n in range(last, -1, -1):
        if not posture(task, frame, axes, task.retreats[n], branch, rows[n]):
            return False
        if n < last:
            allowed = task.rate * (task.retreats[n] - task.retreats[n + 1])
            for i in range(6):
                if abs(rows[n, i] - rows[n + 1, i]) > allowed:
                    return False
    for n in range(last + 1):  # noqa: SIM110  (Numba has no generators in calls)
        if not slow_enough(task, frame, axes, task.retreats[n], branch):
            return False
    return True


@kernel
def inside_between(task, frame, axes, branch, q):
    """Whether postures between the rows are inside, and slow enough; q is scratch, shape (6,)."""
    for retreat in task.between:
        if not posture(task, frame, axes, retreat, branch, q):
            return False
        if not slow_enough(task, frame, axes, retreat, branch):
            return False
    return True


@kernel
def travel(task, q, reference):
    """The l1 effort from a reference to q."""
    total = 0.0
    for i in range(6):
        total += task.weights[i] * abs(q[i] - reference[i])
    return total


@kernel
def sweep(task, frames, reference, best, best_between):
    """Least effort of every target over all angles and branches; infinity where nothing holds.

    Args:
        task: what the targets share.
        frames: shape (targets, 12).
        reference: posture from which effort counts, shape (6,) [rad].
        best: written, shape (targets,): cut-ins that hold at their rows.
        best_between: written: cut-ins that hold between their rows too.
    """
    count, rows, q = len(task.cosines), np.empty((len(task.retreats), 6)), np.empty(6)
    for k in range(len(frames)):
        found = np.array([np.inf, np.inf])
        # In large strides, so that a cheap approach is known soon and dearer ones are cut short.
        for first in range(STRIDE):
            for n in range(first, count, STRIDE):
                axes = axes_at(frames[k], task.cosines[n], task.sines[n])
                try_angle(task, frames[k], axes, reference, found, rows, q)
        best[k], best_between[k] = found


@kernel
def try_angle(task, frame, axes, reference, found, rows, q):
    """Lowers `found`, the two least efforts of `sweep`, by what one angle offers."""
    z = axes[2]
    back = task.arm[4]
    cx, cy, cz = frame[0] - back * z[0], frame[1] - back * z[1], frame[2] - back * z[2]
    for shoulder in range(2):
        for elbow in range(2):
            q[0], q[1], q[2], reached = wrist_centre_joints(task.arm, cx, cy, cz, shoulder, elbow)
            if not reached:
                break
            so_far = 0.0
            for i in range(3):
                so_far += task.weights[i] * abs(q[i] - reference[i])
                if not inside(task, i, q[i]):
                    so_far = np.inf
            if so_far >= found[1]:
                continue
            for flip in range(2):
                q[3], q[4], q[5] = wrist_joints(q[0], q[1] + q[2], axes, flip)
                cost = travel(task, q, reference)
                holds = inside(task, 3, q[3]) and inside(task, 4, q[4]) and inside(task, 5, q[5])
                branch = 4 * shoulder + 2 * elbow + flip
                if not holds or cost >= found[1]:
                    continue
                if not cut_in_holds(task, frame, axes, branch, rows):
                    continue
                found[0] = min(found[0], cost)
                if inside_between(task, frame, axes, branch, rows[0]):
                    found[1] = cost


@kernel
def ladder_nodes(task, frames, most):
    """Every angle and branch whose cut-in holds, target by target.

    Args:
        task: what the targets share.
        frames: shape (targets, 12).
        most: nodes there is room for.

    Returns:
        thinning and standby postures, shape (nodes, 6) each, and layers, shape (targets + 1,):
        target k has the nodes layers[k] up to layers[k + 1].
    """
    thinning, standby = np.empty((most, 6)), np.empty((most, 6))
    layers = np.zeros(len(frames) + 1, dtype=np.int64)
    rows, count = np.empty((len(task.retreats), 6)), 0
    for k in range(len(frames)):
        for n in range(len(task.cosines)):
            axes = axes_at(frames[k], task.cosines[n], task.sines[n])
            for branch in range(BRANCHES):
                if cut_in_holds(task, frames[k], axes, branch, rows):
                    thinning[count], standby[count] = rows[-1], rows[0]
                    count += 1
        layers[k + 1] = count
    return thinning[:count].copy(), standby[:count].copy(), layers


@kernel
def cheapest_chain(weights, thinning, standby, layers, start):
    """Least effort of one node a target in the order of the layers, and those nodes.

    The ladder graph's dynamic programme with every edge between two layers.
    """
    count = len(thinning)
    cost, before = np.empty(count), np.full(count, -1, dtype=np.int64)
    for k in range(len(layers) - 1):
        for j in range(layers[k], layers[k + 1]):
            if k == 0:
                cost[j] = 0.0
                for i in range(6):
                    cost[j] += weights[i] * abs(thinning[j, i] - start[i])
                continue
            least = np.inf
            for h in range(layers[k - 1], layers[k]):
                edge = cost[h]
                for i in range(6):
                    edge += weights[i] * abs(thinning[j, i] - standby[h, i])
                if edge < least:
                    least, before[j] = edge, h
            cost[j] = least
    chain = np.empty(len(layers) - 1, dtype=np.int64)
    first, last = layers[-2], layers[-1]
    node = first + np.argmin(cost[first:last])
    total = cost[node]
    for k in range(len(chain) - 1, -1, -1):
        chain[k] = node
        node = before[node]
    return total, chain
