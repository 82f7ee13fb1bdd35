"""From a candidate and its cut-in to a whole approach with timed motion, for the verifier."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from solver.approach.cut_in.cut_in import CutIn
from solver.approach.task.candidate import Candidate
from solver.approach.task.frame import approach_frame
from solver.approach.task.relaxation import Placement, placement
from solver.approach.uncertainty.levels import told_level
from solver.approach.uncertainty.robustness import path_displacement_margin
from solver.kinematics.forward import forward_kinematics
from solver.motion.timing import TimedRows, time_joint_line
from solver.motion.transfers.joint_line import joint_line
from solver.problem.effort import posture_effort
from solver.problem.problem import Problem
from solver.problem.solution import PLANNED, Approach, Segment, SolverReport, Trajectory
from solver.problem.targets import Target
from solver.robots.model import Array
from solver.solving.tolerances import CLAIM_HALVINGS
from solver.tolerances import TRAJECTORY_STEP_S
from solver.verification.verify import judge, verify

PROPOSED = "proposed"


def propose(
    problem: Problem,
    target: Target,
    candidate: Candidate,
    cut_in: CutIn,
    reference: Sequence[float],
    report: SolverReport,
) -> Approach:
    """The approach of a candidate, with a transfer from the reference posture [rad]."""
    start = np.asarray(reference, dtype=np.float64)
    standby, thinning = cut_in.path_joints[0], cut_in.path_joints[-1]
    transfer = trajectory = None
    if cut_in.motion is not None:
        transfer = joint_line(problem.robot, start, standby)
        trajectory = _trajectory(problem, start, cut_in.motion)
    used = _placement(problem, target, candidate.tool_side, thinning)
    options, room = problem.options, _displacement_margin(problem, candidate, cut_in)
    level, short = told_level(options, target, room)
    return Approach(
        target_id=target.id,
        status=PROPOSED,
        solver=report,
        approach_angle_rad=candidate.approach_angle_rad,
        tool_side=candidate.tool_side,
        branch=candidate.branch,
        strike_m=used.strike_m if options.strike_zone_m > 0 else None,
        tilt_rad=used.tilt_rad if options.tilt_tolerance_rad > 0 else None,
        thinning_joints=thinning,
        standby_joints=standby,
        path_joints=cut_in.path_joints,
        path_deviation_m=cut_in.deviation_m,
        effort=posture_effort(thinning, start, problem.joint_weights, options.norm),
        margin_rad=_limit_margin(problem, cut_in),
        displacement_margin_m=room,
        position_margin_m=level,
        margin_short=short,
        transfer=transfer,
        trajectory=trajectory,
    )


def judged(problem: Problem, approach: Approach, reference: Sequence[float]) -> Approach:
    """What the verifier says of an approach; a displacement margin that it refutes is halved.

    The search for the nearest limit is local, and far from the posture it may end at another one.
    """
    verdict = judge(problem, approach, reference)
    for halvings in range(CLAIM_HALVINGS + 1):
        claim = approach.displacement_margin_m
        if verdict.status == PLANNED or not claim:
            break
        failures = verify(problem, approach, reference).failures
        if [residual.name for residual in failures] != ["displacement_margin_claim_m"]:
            break
        less = claim / 2 if halvings < CLAIM_HALVINGS else 0.0
        target = problem.targets_by_id[approach.target_id]
        level, short = told_level(problem.options, target, less)
        approach = replace(
            approach, displacement_margin_m=less, position_margin_m=level, margin_short=short
        )
        verdict = judge(problem, approach, reference)
    return verdict


def _placement(problem: Problem, target: Target, tool_side: int, thinning: Array) -> Placement:
    pose = forward_kinematics(problem.robot, problem.mounted_tool, np.asarray(thinning))
    frame = approach_frame(target.position_m, target.branch_direction)
    return placement(frame, np.asarray(target.position_m), tool_side, pose)


def _limit_margin(problem: Problem, cut_in: CutIn) -> float:
    """Smallest distance to a limit of the rows that are sent and of those that are executed."""
    rows = np.concatenate((cut_in.path_joints, cut_in.rows))
    return float(problem.robot.limit_margin(rows).min())


def _displacement_margin(problem: Problem, candidate: Candidate, cut_in: CutIn) -> float | None:
    if candidate.branch is None:
        return None  # no closed form to follow a displaced target with
    return path_displacement_margin(
        problem.robot,
        problem.mounted_tool,
        problem.options,
        candidate.branch,
        cut_in.path_joints[-1],
    )


def _trajectory(problem: Problem, reference: Array, motion: TimedRows) -> Trajectory:
    standby, thinning = motion.joints[0], motion.joints[-1]
    dwell_s = problem.options.dwell_s
    still = np.array([thinning, thinning]) if problem.options.dwells else thinning[None]
    pieces = {
        "transfer": time_joint_line(problem.robot, reference, standby, TRAJECTORY_STEP_S),
        "cut_in": motion,
        "dwell": TimedRows(np.array([0.0, dwell_s])[: len(still)], still),
        "retreat": motion.reversed(),
    }
    now = 0.0
    times, rows, segments = [np.zeros(1)], [reference[None]], []
    for name, piece in pieces.items():
        times.append(now + piece.times_s[1:])
        rows.append(piece.joints[1:])
        end = float(times[-1][-1]) if len(piece.times_s) > 1 else now
        segments.append(Segment(name, now, end))
        now = end
    return Trajectory(np.concatenate(times), np.concatenate(rows), tuple(segments))
