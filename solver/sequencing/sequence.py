"""A batch as one: approaches, and if asked for the order of targets, for the least total effort."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from solver.approach.arcs.arcs import task_arcs
from solver.approach.arcs.of_problem import arcs_of_packed
from solver.approach.cut_in.broken_between_rows import broken_between
from solver.approach.optimum.batch import chosen_paths
from solver.approach.task.candidate import Candidate
from solver.approach.task.frame import signed_angle
from solver.approach.task.packing import packed_problem
from solver.approach.task.task import ApproachTask, approach_tasks
from solver.approach.uncertainty.levels import arcs_at_level
from solver.problem.effort import joint_costs
from solver.problem.problem import Problem
from solver.problem.retreats import looked_at_retreats
from solver.problem.solution import Arc
from solver.robots.model import Array
from solver.sequencing.batch import Batch, Indices
from solver.sequencing.gather import gather
from solver.sequencing.ladder_graph import refined_ladder
from solver.sequencing.ordering import orders_worth_refining
from solver.sequencing.polish import polished
from solver.sequencing.tolerances import LADDER_KEPT, LADDER_ROUNDS, LADDER_STEP_RAD
from solver.tolerances import EXCHANGE_ROUNDS

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
    Arcs are those parts that bear the largest level of the task's margins that some part bears.

    Args:
        problem: with order "given" or "optimal".
        arcs_of: the feasible arcs of a task; one without length is a single approach.
    """
    tasks = approach_tasks(problem, problem.targets, problem.start)
    numbers = packed_problem(problem)
    if arcs_of is task_arcs:
        found = arcs_of_packed(problem, numbers)
        arcs = [found[target.id] for target in problem.targets]
    else:
        arcs = [tuple(arcs_of(task)) for task in tasks]
    arcs = [arcs_at_level(task, own) for task, own in zip(tasks, arcs, strict=True)]
    order = [k for k in range(len(tasks)) if arcs[k]]
    if problem.options.order == "optimal":
        order = _chosen_order(problem, tasks, numbers, arcs, order)
    stops: tuple[Stop, ...] = ()
    for _ in range(EXCHANGE_ROUNDS):
        order = [k for k in order if arcs[k]]
        if not order:
            return ()
        own_tasks, own_numbers = [tasks[k] for k in order], numbers[:, order]
        own_arcs = [arcs[k] for k in order]
        batch = gather(problem, own_numbers, own_arcs)
        # Polishing is most of the work, and for nothing where a target is about to be solved again.
        rough = ladder_chain(batch, np.arange(len(order)))
        stops, missing = _stops(problem, own_tasks, own_numbers, own_arcs, rough)
        if not missing:
            chain = polished_chain(batch, rough)
            stops, missing = _stops(problem, own_tasks, own_numbers, own_arcs, chain)
        if not missing:
            break
        for position, retreat in missing.items():
            k = order[position]
            tasks[k] = tasks[k].with_retreat(retreat)
            arcs[k] = arcs_at_level(tasks[k], arcs_of(tasks[k]))
    return stops


def least_chain(batch: Batch, order: Indices) -> Chain:
    """The approaches of least total effort for targets in an order: `order: given`."""
    return polished_chain(batch, ladder_chain(batch, order))


def ladder_chain(batch: Batch, order: Indices) -> Chain:
    """The approaches of least total effort among the angles of a refined ladder graph."""
    found = refined_ladder(batch, order, LADDER_STEP_RAD, LADDER_KEPT, LADDER_ROUNDS)
    return Chain(order, *found)


def polished_chain(batch: Batch, chain: Chain) -> Chain:
    """The chain with its angles refined together and continuously."""
    angles, effort = polished(batch, chain.arcs, chain.angles)
    return Chain(chain.order, chain.arcs, angles, float(effort))


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
    numbers: Array,
    arcs: Sequence[Sequence[Arc]],
    feasible: Sequence[int],
) -> list[int]:
    """Indices of the feasible targets in the order chosen.

    The search sees targets sorted by id, so what it finds does not depend on how they were sent.
    """
    if not feasible:
        return []
    sorted_ = sorted(feasible, key=lambda k: tasks[k].target.id)
    batch = gather(problem, numbers[:, sorted_], [arcs[k] for k in sorted_])
    given = np.argsort(np.array(sorted_))
    chain = least_order(batch, given, problem.options.seed)
    return [sorted_[k] for k in chain.order]


def _stops(
    problem: Problem,
    tasks: Sequence[ApproachTask],
    numbers: Array,
    arcs: Sequence[Sequence[Arc]],
    chain: Chain,
) -> tuple[tuple[Stop, ...], dict[int, float]]:
    """The stops of a chain, and the retreats that rows are missing at, by place in it [m]."""
    every = [arc for own in arcs for arc in own]
    chosen = [every[index] for index in chain.arcs]
    paths = chosen_paths(problem, numbers, chosen, chain.angles)
    standby, thinning = paths.joints[:, 0], paths.joints[:, -1]
    before = np.concatenate(([problem.start], standby[:-1]))
    costs = joint_costs(thinning - before, problem.options.norm)
    efforts = np.sum(costs * np.asarray(problem.joint_weights), axis=1).tolist()
    stops = []
    for k, (task, arc) in enumerate(zip(tasks, chosen, strict=True)):
        candidate = Candidate(
            approach_angle_rad=signed_angle(float(chain.angles[k])),
            tool_side=arc.tool_side,
            branch=arc.branch,
            thinning_joints=tuple(thinning[k].tolist()),
            effort=efforts[k],
            iterations=0,
            status="optimum_of_ladder",
        )
        stops.append(Stop(task, candidate, arc, float(chain.angles[k])))
    missing, regular = {}, len(looked_at_retreats(problem.options))
    for k, (stop, suspect) in enumerate(zip(stops, paths.suspicious.tolist(), strict=True)):
        # Rows that were added lie unevenly, which the quick look cannot judge.
        looked_at = suspect or len(stop.task.retreats_m) > regular
        retreat = broken_between(stop.task, stop.candidate) if looked_at else None
        if retreat is not None and retreat not in stop.task.retreats_m:
            missing[k] = retreat
    return tuple(stops), missing
