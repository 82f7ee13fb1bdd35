"""One target of a batch: solved, its cut-in built, verified."""

import time
from collections.abc import Sequence
from dataclasses import replace

from solver.approach.arcs.arcs import task_arcs
from solver.approach.bounds.certificate import certify_task, is_infeasible
from solver.approach.cut_in.broken_between_rows import broken_between
from solver.approach.cut_in.cut_in import build_cut_in
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask, approach_task
from solver.methods.any_arm import Solve
from solver.methods.registry import METHODS
from solver.problem.problem import Problem
from solver.problem.solution import INFEASIBLE, PLANNED, Approach, Reason, SolverReport
from solver.problem.targets import Target
from solver.sequencing.improving import improved_stop
from solver.sequencing.sequence import Stop
from solver.solving.proposal import judged, propose
from solver.tolerances import EXCHANGE_ROUNDS


def plan_target(
    problem: Problem,
    target: Target,
    reference: Sequence[float],
    stop: Stop | None = None,
    following: Stop | None = None,
) -> Approach:
    """The approach to one target from a reference posture.

    Args:
        problem: what was asked.
        target: one of its targets.
        reference: where effort and transfer count from, shape (joints,) [rad or m].
        stop: what was chosen for the target in a batch planned as one.
        following: the next stop of that batch.
    """
    started = time.perf_counter()
    task = approach_task(problem, target, reference)
    method = METHODS[problem.options.method]
    outcome: Candidate | Reason
    if stop is None:
        outcome, task = solve_between_rows_too(task, method.solve)
    else:
        # A batch is planned as seen from the start; its efforts and their bounds count from here.
        task, outcome = replace(stop.task, reference=task.reference), stop.candidate
        if method.improve is not None:
            outcome = improved_stop(task, stop, following, method.improve)
    elapsed = time.perf_counter() - started
    arcs = task_arcs(task) if "arcs" in (problem.options.include or ()) else None
    if isinstance(outcome, Reason):
        if problem.options.certify:
            outcome = replace(outcome, proven=is_infeasible(task))
        report = SolverReport(method.name, elapsed, 0, outcome.code)
        return Approach(target.id, INFEASIBLE, report, reason=outcome, arcs=arcs)
    report = SolverReport(method.name, elapsed, outcome.iterations, outcome.status)
    offers = (
        _planned(problem, task, candidate, reference, report)
        for candidate in (outcome, *outcome.others)
    )
    first = next(offers)
    approach = first if first.status == PLANNED else next(filter(_is_planned, offers), first)
    return replace(approach, arcs=arcs)


def _planned(
    problem: Problem,
    task: ApproachTask,
    candidate: Candidate,
    reference: Sequence[float],
    report: SolverReport,
) -> Approach:
    cut_in = build_cut_in(task, candidate)
    approach = propose(problem, task.target, candidate, cut_in, reference, report)
    if problem.options.certify:
        bound = certify_task(task, approach.effort).lower_bound
        approach = replace(approach, lower_bound=bound)
    return judged(problem, approach, reference)


def _is_planned(approach: Approach) -> bool:
    return approach.status == PLANNED


def solve_between_rows_too(
    task: ApproachTask, solve: Solve, first: Candidate | None = None
) -> tuple[Candidate | Reason, ApproachTask]:
    """A method's answer, with limits that hold between the rows of the cut-in as well.

    Also returns the task as it was solved last.

    A posture between two rows that breaks a limit becomes a row, and the target is solved again
    (the exchange method of semi-infinite programming).

    Args:
        task: the task.
        solve: the method.
        first: what it answers for the task as it is, if that is known.
    """
    for _ in range(EXCHANGE_ROUNDS):
        outcome, first = first or solve(task), None
        if isinstance(outcome, Reason):
            return outcome, task
        retreat = broken_between(task, outcome)
        if retreat is None or retreat in task.retreats_m:
            return outcome, task
        task = task.with_retreat(retreat)
    return outcome, task
