"""Kernels: the approach that comes closest to feasible, and what it fails at.

A failure is a stage and a margin. The later stage is the closer one, then the larger margin.
"""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from enum import IntEnum

import numpy as np

from solver.approach.task.feasibility import (
    fastest_joint,
    limit_margin,
    nearest_turns,
    posture,
    tool_axes,
    trace,
)
from solver.approach.tolerances import ANGLE_STEP_RAD
from solver.compiled import NONE_YET, kernel
from solver.kinematics.spherical_wrist import arm_turns, wrap
from solver.tolerances import JOINT_RATE_RAD_M


class Stage(IntEnum):
    """What an approach fails at, in the order in which it is looked at, or nothing.

    Margins are lengths [m] for the reach and angles [rad] for limits; for a jump the rate allowed
    less the joint's [rad/m].
    """

    REACH_AT_THINNING = 0
    LIMIT_AT_THINNING = 1
    REACH_AT_STANDBY = 2
    LIMIT_AT_STANDBY = 3
    REACH_IN_CUT_IN = 4
    LIMIT_IN_CUT_IN = 5
    JUMP_IN_CUT_IN = 6
    FEASIBLE = 7


_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


@kernel
def failure(task, angle, branch, rows):
    """Stage, margin, joint and row of the failure of one approach; `rows` is scratch."""
    axes, last = np.empty((3, 3)), len(task.retreats) - 1
    tool_axes(task, angle, axes)
    standby = rows[0]
    reach = posture(task, axes, 0.0, branch, rows[last])
    if reach < 0:
        return Stage.REACH_AT_THINNING, reach, 0, last
    nearest_turns(task, rows[last])
    inside, joint = limit_margin(task, rows[last])
    if inside < 0:
        return Stage.LIMIT_AT_THINNING, inside, joint, last
    reach = posture(task, axes, task.retreats[0], branch, standby)
    if reach < 0:
        return Stage.REACH_AT_STANDBY, reach, 0, 0
    for i in range(6):
        standby[i] = rows[last, i] + wrap(standby[i] - rows[last, i])
    inside, joint = limit_margin(task, standby)
    if inside < 0:
        return Stage.LIMIT_AT_STANDBY, inside, joint, 0
    trace(task, angle, branch, task.retreats, rows)
    q = np.empty(6)
    worst, limiting, row = 0.0, 0, -1
    for n in range(1, last):
        reach = posture(task, axes, task.retreats[n], branch, q)
        if reach < worst:
            worst, row = reach, n
    if row >= 0:
        return Stage.REACH_IN_CUT_IN, worst, 0, row
    for n in range(1, last):
        inside, joint = limit_margin(task, rows[n])
        if inside < worst:
            worst, limiting, row = inside, joint, n
    if row >= 0:
        return Stage.LIMIT_IN_CUT_IN, worst, limiting, row
    rate, limiting, row = fastest_joint(task.geometry, task.retreats, rows)
    if rate > JOINT_RATE_RAD_M:
        worst = JOINT_RATE_RAD_M - rate
    else:
        row = -1
    if row >= 0:
        return Stage.JUMP_IN_CUT_IN, worst, limiting, row
    return Stage.FEASIBLE, 0.0, 0, 0


@kernel
def wrist_reach(task, axes, arm):
    """The reach margin at the target [m]: what `posture` returns, without the joints."""
    g = task.geometry
    cx = task.position[0] - g.tool_length * axes[0, 2]
    cy = task.position[1] - g.tool_length * axes[1, 2]
    cz = task.position[2] - g.tool_length * axes[2, 2]
    _, _, _, _, _, _, _, reach, beside = arm_turns(g, cx, cy, cz, arm // 2)
    return min(reach, beside)


@kernel
def closer(stage, margin, best_stage, best_margin):
    """Whether a failure is closer to feasible than another."""
    return stage > best_stage or (stage == best_stage and margin > best_margin)


@kernel
def closest_failure(task, angles, between):
    """The closest failure of all branches at the given angles, shape (n,) [rad].

    With `between` the angles are evenly spaced over a turn and stand for all: the best one is
    refined among its neighbours.

    Returns:
        Stage, margin, joint, row, branch and angle.
    """
    rows, axes = np.empty((len(task.retreats), 6)), np.empty((3, 3))
    best_stage, best_margin, best_joint, best_row = -1, -math.inf, 0, 0
    best_branch, best_angle = NONE_YET, 0.0
    for arm in range(4):
        for angle in angles:
            # Both wrists of an arm have its reach: most angles fail there, at little cost.
            tool_axes(task, angle, axes)
            reach = wrist_reach(task, axes, arm)
            if reach < 0 and not closer(Stage.REACH_AT_THINNING, reach, best_stage, best_margin):
                continue
            for branch in range(2 * arm, 2 * arm + 2):
                stage, margin, joint, row = failure(task, angle, branch, rows)
                if closer(stage, margin, best_stage, best_margin):
                    best_stage, best_margin, best_joint, best_row = stage, margin, joint, row
                    best_branch, best_angle = branch, angle
    if between and best_stage < Stage.FEASIBLE:
        step = 2 * math.pi / len(angles)
        low, high = best_angle - step, best_angle + step
        while high - low > ANGLE_STEP_RAD:
            left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
            at_left = failure(task, left, best_branch, rows)
            at_right = failure(task, right, best_branch, rows)
            if closer(at_left[0], at_left[1], at_right[0], at_right[1]):
                high, angle, found = right, left, at_left
            else:
                low, angle, found = left, right, at_right
            if closer(found[0], found[1], best_stage, best_margin) and found[0] < Stage.FEASIBLE:
                best_stage, best_margin, best_joint, best_row = found
                best_angle = angle
    return best_stage, best_margin, best_joint, best_row, best_branch, best_angle
