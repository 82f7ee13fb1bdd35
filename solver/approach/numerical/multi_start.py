"""Kernels: postures at a target with the approach angle free, from many starts."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple

import numpy as np

from solver.approach.numerical.tolerances import (
    NUMERICAL_MOST_STEP,
    NUMERICAL_PULL_SHARE,
    NUMERICAL_PULL_STEPS,
    NUMERICAL_REACH_STEPS,
    NUMERICAL_REACHED,
    NUMERICAL_TURNS,
)
from solver.approach.task.feasibility import tool_axes
from solver.compiled import kernel
from solver.kinematics.numerical import (
    fill_jacobian,
    locate,
    polish,
    pose_error,
    solve_damped,
)
from solver.robots.model import Array
from solver.tolerances import NUMERICAL_DAMPING


class PoseFamily(NamedTuple):
    """All approaches to one target with the tool on one side, for the kernels.

    Attributes:
        position: the target, shape (3,) [m].
        branch: what the approach angle turns about, shape (3,).
        y_axis: the tool's y axis, the branch or its opposite, shape (3,).
        outward: approach direction at angle zero, shape (3,).
        sideways: approach direction at a quarter turn, shape (3,).
        lower: limits less the margin asked for, shape (n,) [rad or m].
        upper: so on the other side.
        reference: posture that the arm leans towards, shape (n,) [rad or m].
    """

    position: Array
    branch: Array
    y_axis: Array
    outward: Array
    sideways: Array
    lower: Array
    upper: Array
    reference: Array


@kernel
def step_towards(chain, family, axes, share, q, columns, frames):
    """One damped step of q, in place, towards the family; returns the angle's step [rad].

    The approach angle is one more column. Joints that would leave their limits stay at them and the
    others are asked again. `share` leans towards the reference by that part of the way, within what
    keeps the tool where it is to first order.
    """
    n = len(q)
    error, solution = np.empty(6), np.empty(6)
    locate(chain, q, frames)
    size = pose_error(frames[n], family.position, axes, error)
    fill_jacobian(chain, frames, columns)
    for row in range(3):
        columns[row, n] = 0.0
        columns[3 + row, n] = -family.branch[row]
    lean, step = np.zeros(n + 1), np.zeros(n + 1)
    for i in range(n):
        lean[i] = share * (family.reference[i] - q[i])
    for _ in range(n):
        for row in range(6):
            for i in range(n):
                error[row] -= columns[row, i] * lean[i]
        solve_damped(columns, 0.5 * size * size + NUMERICAL_DAMPING, error, solution)
        for row in range(6):
            for i in range(n):
                error[row] += columns[row, i] * lean[i]
        blocked = False
        for i in range(n + 1):
            step[i] = lean[i]
            for row in range(6):
                step[i] += columns[row, i] * solution[row]
        for i in range(n):
            past_upper = q[i] >= family.upper[i] and step[i] > 0.0
            if past_upper or (q[i] <= family.lower[i] and step[i] < 0.0):
                for row in range(6):
                    columns[row, i] = 0.0
                lean[i] = 0.0
                blocked = True
        if not blocked:
            break
    largest = NUMERICAL_MOST_STEP
    for i in range(n + 1):
        largest = max(largest, abs(step[i]))
    for i in range(n):
        moved = q[i] + step[i] * NUMERICAL_MOST_STEP / largest
        q[i] = min(max(moved, family.lower[i]), family.upper[i])
    return step[n] * NUMERICAL_MOST_STEP / largest


@kernel
def nearest_turn(chain, family, q):
    """Brings revolute joints, in place, to the turn nearest to the reference inside the limits."""
    for i in range(len(q)):
        if chain.turning[i] > 0.0:
            for turns in range(-NUMERICAL_TURNS, NUMERICAL_TURNS + 1):
                other = q[i] + 2 * math.pi * turns
                inside = family.lower[i] <= other <= family.upper[i]
                if inside and abs(other - family.reference[i]) < abs(q[i] - family.reference[i]):
                    q[i] = other


@kernel
def arrive(chain, family, angle, q):
    """Brings q, in place, from nearly at the target onto it; returns the error left [m and rad].

    On the turns nearest to the reference, by Newton's method at a fixed approach angle, which does
    not look at limits. A posture that is not nearly there is left as it is.
    """
    n = len(q)
    axes, frames, error = np.empty((3, 3)), np.empty((n + 1, 4, 4)), np.empty(6)
    tool_axes(family, angle, axes)
    locate(chain, q, frames)
    left = pose_error(frames[n], family.position, axes, error)
    if left >= NUMERICAL_REACHED:
        return left
    nearest_turn(chain, family, q)
    return polish(chain, family.position, axes, np.ones(n), q)


@kernel
def from_starts(chain, family, starts, angles, postures, errors):
    """Leads every start to the target, straight to it and then leaning towards the reference.

    Starts, shape (k, n), and their angles, shape (2 k,), whose second half repeats the first, are
    changed. Fills postures, shape (2 k, n), and errors, shape (2 k,): the first half as the starts
    arrived, the second after they leaned, which brings them to few places of little effort. Where
    the cut-in does not hold there, it may at one of the first half.
    """
    count, n = starts.shape
    axes, frames = np.empty((3, 3)), np.empty((n + 1, 4, 4))
    columns = np.empty((6, n + 1))
    for k in range(count):
        q, angle = starts[k], angles[k]
        for phase in range(3):
            leaning = phase == 1
            steps = NUMERICAL_PULL_STEPS if leaning else NUMERICAL_REACH_STEPS
            share = NUMERICAL_PULL_SHARE if leaning else 0.0
            for _ in range(steps):
                tool_axes(family, angle, axes)
                angle += step_towards(chain, family, axes, share, q, columns, frames)
            if not leaning:
                row = k if phase == 0 else count + k
                angles[row] = angle
                for i in range(n):
                    postures[row, i] = q[i]
                errors[row] = arrive(chain, family, angle, postures[row])
