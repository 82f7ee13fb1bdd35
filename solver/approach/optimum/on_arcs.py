"""The least effort over every feasible arc of one task."""

from collections.abc import Sequence
from dataclasses import dataclass

from solver.approach.arcs.arcs import task_arcs
from solver.approach.optimum.search import optimum_on_arcs
from solver.approach.task.task import ApproachTask
from solver.approach.uncertainty.levels import arcs_at_level, margin_levels
from solver.approach.uncertainty.robustness import approach_margin
from solver.problem.solution import Arc


@dataclass(frozen=True)
class ArcOptimum:
    """The least effort over all arcs: the arc, the angle inside it (not wrapped), its effort."""

    arc: Arc
    angle_rad: float
    effort: float
    refined: int


def best_on_arcs(task: ApproachTask) -> ArcOptimum | None:
    """The least effort over every arc of every branch; None when there is no arc.

    Of approaches that bear the largest level of the task's margins that some approach bears.
    """
    arcs = task_arcs(task)
    best = least_on_arcs(task, arcs)
    if best is None:
        return None
    level, *lower = margin_levels(task.options, task.target)
    if lower:
        margin = approach_margin(task, best.angle_rad, best.arc.tool_side, best.arc.branch)
        if margin < level:
            best = least_on_arcs(task, arcs_at_level(task, arcs))
    return best


def least_on_arcs(task: ApproachTask, arcs: Sequence[Arc]) -> ArcOptimum | None:
    """The least effort on some arcs; None when there is none."""
    chosen, angle, effort, refined = optimum_on_arcs(
        *task.packed_arcs(arcs),
    )
    return None if chosen < 0 else ArcOptimum(arcs[chosen], angle, effort, refined)
