"""Kernels: a feasible point of the relaxations near approaches that are none.

Where no point looked at has an approach, feasible ones may lie between them. From the approach
angles that come closest, angle, strike and swing move together by the shortest step that brings
what is broken inside (Gauss and Newton), until nothing is.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.task.constraints import JOINTS
from solver.approach.task.feasibility import tool_axes
from solver.compiled import kernel
from solver.kinematics.spherical_wrist import BRANCHES, one_branch
from solver.methods.relaxed.descent import turned_about
from solver.methods.relaxed.tolerances import (
    RESTORED_ANGLES,
    RESTORED_DAMPING,
    RESTORED_FAR_RAD,
    RESTORED_INSIDE_RAD,
    RESTORED_LONGEST,
    RESTORED_ROUNDS,
    RESTORED_STARTS,
    RESTORED_STEP,
)

KINDS = 2 * JOINTS + 1


@kernel
def relaxed_posture(task, zone, x, retreat, branch, q):
    """Writes the posture at a retreat to q; returns the reach margin [m].

    `x` is the approach angle [rad], the share of the strike zone, and the swing in shares of the
    tolerance along the approach directions at 0 and at a quarter turn.
    """
    axes, position = np.empty((3, 3)), np.empty(3)
    tool_axes(task, x[0], axes)
    along, across = zone[1] * x[2], zone[1] * x[3]
    angle = math.hypot(along, across)
    if angle > 0.0:
        n = (along * task.outward + across * task.sideways) / angle
        cos, sin = math.cos(angle), math.sin(angle)
        for j in range(3):
            turned = turned_about(n, cos, sin, axes[0, j], axes[1, j], axes[2, j])
            axes[0, j], axes[1, j], axes[2, j] = turned
    beyond = zone[0] * x[1] - retreat
    for i in range(3):
        position[i] = task.position[i] + beyond * axes[i, 2]
    return one_branch(task.geometry, position, axes, branch, q)


@kernel
def room(task, reach, q, kind):
    """How far inside a posture is: of each joint's lower and upper limit [rad], then the reach.

    The reach counts in upper arm's lengths, so that all are angles.
    """
    if kind == KINDS - 1:
        return reach / task.geometry.a2
    i = kind // 2
    return q[i] - task.lower[i] if kind % 2 == 0 else task.upper[i] - q[i]


@kernel
def least_room(task, zone, x, branch, retreats, values, rows):
    """Writes the least room of each kind over the cut-in, and its row; returns the least of all."""
    q = np.empty(JOINTS)
    values[:] = math.inf
    for n in range(len(retreats)):
        reach = relaxed_posture(task, zone, x, retreats[n], branch, q)
        for kind in range(KINDS):
            here = room(task, reach, q, kind)
            if here < values[kind]:
                values[kind], rows[kind] = here, n
    return values.min()


@kernel
def bring_into_zone(x):
    """Brings strike and swing of x back into their zone."""
    x[1] = min(max(x[1], 0.0), 1.0)
    length = math.hypot(x[2], x[3])
    if length > 1.0:
        x[2] /= length
        x[3] /= length


@kernel
def restore(task, zone, branch, x):
    """Moves x until the limits and the reach hold along the cut-in; whether they do."""
    values, rows, q = np.empty(KINDS), np.zeros(KINDS, dtype=np.int64), np.empty(JOINTS)
    gradients, missing = np.empty((KINDS, 4)), np.empty(KINDS)
    ahead = np.empty(4)
    for _ in range(RESTORED_ROUNDS):
        if least_room(task, zone, x, branch, task.retreats, values, rows) >= 0.0:
            return True
        count = 0
        for kind in range(KINDS):
            if values[kind] >= RESTORED_INSIDE_RAD:
                continue
            missing[count] = RESTORED_INSIDE_RAD - values[kind]
            for j in range(4):
                ahead[:] = x
                ahead[j] += RESTORED_STEP
                reach = relaxed_posture(task, zone, ahead, task.retreats[rows[kind]], branch, q)
                gradients[count, j] = (room(task, reach, q, kind) - values[kind]) / RESTORED_STEP
            count += 1
        step = np.zeros(4)
        for _ in range(2):
            normal = RESTORED_DAMPING * np.eye(4)
            pull = np.zeros(4)
            for k in range(count):
                for i in range(4):
                    pull[i] += gradients[k, i] * missing[k]
                    for j in range(4):
                        normal[i, j] += gradients[k, i] * gradients[k, j]
            step[:] = np.linalg.solve(normal, pull)
            # What presses against the strike zone's end stays there, and the others do its part.
            if (x[1] <= 0.0 and step[1] < 0.0) or (x[1] >= 1.0 and step[1] > 0.0):
                gradients[:count, 1] = 0.0
                continue
            break
        longest = np.abs(step).max()
        if longest > RESTORED_LONGEST:
            step *= RESTORED_LONGEST / longest
        ahead[:] = x + step
        bring_into_zone(ahead)
        moved = np.abs(ahead - x).max()
        x[:] = ahead
        if moved < RESTORED_STEP:
            return False
    return False


@kernel
def restored_points(task, zone):
    """Strike and swing of points at which limits and reach hold, shape (n, 3): [m], [rad], [rad].

    From the angles, RESTORED_STARTS at most, that come closest without a swing, at both ends of the
    strike zone.
    """
    ends = np.array([0.0, task.retreats[0]])
    step = 2.0 * math.pi / RESTORED_ANGLES
    shares = np.array([0.0, 1.0]) if zone[0] > 0.0 else np.zeros(1)
    margins = np.empty((len(shares), BRANCHES, RESTORED_ANGLES))
    values, rows, x = np.empty(KINDS), np.zeros(KINDS, dtype=np.int64), np.zeros(4)
    for m in range(len(shares)):
        for branch in range(BRANCHES):
            for k in range(RESTORED_ANGLES):
                x[0], x[1] = k * step, shares[m]
                margins[m, branch, k] = least_room(task, zone, x, branch, ends, values, rows)
    peaks = np.full((len(shares), BRANCHES, RESTORED_ANGLES), -math.inf)
    for m in range(len(shares)):
        for branch in range(BRANCHES):
            own = margins[m, branch]
            for k in range(RESTORED_ANGLES):
                beside = max(own[k - 1], own[(k + 1) % RESTORED_ANGLES])
                if own[k] >= beside and own[k] > -RESTORED_FAR_RAD:
                    peaks[m, branch, k] = own[k]
    found, count = np.empty((RESTORED_STARTS, 3)), 0
    for _ in range(RESTORED_STARTS):
        m, rest = divmod(int(np.argmax(peaks)), BRANCHES * RESTORED_ANGLES)
        branch, k = divmod(rest, RESTORED_ANGLES)
        if peaks[m, branch, k] == -math.inf:
            break
        peaks[m, branch, k] = -math.inf
        x[:] = 0.0
        x[0], x[1] = k * step, shares[m]
        if restore(task, zone, branch, x):
            found[count, 0], found[count, 1] = zone[0] * x[1], zone[1] * x[2]
            found[count, 2] = zone[1] * x[3]
            count += 1
    return found[:count]
