"""`as`: the closed form alone, at the middle of the widest feasible arc.

The analogue of S, remarks 1 and 2, which take the middle of the feasible interval of the redundant
coordinate: not the cheapest approach but the one that may err most in its angle.
"""

from solver.approach.arcs.arcs import task_arcs
from solver.approach.refusal.diagnosis import diagnose
from solver.approach.task.candidate import Candidate
from solver.approach.task.frame import signed_angle
from solver.approach.task.task import ApproachTask
from solver.approach.uncertainty.levels import arcs_at_level
from solver.problem.effort import posture_effort
from solver.problem.solution import Reason


def solve_as(task: ApproachTask) -> Candidate | Reason:
    """The middle of the widest arc; ties go to tool side 1, then to the lower branch number.

    Of arcs that bear the largest level of the task's margins that some arc bears.
    """
    arcs = arcs_at_level(task, task_arcs(task))
    if not arcs:
        return diagnose(task)
    widest = max(arcs, key=lambda arc: (arc.upper_rad - arc.lower_rad, arc.tool_side, -arc.branch))
    middle = (widest.lower_rad + widest.upper_rad) / 2
    thinning = task.thinning_joints(middle, widest.tool_side, widest.branch)
    cost = posture_effort(thinning, task.reference, task.joint_weights, task.options.norm)
    return Candidate(
        signed_angle(middle),
        widest.tool_side,
        widest.branch,
        thinning,
        cost,
        len(arcs),
        "middle_of_widest_arc",
    )
