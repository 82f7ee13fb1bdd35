"""Kernels: any serial chain, its pose, its Jacobian and Newton's method on them.

For arms that `solver.kinematics.spherical_wrist` does not cover, with any number of joints. A
pose's error has three rows of position [m] and three of the rotation vector that is left [rad].
Steps are damped least squares, dq = J^T (J J^T + damping I)^-1 e: the shortest step where joints
are redundant.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from solver.compiled import kernel
from solver.kinematics.tolerances import (
    NUMERICAL_FOLLOWED,
    NUMERICAL_MOST_PIECES,
    NUMERICAL_POLISH_STEPS,
    NUMERICAL_POLISHED,
)
from solver.robots.model import Array, Robot, Tool
from solver.tolerances import LEAST_DIVISOR, NUMERICAL_DAMPING


class Chain(NamedTuple):
    """What the kernels know of an arm: Denavit-Hartenberg columns, shape (n,), and its mount.

    Attributes:
        turning: 1 for revolute, 0 for prismatic joints.
        mount: the first joint's frame, shape (4, 4) [m].
        flange: cosine and sine of the flange's roll, and the tool's length, shape (3,).
    """

    a: Array
    d: Array
    offsets: Array
    cos_twists: Array
    sin_twists: Array
    turning: Array
    mount: Array
    flange: Array


@lru_cache(maxsize=64)
def chain_of(robot: Robot, tool: Tool) -> Chain:
    """The kernels' parameters of an arm with a tool."""
    twists = np.array([joint.alpha_rad for joint in robot.joints])
    return Chain(
        a=np.array([joint.a_m for joint in robot.joints]),
        d=np.array([joint.d_m for joint in robot.joints]),
        offsets=np.array([joint.offset_rad for joint in robot.joints]),
        cos_twists=np.cos(twists),
        sin_twists=np.sin(twists),
        turning=np.array(robot.turning),
        mount=np.array(robot.mount),
        flange=np.array(
            [math.cos(robot.flange_roll_rad), math.sin(robot.flange_roll_rad), tool.length_m]
        ),
    )


def postures_behind(robot: Robot, tool: Tool, thinning: Array, retreats: Array) -> Array:
    """Postures straight behind a thinning posture, each from its neighbour by Newton's method.

    Joints beyond six stand still, as a rail does (`free_joints` chooses them from the thinning
    posture), so that a posture depends on its retreat and not on the rows that lead to it.

    Args:
        robot: any arm.
        tool: its tool.
        thinning: the posture at the target, shape (n,) [rad or m].
        retreats: distances behind the target, descending to 0, shape (rows,) [m].

    Returns:
        Shape (rows, n); the last row is `thinning` itself. Where no posture reaches, rows are as
        near as the method came: the verifier measures what they miss.
    """
    chain = chain_of(robot, tool)
    rows = np.empty((len(retreats), len(robot.joints)))
    rows[-1] = thinning
    frames = np.empty((len(robot.joints) + 1, 4, 4))
    locate(chain, rows[-1], frames)
    follow(chain, frames[-1, :3, 3].copy(), frames[-1, :3, :3].copy(), retreats, rows)
    return rows


@kernel
def locate(chain, q, frames):
    """Writes the frames of all links to frames, shape (n + 1, 4, 4), the mount first."""
    for row in range(4):
        for column in range(4):
            frames[0, row, column] = chain.mount[row, column]
    for i in range(len(q)):
        theta = chain.offsets[i] + chain.turning[i] * q[i]
        length = chain.d[i] + (1.0 - chain.turning[i]) * q[i]
        cos, sin = math.cos(theta), math.sin(theta)
        cos_twist, sin_twist = chain.cos_twists[i], chain.sin_twists[i]
        for row in range(3):
            x, y, z = frames[i, row, 0], frames[i, row, 1], frames[i, row, 2]
            along = cos * x + sin * y
            across = cos * y - sin * x
            frames[i + 1, row, 0] = along
            frames[i + 1, row, 1] = cos_twist * across + sin_twist * z
            frames[i + 1, row, 2] = cos_twist * z - sin_twist * across
            frames[i + 1, row, 3] = frames[i, row, 3] + chain.a[i] * along + length * z
            frames[i + 1, 3, row] = 0.0
        frames[i + 1, 3, 3] = 1.0
    last = len(q)
    for row in range(3):
        x, y = frames[last, row, 0], frames[last, row, 1]
        frames[last, row, 0] = chain.flange[0] * x + chain.flange[1] * y
        frames[last, row, 1] = chain.flange[0] * y - chain.flange[1] * x
        frames[last, row, 3] += chain.flange[2] * frames[last, row, 2]


@kernel
def fill_jacobian(chain, frames, columns):
    """Writes the geometric Jacobian of the tool centre point to columns, shape (6, n)."""
    last = len(frames) - 1
    for i in range(last):
        turning = chain.turning[i]
        for row in range(3):
            j, k = (row + 1) % 3, (row + 2) % 3
            arm_j = frames[last, j, 3] - frames[i, j, 3]
            arm_k = frames[last, k, 3] - frames[i, k, 3]
            turned = frames[i, j, 2] * arm_k - frames[i, k, 2] * arm_j
            columns[row, i] = turning * turned + (1.0 - turning) * frames[i, row, 2]
            columns[3 + row, i] = turning * frames[i, row, 2]


