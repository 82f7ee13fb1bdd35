"""`ssas`: closed form plus a one-dimensional optimum over every feasible arc of every branch.

The global optimum of the unrelaxed task as far as the arcs are found; see docs/task_definition.md.
Source: S 3.2, with the approach angle in the place of its redundant coordinate.
"""

import math
from dataclasses import dataclass

from solver.approach.arcs import Arc, task_arcs
from solver.approach.frame import signed_angle
from solver.approach.search import optimum_on_arc
from solver.approach.task import ApproachTask
from solver.diagnosis import diagnose
from solver.methods.candidate import Candidate
from solver.solution import Reason


@dataclass(frozen=True)
class ArcOptimum:
    """The least effort over all arcs: the arc, the angle inside it (not wrapped), its effort."""

    arc: Arc
    angle_rad: float
    effort: float
    refined: int


def solve_ssas(task: ApproachTask) -> Candidate | Reason:
    """The approach of least effort over all feasible arcs, or why there is none."""
    best = best_on_arcs(task)
    if best is None:
        return diagnose(task)
    return Candidate(
        signed_angle(best.angle_rad),
        best.arc.tool_side,
        best.arc.branch,
        task.thinning_joints(best.angle_rad, best.arc.tool_side, best.arc.branch),
        best.effort,
        best.refined,
        "optimum_of_arcs",
    )


def best_on_arcs(task: ApproachTask) -> ArcOptimum | None:
    """The least effort over every arc of every branch; None when there is no arc."""
    best: ArcOptimum | None = None
    refined = 0
    for arc in task_arcs(task):
        below = math.inf if best is None else best.effort
        angle, cost, count = optimum_on_arc(
            task.packed(arc.tool_side), arc.branch, arc.lower_rad, arc.upper_rad, below
        )
        refined += count
        if cost < below:
            best = ArcOptimum(arc, float(angle), float(cost), refined)
    return best
