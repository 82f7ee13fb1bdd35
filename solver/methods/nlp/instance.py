"""One task's numbers for a programme: parameters, bounds and the start, and what came of them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from solver.approach.task.relaxation import Placement, shortened
from solver.approach.task.task import ApproachTask
from solver.methods.nlp.formulation import Programme, Shape
from solver.methods.nlp.tolerances import NLP_LIMIT_INSET
from solver.robots.model import Array


@dataclass(frozen=True)
class Start:
    """Where a programme starts; nothing in it needs to be feasible.

    Attributes:
        tool_side: 1 or -1.
        approach_angle_rad: the approach angle.
        lower_rad: lower bound of the approach angle.
        upper_rad: upper bound of the approach angle.
        postures: thinning, standby and further rows, shape (2 + rows, joints) [rad].
        retreats_m: how far each of them is behind thinning, shape (2 + rows,) [m].
        strike_m: how far the tool centre point is beyond the target.
        swing_rad: rotation vector of the swing, normal to the branch, shape (3,).
        limits: lower and upper limits of each posture, shape (2, 2 + rows, joints); None where they
            are the task's.
    """

    tool_side: int
    approach_angle_rad: float
    lower_rad: float
    upper_rad: float
    postures: Array
    retreats_m: Array
    strike_m: float
    swing_rad: Array
    limits: Array | None = None

    def limits_of(self, task: ApproachTask) -> Array:
        """Lower and upper limits of each posture, shape (2, 2 + rows, joints) [rad or m]."""
        if self.limits is not None:
            return self.limits
        return np.repeat(np.stack(task.limits)[:, None], len(self.postures), axis=1)


@dataclass(frozen=True)
class Instance:
    """Numbers of one programme, as `casadi.nlpsol` takes them.

    Attributes:
        programme: what they are for.
        x0: the start.
        parameters: values of p.
        lower: lower bounds of x.
        upper: upper bounds of x.
        slack_references: for each slack, the joint value that its travel counts from.
    """

    programme: Programme
    x0: Array
    parameters: Array
    lower: Array
    upper: Array
    slack_references: Array

    def inside(self, x: Array) -> Array:
        """The variables clipped to bounds and inequalities, every slack at the travel it bounds."""
        inside = np.clip(x, self.lower, self.upper)
        programme = self.programme
        if programme.shape.tilt:
            shares = inside[programme.kinematic - 2 : programme.kinematic]
            shares /= max(1.0, float(np.linalg.norm(shares)))
        if programme.slacks:
            travel = inside[programme.slack_of] - self.slack_references
            inside[programme.kinematic :] = np.abs(travel)
        return inside

    @property
    def constraint_bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of g: equalities 0, the others not negative."""
        equal, other = self.programme.equalities, self.programme.inequalities
        return np.zeros(equal + other), np.append(np.zeros(equal), np.full(other, np.inf))


@dataclass(frozen=True)
class ProgrammeResult:
    """What a backend ended with; nothing in it is verified.

    Attributes:
        success: the backend's own word for convergence.
        status: its account.
        iterations: how many it took.
        x: the variables.
    """

    success: bool
    status: str
    iterations: int
    x: Array


def shape_of(task: ApproachTask, *, coupled: bool = False, rows: int = 0) -> Shape:
    """The shape of a task's programme."""
    options = task.options
    return Shape(options.norm, options.strikes, options.tilts, rows, coupled)


def make_instance(
    task: ApproachTask,
    programme: Programme,
    start: Start,
    next_thinning: Sequence[float] | None = None,
) -> Instance:
    """The numbers of a task for a programme of its shape.

    Limits are drawn in by NLP_LIMIT_INSET where a posture is not put back on the closed form.
    """
    n, shape, options = programme.joints, programme.shape, task.options
    frame = task.frame
    reference = np.asarray(task.reference)
    following = np.zeros(n) if next_thinning is None else np.asarray(next_thinning, dtype=float)
    inset = NLP_LIMIT_INSET if shape.strike or shape.tilt else 0.0
    low, high = start.limits_of(task)
    x0: list[ArrayLike] = [start.postures.ravel(), [start.approach_angle_rad]]
    lower: list[ArrayLike] = [(low + inset).ravel(), [start.lower_rad]]
    upper: list[ArrayLike] = [(high - inset).ravel(), [start.upper_rad]]
    if shape.strike:
        x0.append([start.strike_m / options.strike_zone_m])
        lower.append([0.0])
        upper.append([1.0])
    if shape.tilt:
        x0.append(_shares_of_tolerance(task, start.swing_rad))
        lower.append([-1.0, -1.0])
        upper.append([1.0, 1.0])
    slacks = programme.slacks
    references = np.concatenate((reference, following))[:slacks]
    x0.append(np.zeros(slacks))
    lower.append(np.full(slacks, -np.inf))
    upper.append(np.full(slacks, np.inf))
    parameters = np.concatenate(
        (
            np.asarray(task.target.position_m, dtype=np.float64),
            start.tool_side * frame.branch,
            frame.outward,
            frame.sideways,
            reference,
            following,
            np.asarray(task.joint_weights, dtype=np.float64),
            start.retreats_m,
            (
                task.tool.length_m,
                options.strike_zone_m,
                math.tan(options.tilt_tolerance_rad / 2),
            ),
        )
    )
    instance = Instance(
        programme,
        np.hstack(x0),
        parameters,
        np.hstack(lower),
        np.hstack(upper),
        slack_references=references,
    )
    return replace(instance, x0=instance.inside(instance.x0))


def placed(task: ApproachTask, programme: Programme, x: Array) -> Placement:
    """Where the tool is, from a programme's variables; relaxations kept inside their range."""
    options, k = task.options, programme.angle
    angle, strike, swing = float(x[k]), 0.0, np.zeros(3)
    k += 1
    if programme.shape.strike:
        strike = options.strike_zone_m * min(max(float(x[k]), 0.0), 1.0)
        k += 1
    if programme.shape.tilt:
        gibbs = math.tan(options.tilt_tolerance_rad / 2) * x[k : k + 2]
        length = float(np.linalg.norm(gibbs))
        turn = 2 * math.atan(length) / length if length > 0 else 2.0
        swing = turn * (gibbs[0] * task.frame.outward + gibbs[1] * task.frame.sideways)
        swing = shortened(swing, options.tilt_tolerance_rad)
    return Placement(angle, strike, swing)


def _shares_of_tolerance(task: ApproachTask, swing: Array) -> Array:
    length = float(np.linalg.norm(swing))
    if length == 0:
        return np.zeros(2)
    share = math.tan(length / 2) / math.tan(task.options.tilt_tolerance_rad / 2)
    along = swing / length
    return share * np.array([along @ task.frame.outward, along @ task.frame.sideways])
