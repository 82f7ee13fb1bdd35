"""`ssas`: closed form plus a one-dimensional optimum over every feasible arc of every branch.

The global optimum of the unrelaxed task as far as the arcs are found; see docs/task_definition.md.
Source: S 3.2, with the approach angle in the place of its redundant coordinate.
"""

from dataclasses import dataclass

import numpy as np

from solver.approach.arcs.arcs import Arc, task_arcs
from solver.approach.optimum.search import optimum_on_arcs
from solver.approach.refusal.diagnosis import diagnose
from solver.approach.task.candidate import Candidate
from solver.approach.task.frame import signed_angle
from solver.approach.task.task import ApproachTask
from solver.problem.solution import Reason


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
    arcs = task_arcs(task)
    packed = [task.packed(side) for side in task.tool_sides]
    chosen, angle, effort, refined = optimum_on_arcs(
        np.stack([side.numbers for side in packed]),
        packed[0].retreats,
        packed[0].cos_steps,
        np.array([task.tool_sides.index(arc.tool_side) for arc in arcs], dtype=np.int64),
        np.array([arc.branch for arc in arcs], dtype=np.int64),
        np.array([arc.lower_rad for arc in arcs]),
        np.array([arc.upper_rad for arc in arcs]),
    )
    return None if chosen < 0 else ArcOptimum(arcs[chosen], angle, effort, refined)