@kernel
def pose_error(frame, position, axes, error):
    """Writes what is left to a pose to error, shape (6,); returns its norm [m and rad]."""
    trace = 0.0
    for row in range(3):
        error[row] = position[row] - frame[row, 3]
        error[3 + row] = 0.0
    for column in range(3):
        for row in range(3):
            j, k = (row + 1) % 3, (row + 2) % 3
            error[3 + row] += (
                frame[j, column] * axes[k, column] - frame[k, column] * axes[j, column]
            ) / 2
            trace += frame[row, column] * axes[row, column]
    sine = math.sqrt(error[3] ** 2 + error[4] ** 2 + error[5] ** 2)
    angle = math.atan2(sine, (trace - 1.0) / 2)
    if sine > 0.0:
        for row in range(3):
            error[3 + row] *= angle / sine
    total = angle**2
    for row in range(3):
        total += error[row] ** 2
    return math.sqrt(total)


@kernel
def solve_damped(columns, damping, error, solution):
    """Solves (J J^T + damping I) solution = error, J of shape (6, any)."""
    gram = np.empty((6, 6))
    for i in range(6):
        for j in range(i + 1):
            gram[i, j] = damping if i == j else 0.0
            for k in range(columns.shape[1]):
                gram[i, j] += columns[i, k] * columns[j, k]
    solve_gram(gram, error, solution)


@kernel
def solve_gram(gram, right, solution):
    """Solves gram solution = right by Cholesky, which the lower half of gram is replaced by."""
    n = len(right)
    for i in range(n):
        for j in range(i + 1):
            total = gram[i, j]
            for k in range(j):
                total -= gram[i, k] * gram[j, k]
            if i == j:
                gram[i, i] = math.sqrt(max(total, LEAST_DIVISOR))
            else:
                gram[i, j] = total / gram[j, j]
    for i in range(n):
        total = right[i]
        for k in range(i):
            total -= gram[i, k] * solution[k]
        solution[i] = total / gram[i, i]
    for i in range(n - 1, -1, -1):
        total = solution[i]
        for k in range(i + 1, n):
            total -= gram[k, i] * solution[k]
        solution[i] = total / gram[i, i]


@kernel
def free_joints(chain, frames, columns):
    """The six joints whose columns span the most, largest first; shape (n,), 1 free and 0 still."""
    n = columns.shape[1]
    fill_jacobian(chain, frames, columns)
    left = columns.copy()
    free = np.zeros(n)
    for _ in range(min(n, 6)):
        best, length = -1, -1.0
        for i in range(n):
            square = 0.0
            for row in range(6):
                square += left[row, i] ** 2
            if free[i] == 0.0 and square > length:
                best, length = i, square
        free[best] = 1.0
        for i in range(n):
            if i == best or length == 0.0:
                continue
            share = 0.0
            for row in range(6):
                share += left[row, best] * left[row, i] / length
            for row in range(6):
                left[row, i] -= share * left[row, best]
    return free


@kernel
def polish(chain, position, axes, free, q):
    """Newton's method from q, in place, to a pose, with the free joints; returns the error left."""
    n = len(q)
    frames, columns = np.empty((n + 1, 4, 4)), np.empty((6, n))
    error, solution = np.empty(6), np.empty(6)
    before = math.inf
    for _ in range(NUMERICAL_POLISH_STEPS):
        locate(chain, q, frames)
        size = pose_error(frames[n], position, axes, error)
        if size < NUMERICAL_POLISHED or size >= before:
            return size
        before = size
        fill_jacobian(chain, frames, columns)
        for row in range(6):
            for i in range(n):
                columns[row, i] *= free[i]
        # The damping goes to nothing with the error, so that the last steps are Newton's own.
        solve_damped(columns, min(NUMERICAL_DAMPING, size * size), error, solution)
        for i in range(n):
            for row in range(6):
                q[i] += columns[row, i] * solution[row]
    locate(chain, q, frames)
    return pose_error(frames[n], position, axes, error)


@kernel
def follow(chain, position, axes, retreats, rows):
    """Writes the postures at retreats behind a pose to rows, shape (len(retreats), n).

    The last row is given; each other starts from the row after it. Returns the largest error left
    [m and rad].
    """
    n = rows.shape[1]
    frames = np.empty((n + 1, 4, 4))
    locate(chain, rows[-1], frames)
    free = free_joints(chain, frames, np.empty((6, n)))
    return follow_with(chain, position, axes, free, retreats, rows)


@kernel
def follow_with(chain, position, axes, free, retreats, rows):
    """`follow` with the joints that are to move, shape (n,), 1 free and 0 still."""
    n, worst = rows.shape[1], 0.0
    place = np.empty(3)
    for k in range(len(retreats) - 2, -1, -1):
        # Where the joints turn fast, Newton's method needs a nearer neighbour than the row after.
        pieces, left = 1, math.inf
        while left > NUMERICAL_FOLLOWED and pieces <= NUMERICAL_MOST_PIECES:
            left = 0.0
            for i in range(n):
                rows[k, i] = rows[k + 1, i]
            for piece in range(1, pieces + 1):
                retreat = retreats[k + 1] + (retreats[k] - retreats[k + 1]) * piece / pieces
                for row in range(3):
                    place[row] = position[row] - retreat * axes[row, 2]
                left = max(left, polish(chain, place, axes, free, rows[k]))
            pieces *= 4
        worst = max(worst, left)
    return worst
