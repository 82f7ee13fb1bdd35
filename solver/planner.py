"""From a problem to a verified plan: one target after the other, each on its own feet."""

import time
from collections.abc import Sequence

import numpy as np

from solver.approach.task import ApproachTask, approach_task
from solver.cut_in import CutIn, broken_limit, build_cut_in
from solver.effort import posture_effort
from solver.methods.candidate import Candidate
from solver.problem import Problem, Target
from solver.registry import METHODS
from solver.robots.model import Array
from solver.solution import (
    INFEASIBLE,
    PLANNED,
    Approach,
    Plan,
    Reason,
    Segment,
    SolverReport,
    Trajectory,
    Transfer,
)
from solver.tolerances import EXCHANGE_ROUNDS, TRAJECTORY_STEP_S
from solver.trajectory.timing import TimedRows, time_joint_line
from solver.verification import cut_in_margin, judge

PROPOSED = "proposed"


def solve(problem: Problem) -> Plan:
    """The plan for a batch: an approach for every target, planned and verified or with a reason.

    With order "given" each target starts from the previous planned standby (greedily), with
    "independent" from the start posture.
    """
    started = time.perf_counter()
    reference = problem.start
    approaches: list[Approach] = []
    for target in problem.targets:
        approach = plan_target(problem, target, reference)
        approaches.append(approach)
        chained = problem.options.order == "given" and approach.status == PLANNED
        if chained and approach.standby_joints is not None:
            reference = tuple(float(value) for value in approach.standby_joints)
    return Plan(problem, tuple(approaches), time.perf_counter() - started)


def plan_target(problem: Problem, target: Target, reference: Sequence[float]) -> Approach:
    """The approach to one target from a reference posture [rad]."""
    started = time.perf_counter()
    task = approach_task(problem, target, reference)
    outcome = _solve_between_rows_too(task)
    elapsed = time.perf_counter() - started
    method = problem.options.method
    if isinstance(outcome, Reason):
        report = SolverReport(method, elapsed, 0, outcome.code)
        return Approach(target.id, INFEASIBLE, report, reason=outcome)
    report = SolverReport(method, elapsed, outcome.iterations, outcome.status)
    return judge(problem, _propose(problem, task, outcome, report), reference)


def _solve_between_rows_too(task: ApproachTask) -> Candidate | Reason:
    """The method's answer, with limits that hold between the rows of the cut-in as well.

    A posture between two rows that breaks a limit becomes a row, and the target is solved again
    (the exchange method of semi-infinite programming).
    """
    solve_task = METHODS[task.options.method].solve
    for _ in range(EXCHANGE_ROUNDS):
        outcome = solve_task(task)
        if isinstance(outcome, Reason):
            return outcome
        retreat = broken_limit(task, outcome)
        if retreat is None or retreat in task.retreats_m:
            return outcome
        task = task.with_retreat(retreat)
    return outcome


def _propose(
    problem: Problem, task: ApproachTask, candidate: Candidate, report: SolverReport
) -> Approach:
    cut_in = build_cut_in(task, candidate)
    standby, thinning = cut_in.path_joints[0], cut_in.path_joints[-1]
    reference = np.asarray(task.reference)
    transfer = Transfer(
        "joint_line", np.array([reference, standby]), float(np.linalg.norm(standby - reference))
    )
    trajectory = _trajectory(problem, reference, cut_in)
    return Approach(
        target_id=task.target.id,
        status=PROPOSED,
        solver=report,
        approach_angle_rad=candidate.approach_angle_rad,
        tool_side=candidate.tool_side,
        branch=candidate.branch,
        thinning_joints=thinning,
        standby_joints=standby,
        path_joints=cut_in.path_joints,
        path_deviation_m=cut_in.deviation_m,
        effort=posture_effort(thinning, reference, problem.joint_weights, problem.options.norm),
        margin_rad=cut_in_margin(problem, cut_in.path_joints, trajectory),
        transfer=transfer,
        trajectory=trajectory,
    )


def _trajectory(problem: Problem, reference: Array, cut_in: CutIn) -> Trajectory:
    standby, thinning = cut_in.motion.joints[0], cut_in.motion.joints[-1]
    dwell_s = problem.options.dwell_s
    still = np.array([thinning, thinning]) if dwell_s > 0 else thinning[None]
    pieces = {
        "transfer": time_joint_line(problem.robot, reference, standby, TRAJECTORY_STEP_S),
        "cut_in": cut_in.motion,
        "dwell": TimedRows(np.array([0.0, dwell_s])[: len(still)], still),
        "retreat": cut_in.motion.reversed(),
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
