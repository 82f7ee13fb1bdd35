"""Kernel: from an approach of an arm without a closed form to a cheaper one beside it."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.numerical.multi_start import PoseFamily, step_towards
from solver.approach.numerical.tolerances import (
    DESCENT_FIRST_STEP,
    DESCENT_GAIN,
    DESCENT_GROWTH,
    DESCENT_LAST_STEP,
    DESCENT_REACHED,
    DESCENT_RETURN_STEPS,
    DESCENT_SHRINKAGE,
)
from solver.approach.task.feasibility import tool_axes
from solver.compiled import kernel
from solver.kinematics.numerical import (
    fill_jacobian,
    follow,
    free_joints,
    locate,
    pose_error,
    solve_damped,
)
from solver.tolerances import JOINT_RATE_RAD_M, NUMERICAL_DAMPING, POSITION_ERROR_M


@kernel
def descend(chain, family, retreats, weights, squared, directions, angle, q):
    """Moves q, in place, to less effort as long as its whole cut-in holds; returns its angle [rad].

    A direct search: a step in a direction, shape (k, n + 1) with the angle last, is led back to the
    target, and taken when it is cheaper and holds. A joint goes no further than to a limit or to
    its reference, at which the l1 norm has its kinks; in every second direction joints that stand
    there stay, so that the search goes along edges.
    """
    n = len(q)
    low, high, trial = np.empty(n), np.empty(n), np.empty(n)
    cell = PoseFamily(
        family.position, family.branch, family.y_axis, family.outward, family.sideways,
        low, high, family.reference,
    )  # fmt: skip
    least, step = effort_of(family, weights, squared, q), DESCENT_FIRST_STEP
    for k in range(len(directions)):
        moved = False
        for sign in (1.0, -1.0):
            for i in range(n):
                ahead = sign * step * directions[k, i]
                _bound(family, q[i], i, ahead, k % 2 == 1, low, high)
                trial[i] = min(max(q[i] + ahead, low[i]), high[i])
            other = lead_back(chain, cell, angle + sign * step * directions[k, n], trial)
            if math.isnan(other):
                continue
            effort = effort_of(family, weights, squared, trial)
            if effort < least - DESCENT_GAIN and holds(chain, family, retreats, trial):
                q[:] = trial
                angle, least, moved = other, effort, True
                break
        step *= DESCENT_GROWTH if moved else DESCENT_SHRINKAGE
        if step < DESCENT_LAST_STEP:
            break
    return angle


@kernel
def _bound(family, value, i, ahead, staying, low, high):
    """Writes where joint i may go: to a limit or to its reference, whichever comes first."""
    lower, upper, reference = family.lower[i], family.upper[i], family.reference[i]
    low[i], high[i] = lower, upper
    if value > reference or (value == reference and ahead > 0.0):
        low[i] = max(lower, reference)
    else:
        high[i] = min(upper, reference)
    if staying and (value in (reference, lower, upper)):
        low[i] = high[i] = value


@kernel
def lead_back(chain, family, angle, q):
    """Leads q, in place, onto the target, angle free; returns the angle, NaN if it fails."""
    n = len(q)
    axes, frames, error = np.empty((3, 3)), np.empty((n + 1, 4, 4)), np.empty(6)
    columns = np.empty((6, n + 1))
    tool_axes(family, angle, axes)
    for _ in range(DESCENT_RETURN_STEPS):
        angle += step_towards(chain, family, axes, 0.0, q, columns, frames)
        tool_axes(family, angle, axes)
        locate(chain, q, frames)
        if pose_error(frames[n], family.position, axes, error) < DESCENT_REACHED:
            return angle
    return math.nan


@kernel
def effort_of(family, weights, squared, q):
    """The effort of reaching a posture from the reference."""
    total = 0.0
    for i in range(len(q)):
        travel = abs(q[i] - family.reference[i])
        total += weights[i] * (travel * travel if squared else travel)
    return total


@kernel
def holds(chain, family, retreats, q):
    """Whether the cut-in behind a posture keeps its line, the limits and the highest rate."""
    n = len(q)
    rows, frames, columns = np.empty((len(retreats), n)), np.empty((n + 1, 4, 4)), np.empty((6, n))
    rows[-1] = q
    locate(chain, q, frames)
    free = free_joints(chain, frames, columns)
    place, axes = frames[n, :3, 3].copy(), frames[n, :3, :3].copy()
    if follow(chain, place, axes, retreats, rows) > POSITION_ERROR_M:
        return False
    along, solution = np.zeros(6), np.empty(6)
    for k in range(len(rows)):
        for i in range(n):
            if not family.lower[i] <= rows[k, i] <= family.upper[i]:
                return False
        locate(chain, rows[k], frames)
        fill_jacobian(chain, frames, columns)
        for row in range(6):
            for i in range(n):
                columns[row, i] *= free[i]
        along[:3] = frames[n, :3, 2]
        solve_damped(columns, NUMERICAL_DAMPING, along, solution)
        for i in range(n):
            rate = 0.0
            for row in range(6):
                rate += columns[row, i] * solution[row]
            if chain.turning[i] * abs(rate) > JOINT_RATE_RAD_M:
                return False
    return True
