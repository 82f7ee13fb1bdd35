"""Residuals of timed motion, part of the one verifier in `solver.verification.verify`."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from solver.motion.rates import rate_ratios
from solver.problem.problem import Problem
from solver.problem.solution import Trajectory, Transfer
from solver.robots.model import Array
from solver.tolerances import LIMIT_EXCESS_RAD, POSITION_ERROR_M, SAME_POSTURE_RAD
from solver.verification.straightness import line_distances
from solver.verification.tolerances import RATE_EXCESS_RELATIVE, SAME_TIME_S
from solver.verification.verdict import Residual

SEGMENTS = ("transfer", "cut_in", "dwell", "retreat")


@dataclass(frozen=True)
class Motion:
    """What moves: from the reference posture, shape (joints,), over the transfer, timed."""

    reference: Array
    transfer: Transfer
    trajectory: Trajectory


def shape_residuals(trajectory: Trajectory, transfer: Transfer, joints: int) -> Iterator[Residual]:
    """Arrays of the right shape, and segments that cover the times without a gap."""
    wanted: dict[str, tuple[Array, tuple[int, ...]]] = {
        "trajectory": (trajectory.joints, (len(trajectory.times_s), joints)),
        "transfer": (transfer.joints, (len(transfer.joints), joints)),
    }
    for name, (array, shape) in wanted.items():
        wrong = np.shape(array) != shape or not np.isfinite(np.asarray(array)).all()
        yield Residual(f"{name}_shape", float(wrong), 0.0)
    names = tuple(segment.name for segment in trajectory.segments)
    starts = [segment.start_s for segment in trajectory.segments]
    ends = [segment.end_s for segment in trajectory.segments]
    whole = names == SEGMENTS and starts[0] == 0.0 and starts[1:] == ends[:-1]
    rising = len(trajectory.times_s) > 1 and bool(np.all(np.diff(trajectory.times_s) > 0))
    covered = rising and trajectory.times_s[0] == 0.0 and ends[-1:] == [trajectory.times_s[-1]]
    yield Residual("trajectory_times", float(not (whole and covered)), 0.0)


def motion_residuals(
    problem: Problem,
    motion: Motion,
    path_joints: Array,
    line: tuple[Array, Array],
    claimed_m: float,
) -> Iterator[Residual]:
    """Where the motion begins and ends, how fast it is, inside the limits, and how straight.

    Args:
        problem: what was asked.
        motion: the timed motion and the postures that it joins.
        path_joints: the cut-in's rows, shape (rows, joints).
        line: the thinning position, shape (3,) [m], and the approach direction, shape (3,).
        claimed_m: the deviation from that line that the answer claims [m].
    """
    robot, trajectory, transfer = problem.robot, motion.trajectory, motion.transfer
    reference, standby, thinning = motion.reference, path_joints[0], path_joints[-1]
    waypoints = {
        "transfer": (reference, standby),
        "cut_in": (standby, thinning),
        "dwell": (thinning, thinning),
        "retreat": (thinning, standby),
    }
    for name, (start, end) in waypoints.items():
        times, rows = segment_rows(trajectory, name)
        if not len(rows):
            yield Residual(f"{name}_rows", 1.0, 0.0)
            return
        apart = max(np.abs(rows[0] - start).max(), np.abs(rows[-1] - end).max())
        yield Residual(f"{name}_ends_rad", float(apart), SAME_POSTURE_RAD)
        speed, acceleration = rate_ratios(times, rows, robot.velocity, robot.acceleration)
        yield Residual(f"{name}_velocity_share", speed, 1 + RATE_EXCESS_RELATIVE)
        yield Residual(f"{name}_acceleration_share", acceleration, 1 + RATE_EXCESS_RELATIVE)
    corners = max(
        np.abs(transfer.joints[0] - reference).max(), np.abs(transfer.joints[-1] - standby).max()
    )
    yield Residual("transfer_corners_rad", float(corners), SAME_POSTURE_RAD)
    rows = np.concatenate((trajectory.joints, path_joints))
    outside = float(np.maximum(robot.lower - rows, rows - robot.upper).max())
    yield Residual("trajectory_limit_excess_rad", outside, LIMIT_EXCESS_RAD)
    dwell_times, dwell_rows = segment_rows(trajectory, "dwell")
    waited = float(dwell_times[-1] - dwell_times[0])
    yield Residual("dwell_s", abs(waited - problem.options.dwell_s), SAME_TIME_S)
    still = float(np.abs(dwell_rows - thinning).max())
    yield Residual("dwell_moves_rad", still, SAME_POSTURE_RAD)
    for name in ("cut_in", "retreat"):
        _, rows = segment_rows(trajectory, name)
        place, direction = line
        (deviation,) = line_distances(problem, rows[None], place[None], direction[None]).tolist()
        yield Residual(f"{name}_deviation_m", deviation, problem.options.straightness_m)
        claimed = deviation - claimed_m
        yield Residual(f"{name}_deviation_claim_m", claimed, POSITION_ERROR_M)


def segment_rows(trajectory: Trajectory, first: str, *others: str) -> tuple[Array, Array]:
    """Times and rows of one segment, or of neighbouring ones, both ends included."""
    wanted = [segment for segment in trajectory.segments if segment.name in (first, *others)]
    times = trajectory.times_s
    inside = (times >= wanted[0].start_s) & (times <= wanted[-1].end_s)
    return times[inside], trajectory.joints[inside]
