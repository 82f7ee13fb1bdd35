"""Where many seeded starts arrive at a target, of an arm without a closed form."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from solver.approach.numerical.multi_start import PoseFamily, from_starts
from solver.approach.numerical.tolerances import NUMERICAL_STARTS
from solver.approach.task.task import ApproachTask
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.numerical import chain_of
from solver.problem.effort import joint_costs
from solver.robots.model import Array
from solver.tolerances import LIMIT_EXCESS_RAD, POSITION_ERROR_M


@dataclass(frozen=True)
class Found:
    """Where the starts of one tool side ended: postures (k, n), angles (k,), errors (k,)."""

    side: int
    postures: Array
    angles: Array
    errors: Array


@dataclass(frozen=True)
class Arrival:
    """A thinning posture inside the limits; of its cut-in nothing is known.

    Attributes:
        posture: shape (n,) [rad or m].
        angle_rad: its approach angle, not wrapped.
        tool_side: 1 or -1.
    """

    posture: Array
    angle_rad: float
    tool_side: int


def arrivals_at(task: ApproachTask) -> tuple[Arrival, ...]:
    """Thinning postures that the starts came to, of both tool sides, the least effort first."""
    arrivals: list[Arrival] = []
    for found in from_all_starts(task, task.lower, task.upper):
        inside = task.inside(found.postures).min(axis=-1) >= -LIMIT_EXCESS_RAD / 2
        good = np.flatnonzero((found.errors <= POSITION_ERROR_M) & inside)
        arrivals += [Arrival(found.postures[k], float(found.angles[k]), found.side) for k in good]
    if not arrivals:
        return ()
    travels = np.array([one.posture for one in arrivals]) - np.asarray(task.reference)
    efforts = joint_costs(travels, task.options.norm) @ np.asarray(task.joint_weights)
    return tuple(arrivals[k] for k in np.argsort(efforts, kind="stable"))


def apart(posture: Array, others: Iterable[Array], least: float) -> bool:
    """Whether some joint is further than `least` [rad or m] from each of other postures."""
    return all(np.abs(posture - other).max() > least for other in others)


def pose_family(task: ApproachTask, side: int, lower: Array, upper: Array) -> PoseFamily:
    """All approaches of a task with the tool on one side, inside limits of shape (n,)."""
    frame = task.frame
    return PoseFamily(
        position=np.asarray(task.target.position_m, dtype=np.float64),
        branch=frame.branch,
        y_axis=side * frame.branch,
        outward=frame.outward,
        sideways=frame.sideways,
        lower=lower,
        upper=upper,
        reference=np.asarray(task.reference),
    )


def from_all_starts(task: ApproachTask, lower: Array, upper: Array) -> list[Found]:
    """Where the starts end inside limits of shape (n,), a row for each tool side."""
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
        family = pose_family(task, side, lower, upper)
        postures, errors = np.empty((2 * len(starts), starts.shape[1])), np.empty(2 * len(starts))
        angles = np.tile(nearest, 2)
        from_starts(chain, family, starts.copy(), angles, postures, errors)
        found.append(Found(side, postures, angles, errors))
    return found
