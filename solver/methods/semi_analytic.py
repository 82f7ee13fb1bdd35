"""`ssas`: closed form plus a one-dimensional optimum over every feasible arc of every branch.

The global optimum of the unrelaxed task as far as the arcs are found; see docs/task_definition.md.
Source: S 3.2, with the approach angle in the place of its redundant coordinate.
"""

from typing import Final

from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.refusal.diagnosis import diagnose
from solver.approach.task.candidate import Candidate
from solver.approach.task.frame import signed_angle
from solver.approach.task.task import ApproachTask
from solver.problem.solution import Reason

OPTIMUM: Final = "optimum_of_arcs"
"""The method's account of its answers."""


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
        OPTIMUM,
    )
