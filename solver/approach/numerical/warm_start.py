"""The warm start of an arm without a closed form: numerical inverse kinematics, angle free."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from solver.approach.numerical.refinement import refined
from solver.approach.numerical.sweep import apart, arrivals_at, from_all_starts
from solver.approach.numerical.tolerances import NUMERICAL_STARTS, SAME_OPTIMUM_RAD
from solver.approach.task.frame import signed_angle
from solver.approach.task.task import ApproachTask
from solver.kinematics.chain_rates import rates_behind
from solver.kinematics.forward import forward_kinematics, jacobian
from solver.kinematics.numerical import (
    chain_of,
    free_joints,
    locate,
    polish,
    postures_behind,
)
from solver.problem.effort import posture_effort
from solver.problem.solution import Reason
from solver.robots.model import Array, Robot, Tool
from solver.tolerances import JOINT_RATE_RAD_M, LIMIT_EXCESS_RAD, POSITION_ERROR_M, SAME_POSTURE_RAD

_SQUARE: Final = 6


@dataclass(frozen=True)
class NumericalStart:
    """A feasible approach to begin from.

    Attributes:
        approach_angle_rad: in (-pi, pi].
        tool_side: 1 or -1.
        thinning_joints: posture at the target, shape (n,) [rad or m].
        effort: of reaching it.
    """

    approach_angle_rad: float
    tool_side: int
    thinning_joints: Array
    effort: float


def numerical_warm_starts(task: ApproachTask, most: int) -> tuple[NumericalStart, ...] | Reason:
    """The cheapest feasible approaches that a fixed number of seeded starts lead to.

    The starts are the reference posture and others drawn evenly inside the limits with the seed of
    the options. Each is led to the target by damped least squares with the approach angle free,
    leaning towards the reference, and polished by Newton's method; from the cheapest whose cut-in
    holds a direct search goes down, limits, rates and kinks of the l1 norm in view. Not every
    solution is found: a reason says what the starts met, not that there is nothing else.

    Args:
        task: of any arm.
        most: how many are returned at most, each another posture, the cheapest first.
    """
    arrivals = arrivals_at(task)
    starts: list[NumericalStart] = []
    for one in refined(task, arrivals):
        if len(starts) == most:
            break
        if not apart(one.posture, (start.thinning_joints for start in starts), SAME_OPTIMUM_RAD):
            continue
        posture = polished_thinning(task, one.angle_rad, one.tool_side, one.posture)
        if posture is not None:
            starts.append(_start(task, one.angle_rad, one.tool_side, posture))
    if starts:
        return tuple(sorted(starts, key=lambda start: start.effort))
    stages = _Stages(thinning=bool(arrivals))
    for one in arrivals:
        rows = postures_behind(task.robot, task.tool, one.posture, np.asarray(task.retreats_m))
        if _cut_in_holds(task, rows, stages):
            return (_start(task, one.angle_rad, one.tool_side, one.posture),)
    return _reason(task, stages)


def _start(task: ApproachTask, angle_rad: float, tool_side: int, posture: Array) -> NumericalStart:
    effort = posture_effort(posture, task.reference, task.joint_weights, task.options.norm)
    return NumericalStart(signed_angle(angle_rad), tool_side, posture, effort)


def polished_thinning(
    task: ApproachTask, approach_angle_rad: float, tool_side: int, near: Array
) -> Array | None:
    """The thinning posture at an angle next to one that is nearly there; None if none is [rad].

    Its limits and its cut-in hold as well.
    """
    q = np.array(near, dtype=np.float64)
    axes = np.ascontiguousarray(task.frame.axes(approach_angle_rad, tool_side))
    chain = chain_of(task.robot, task.tool)
    position = np.asarray(task.target.position_m, dtype=np.float64)
    error = polish(chain, position, axes, np.ones(len(q)), q)
    rows = postures_behind(task.robot, task.tool, q, np.asarray(task.retreats_m))
    holds = error <= POSITION_ERROR_M and _cut_in_holds(task, rows, _Stages())
    return q if holds else None


def same_side(robot: Robot, tool: Tool, rows: Array) -> bool:
    """Whether no row is across a singularity from the last: det J keeps its sign.

    J has the columns of the six joints that move on a cut-in to the last row; arms with fewer have
    no such determinant, and whether their rows hang together is told by their steps alone.

    Args:
        robot: any arm.
        tool: its tool.
        rows: postures of a cut-in, shape (k, n) [rad or m].
    """
    if len(robot.joints) < _SQUARE:
        return True
    chain = chain_of(robot, tool)
    frames, columns = np.empty((rows.shape[1] + 1, 4, 4)), np.empty((_SQUARE, rows.shape[1]))
    locate(chain, np.ascontiguousarray(rows[-1]), frames)
    free = free_joints(chain, frames, columns) > 0
    signs = np.sign(np.linalg.det(jacobian(robot, tool, rows)[..., free]))
    return bool(np.all(signs == signs[-1]) and signs[-1] != 0)


@dataclass
class _Stages:
    """How far the starts came."""

    thinning: bool = False
    standby: bool = False
    standby_margin: float = -np.inf


def _cut_in_holds(task: ApproachTask, rows: Array, stages: _Stages) -> bool:
    """Whether rows are a feasible cut-in: on the line, inside the limits, one continuous motion."""
    retreats = np.asarray(task.retreats_m)
    poses = forward_kinematics(task.robot, task.tool, rows)
    line = poses[-1, :3, 3] - np.outer(retreats, poses[-1, :3, 2])
    missed = np.linalg.norm(poses[:, :3, 3] - line, axis=1) + np.linalg.norm(
        poses[:, :3, :3] - poses[-1, :3, :3], axis=(1, 2)
    )
    inside = task.inside(rows).min(axis=-1)
    if missed[0] <= POSITION_ERROR_M:
        stages.standby_margin = max(stages.standby_margin, float(inside[0]))
        stages.standby |= bool(inside[0] >= -LIMIT_EXCESS_RAD / 2)
    rates = rates_behind(task.robot, task.tool, rows) * task.robot.turning
    if (
        missed.max() > POSITION_ERROR_M
        or inside.min() < -LIMIT_EXCESS_RAD / 2
        or rates.max() > JOINT_RATE_RAD_M
        or not same_side(task.robot, task.tool, rows)
    ):
        return False
    # Next to a singularity where a row ends depends on the steps that lead to it: not executable.
    finer = np.interp(np.arange(2 * len(retreats) - 1) / 2, np.arange(len(retreats)), retreats)
    again = postures_behind(task.robot, task.tool, rows[-1], finer)
    return bool(np.abs(again[0] - rows[0]).max() <= SAME_POSTURE_RAD / 2)


def _reason(task: ApproachTask, stages: _Stages) -> Reason:
    starts = f"{NUMERICAL_STARTS} starts of the numerical inverse"
    if not stages.thinning:
        return _without_limits(task, starts)
    if not stages.standby:
        margin = stages.standby_margin
        return Reason(
            "standby_infeasible",
            f"{starts} came to thinning postures, none of which has a standby posture",
            margin_rad=margin if np.isfinite(margin) else None,
        )
    return Reason(
        "cut_in_infeasible",
        f"{starts} came to thinning and standby postures inside the limits, but to none with the "
        "straight cut-in between them",
    )


def _without_limits(task: ApproachTask, starts: str) -> Reason:
    """Tell limits from reach: once more, without limits."""
    turning = task.robot.turning > 0
    lower = np.where(turning, -np.inf, task.lower)
    upper = np.where(turning, np.inf, task.upper)
    found = from_all_starts(task, lower, upper)
    postures = np.concatenate([entry.postures for entry in found])
    errors = np.concatenate([entry.errors for entry in found])
    reached = errors <= POSITION_ERROR_M
    if not reached.any():
        poses = forward_kinematics(task.robot, task.tool, postures)
        away = np.linalg.norm(poses[:, :3, 3] - np.asarray(task.target.position_m), axis=1)
        return Reason(
            "out_of_reach",
            f"{starts} come no nearer than {float(away.min()) * 1000:.1f} mm with the tool across "
            "the branch",
            margin_m=-float(away.min()),
        )
    inside = task.inside(postures)[reached]
    best = int(inside.min(axis=1).argmax())
    joint = int(inside[best].argmin())
    beyond = float(inside[best, joint])
    return Reason(
        "joint_limit",
        f"{task.robot.joints[joint].name} is beyond its limit in the thinning posture that comes "
        f"closest to feasible among {starts}",
        joint=task.robot.joints[joint].name,
        margin_rad=beyond if task.robot.turning[joint] > 0 else None,
    )
