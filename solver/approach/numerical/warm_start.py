"""The warm start of an arm without a closed form: numerical inverse kinematics, angle free."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from solver.approach.numerical.multi_start import PoseFamily, from_starts
from solver.approach.numerical.tolerances import NUMERICAL_STARTS
from solver.approach.task.frame import signed_angle
from solver.approach.task.task import ApproachTask
from solver.kinematics.forward import forward_kinematics, jacobian
from solver.kinematics.numerical import (
    chain_of,
    free_joints,
    locate,
    polish,
    postures_behind,
    rates_behind,
)
from solver.problem.effort import joint_costs
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


@dataclass(frozen=True)
class _Found:
    """Where the starts of one tool side ended: postures (k, n), angles (k,), errors (k,)."""

    side: int
    postures: Array
    angles: Array
    errors: Array


def numerical_warm_start(task: ApproachTask) -> NumericalStart | Reason:
    """The cheapest feasible approach that a fixed number of seeded starts lead to.

    The starts are the reference posture and others drawn evenly inside the limits with the seed of
    the options. Each is led to the target by damped least squares with the approach angle free,
    leaning towards the reference, and polished by Newton's method. The cut-in follows from its
    neighbour row by row. Not every solution is found: a reason says what the starts met, not that
    there is nothing else.
    """
    stages = _Stages()
    for found in _from_all_starts(task, task.lower, task.upper):
        reached = found.errors <= POSITION_ERROR_M
        inside = task.inside(found.postures).min(axis=-1)
        good = np.flatnonzero(reached & (inside >= -LIMIT_EXCESS_RAD / 2))
        efforts = _efforts(task, found.postures[good])
        for k in good[np.argsort(efforts, kind="stable")]:
            effort = float(_efforts(task, found.postures[k]))
            if stages.best is not None and effort >= stages.best.effort:
                break
            stages.thinning = True
            rows = postures_behind(
                task.robot, task.tool, found.postures[k], np.asarray(task.retreats_m)
            )
            if _cut_in_holds(task, rows, stages):
                angle = signed_angle(float(found.angles[k]))
                stages.best = NumericalStart(angle, found.side, found.postures[k], effort)
                break
    return stages.best if stages.best is not None else _reason(task, stages)


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

    best: NumericalStart | None = None
    thinning: bool = False
    standby: bool = False
    standby_margin: float = -np.inf


def _from_all_starts(task: ApproachTask, lower: Array, upper: Array) -> list[_Found]:
    chain, frame = chain_of(task.robot, task.tool), task.frame
    reference = np.asarray(task.reference)
    rng = np.random.default_rng(task.options.seed)
    drawn = rng.uniform(task.lower, task.upper, (NUMERICAL_STARTS - 1, len(reference)))
    starts = np.concatenate((reference[None], drawn))
    # Each begins at the angle that its own tool is closest to.
    directions = forward_kinematics(task.robot, task.tool, starts)[:, :3, 2]
    nearest = np.arctan2(directions @ frame.sideways, directions @ frame.outward)
    found = []
    for side in task.tool_sides:
        family = PoseFamily(
            position=np.asarray(task.target.position_m, dtype=np.float64),
            branch=frame.branch,
            y_axis=side * frame.branch,
            outward=frame.outward,
            sideways=frame.sideways,
            lower=lower,
            upper=upper,
            reference=reference,
        )
        postures, errors = np.empty((2 * len(starts), starts.shape[1])), np.empty(2 * len(starts))
        angles = np.tile(nearest, 2)
        from_starts(chain, family, starts.copy(), angles, postures, errors)
        found.append(_Found(side, postures, angles, errors))
    return found


def _efforts(task: ApproachTask, postures: Array) -> Array:
    costs = joint_costs(postures - np.asarray(task.reference), task.options.norm)
    return np.asarray(costs @ np.asarray(task.joint_weights))


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
    found = _from_all_starts(task, lower, upper)
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
