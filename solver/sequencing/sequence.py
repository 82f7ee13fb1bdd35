"""A batch as one: approaches, and if asked for the order of targets, for the least total effort."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from solver.approach.arcs import Arc, task_arcs
from solver.approach.batch import chosen_paths, feasible_arcs
from solver.approach.frame import signed_angle
from solver.approach.task import ApproachTask, approach_task
from solver.cut_in import broken_limit
from solver.effort import posture_effort
from solver.methods.candidate import Candidate
from solver.problem import Problem
from solver.robots.model import Array
from solver.sequencing.batch import Batch, Indices
from solver.sequencing.gather import gather
from solver.sequencing.ladder_graph import refined_ladder
from solver.sequencing.ordering import orders_worth_refining
from solver.sequencing.polish import polished
from solver.tolerances import EXCHANGE_ROUNDS, LADDER_KEPT, LADDER_ROUNDS, LADDER_STEP_RAD

ArcsOf = Callable[[ApproachTask], Sequence[Arc]]


@dataclass(frozen=True)
class Stop:
    """A target in a sequence.

    Attributes:
        task: with the rows its cut-in had to have, seen from the start posture.
        candidate: its approach.
        arc: the feasible arc that the approach lies on.
        angle_rad: the approach angle on that arc, not wrapped.
    """

    task: ApproachTask
    candidate: Candidate
    arc: Arc
    angle_rad: float


@dataclass(frozen=True)
class Chain:
    """Approaches of a batch in some order.

    Attributes:
        order: indices of targets, shape (n,).
        arcs: arc of each approach, row of the batch's table, shape (n,).
        angles: their approach angles, shape (n,) [rad].
        effort: of all together.
    """

    order: Indices
    arcs: Indices
    angles: Array
    effort: float


def sequence(problem: Problem, arcs_of: ArcsOf = task_arcs) -> tuple[Stop, ...]:
    """The stops of a batch in execution order; targets without a feasible arc are left out.

    Limits hold between the rows of every cut-in: a posture that breaks one becomes a row of its
    target, whose arcs are found anew, and the approaches of the batch, in the same order, too.

    Args:
        problem: with order "given" or "optimal".
        arcs_of: the feasible arcs of a task; one without length is a single approach.
    """
    tasks = [approach_task(problem, target, problem.start) for target in problem.targets]
    if arcs_of is task_arcs:
        found = feasible_arcs(problem)
        arcs = [found[target.id] for target in problem.targets]
    else:
        arcs = [tuple(arcs_of(task)) for task in tasks]
    order = [k for k in range(len(tasks)) if arcs[k]]
    if problem.options.order == "optimal":
        order = _chosen_order(problem, tasks, arcs, order)
    stops: tuple[Stop, ...] = ()
    for _ in range(EXCHANGE_ROUNDS):
        order = [k for k in order if arcs[k]]
        if not order:
            return ()
        stops, suspicious = _stops(problem, [tasks[k] for k in order], [arcs[k] for k in order])
        again = False
        for k, stop, suspect in zip(order, stops, suspicious, strict=True):
            # Rows that were added lie unevenly, which the quick look cannot judge.
            looked_at = suspect or len(stop.task.retreats_m) > problem.options.path_points
            retreat = broken_limit(stop.task, stop.candidate) if looked_at else None
            if retreat is not None and retreat not in tasks[k].retreats_m:
                tasks[k] = tasks[k].with_retreat(retreat)
                arcs[k] = tuple(arcs_of(tasks[k]))
                again = True
        if not again:
            break
    return stops


def least_chain(batch: Batch, order: Indices) -> Chain:
    """The approaches of least total effort for targets in an order: `order: given`."""
    arcs, angles, _ = refined_ladder(batch, order, LADDER_STEP_RAD, LADDER_KEPT, LADDER_ROUNDS)
    angles, effort = polished(batch, arcs, angles)
    return Chain(order, arcs, angles, float(effort))


def least_order(batch: Batch, given: Indices, seed: int) -> Chain:
    """Order and approaches of least total effort: `order: optimal`; never dearer than the given.

    Args:
        batch: the targets.
        given: the order they were sent in.
        seed: of the search.
    """
    chains = [least_chain(batch, given)]
    chains += [least_chain(batch, order) for order in orders_worth_refining(batch, seed)]
    return min(chains, key=lambda chain: chain.effort)


def _chosen_order(
    problem: Problem,
    tasks: Sequence[ApproachTask],
    arcs: Sequence[Sequence[Arc]],
    feasible: Sequence[int],
) -> list[int]:
    """Indices of the feasible targets in the order chosen.

    The search sees targets sorted by id, so what it finds does not depend on how they were sent.
    """
    if not feasible:
        return []
    sorted_ = sorted(feasible, key=lambda k: tasks[k].target.id)
    batch = gather([tasks[k] for k in sorted_], [arcs[k] for k in sorted_])
    given = np.argsort(np.array(sorted_))
    chain = least_order(batch, given, problem.options.seed)
    return [sorted_[k] for k in chain.order]


def _stops(
    problem: Problem, tasks: Sequence[ApproachTask], arcs: Sequence[Sequence[Arc]]
) -> tuple[tuple[Stop, ...], Sequence[bool]]:
    """The stops of targets in order, and whether each may break a limit between its rows."""
    chain = least_chain(gather(tasks, arcs), np.arange(len(tasks)))
    every = [arc for own in arcs for arc in own]
    chosen = [every[index] for index in chain.arcs]
    paths = chosen_paths(problem, [task.target for task in tasks], chosen, chain.angles)
    before: Array = np.asarray(problem.start)
    stops = []
    for task, arc, angle, path in zip(tasks, chosen, chain.angles, paths.joints, strict=True):
        standby, thinning = path[0], path[-1]
        effort = posture_effort(thinning, before, problem.joint_weights, problem.options.norm)
        candidate = Candidate(
            approach_angle_rad=signed_angle(float(angle)),
            tool_side=arc.tool_side,
            branch=arc.branch,
            thinning_joints=tuple(float(value) for value in thinning),
            effort=effort,
            iterations=0,
            status="optimum_of_ladder",
        )
        stops.append(Stop(task, candidate, arc, float(angle)))
        before = standby
    return tuple(stops), paths.suspicious.tolist()
