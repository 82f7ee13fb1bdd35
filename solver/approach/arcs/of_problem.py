"""The feasible arcs of every target of a problem."""

from solver.approach.arcs.arcs import limit_names, named_arc
from solver.approach.arcs.many import arcs_of_many
from solver.approach.task.packed import jump_cosines
from solver.approach.task.packing import packed_problem
from solver.approach.task.task import approach_task
from solver.approach.uncertainty.robustness import robust_arcs
from solver.problem.problem import Problem
from solver.problem.retreats import looked_at_retreats
from solver.problem.solution import Arc
from solver.problem.targets import Target
from solver.robots.model import Array


def feasible_arcs(problem: Problem) -> dict[str, tuple[Arc, ...]]:
    """The feasible arcs of every target of a problem by its id, empty where it has none.

    They are those of the task without a strike zone and a tilt tolerance.

    Raises:
        UnsupportedKinematics: the robot has no closed form.
    """
    return arcs_of_packed(problem, packed_problem(problem))


def arcs_of_packed(problem: Problem, numbers: Array) -> dict[str, tuple[Arc, ...]]:
    """`feasible_arcs` for targets that are packed already."""
    targets, retreats = problem.targets, looked_at_retreats(problem.options)
    table = arcs_of_many(numbers, retreats, jump_cosines(retreats))
    found: dict[str, list[Arc]] = {target.id: [] for target in targets}
    names = limit_names(problem.robot)
    for k, side, *arc in table.tolist():
        found[targets[int(k)].id].append(named_arc(1 - 2 * int(side), arc, names))
    return {target.id: _robust(problem, target, found[target.id]) for target in targets}


def _robust(problem: Problem, target: Target, arcs: list[Arc]) -> tuple[Arc, ...]:
    if not target.position_std_m:
        return tuple(arcs)
    return robust_arcs(approach_task(problem, target, problem.start), arcs)
