"""From a problem to a verified plan, one target after the other."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

from solver.approach.arcs import task_arcs
from solver.approach.certificate import certify_task, is_infeasible
from solver.approach.task import ApproachTask, approach_task
from solver.cut_in import broken_limit, build_cut_in
from solver.kinematics.families import has_closed_form
from solver.methods.any_arm import Solve
from solver.methods.candidate import Candidate
from solver.problem import Problem, Target
from solver.proposal import propose
from solver.registry import METHODS
from solver.sequencing.programmed import programmed
from solver.sequencing.sequence import Stop, sequence
from solver.solution import INFEASIBLE, PLANNED, Approach, Plan, Reason, SolverReport
from solver.tolerances import EXCHANGE_ROUNDS
from solver.verification import judge


def solve(problem: Problem) -> Plan:
    """The plan for a batch: an approach for every target, planned and verified or with a reason.

    With order "independent" every target starts from the start posture. With "given" and "optimal"
    each starts from the previous planned standby, and the batch is planned as one, for the least
    total effort, by the methods that choose among all approaches; the others go greedily, from
    target to target.
    """
    started = time.perf_counter()
    approaches = _as_asked(problem)
    if problem.options.order == "optimal":
        approaches = sorted(approaches, key=lambda approach: approach.status != PLANNED)
    return Plan(problem, tuple(approaches), time.perf_counter() - started)


def _as_asked(problem: Problem) -> Sequence[Approach]:
    targets = problem.targets
    optimal = problem.options.order == "optimal"
    if not (optimal or _as_one(problem)):
        return _chain(problem, targets, {})
    stops = sequence(problem)
    if _as_one(problem):
        if problem.options.method == "ncos":
            stops = programmed(problem, stops)
        by_id = {stop.task.target.id: stop for stop in stops}
        return _chain(problem, _ordered(targets, stops) if optimal else targets, by_id)
    # The order is good for approaches chosen together; going greedily it need not be.
    offers = [_chain(problem, targets, {}), _chain(problem, _ordered(targets, stops), {})]
    return min(offers, key=_refused_and_effort)


def _ordered(targets: Sequence[Target], stops: Sequence[Stop]) -> list[Target]:
    """The targets of the stops in their order, then the others."""
    chosen = {stop.task.target.id for stop in stops}
    return [
        *(stop.task.target for stop in stops),
        *(target for target in targets if target.id not in chosen),
    ]


def _refused_and_effort(approaches: Sequence[Approach]) -> tuple[int, float]:
    efforts = [approach.effort or 0.0 for approach in approaches]
    return sum(approach.status != PLANNED for approach in approaches), sum(efforts)


def _chain(
    problem: Problem, targets: Sequence[Target], stops: Mapping[str, Stop]
) -> list[Approach]:
    """Approaches to targets in order, each its stop's if it has one."""
    reference = problem.start
    approaches: list[Approach] = []
    for target in targets:
        approach = plan_target(problem, target, reference, stops.get(target.id))
        approaches.append(approach)
        chained = problem.options.order != "independent" and approach.status == PLANNED
        if chained and approach.standby_joints is not None:
            reference = tuple(float(value) for value in approach.standby_joints)
    return approaches


def _as_one(problem: Problem) -> bool:
    """Whether approaches are chosen for the batch and not for each target."""
    options = problem.options
    relaxed = options.strike_zone_m > 0 or options.tilt_tolerance_rad > 0
    return (
        options.order != "independent"
        and METHODS[options.method].chooses_among_arcs
        and has_closed_form(problem.robot, problem.mounted_tool)
        and not (options.method == "ncos" and relaxed)
    )


def plan_target(
    problem: Problem, target: Target, reference: Sequence[float], stop: Stop | None = None
) -> Approach:
    """The approach to one target from a reference posture [rad]; its stop's, if it has one."""
    started = time.perf_counter()
    task = approach_task(problem, target, reference)
    outcome: Candidate | Reason
    if stop is None:
        outcome, task = solve_between_rows_too(task, METHODS[problem.options.method].solve)
    else:
        # A batch is planned as seen from the start; its efforts and their bounds count from here.
        outcome, task = stop.candidate, replace(stop.task, reference=task.reference)
    elapsed = time.perf_counter() - started
    method = problem.options.method
    arcs = task_arcs(task) if "arcs" in (problem.options.include or ()) else None
    if isinstance(outcome, Reason):
        if problem.options.certify:
            outcome = replace(outcome, proven=is_infeasible(task))
        report = SolverReport(method, elapsed, 0, outcome.code)
        return Approach(target.id, INFEASIBLE, report, reason=outcome, arcs=arcs)
    report = SolverReport(method, elapsed, outcome.iterations, outcome.status)
    cut_in = build_cut_in(task, outcome)
    approach = propose(problem, target, outcome, cut_in, reference, report)
    if problem.options.certify:
        bound = certify_task(task, approach.effort).lower_bound
        approach = replace(approach, lower_bound=bound)
    return replace(judge(problem, approach, reference), arcs=arcs)


def solve_between_rows_too(
    task: ApproachTask, solve: Solve
) -> tuple[Candidate | Reason, ApproachTask]:
    """A method's answer, with limits that hold between the rows of the cut-in as well.

    Also returns the task as it was solved last.

    A posture between two rows that breaks a limit becomes a row, and the target is solved again
    (the exchange method of semi-infinite programming).
    """
    for _ in range(EXCHANGE_ROUNDS):
        outcome = solve(task)
        if isinstance(outcome, Reason):
            return outcome, task
        retreat = broken_limit(task, outcome)
        if retreat is None or retreat in task.retreats_m:
            return outcome, task
        task = task.with_retreat(retreat)
    return outcome, task
