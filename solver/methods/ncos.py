"""`ncos`: the task definition as a nonlinear programme in CasADi, warm-started by the closed form.

Source: S 3.3 for the idea; the programme is in `solver.nlp.formulation`.
"""

from dataclasses import replace

from solver.approach.frame import signed_angle
from solver.approach.task import ApproachTask
from solver.effort import posture_effort
from solver.kinematics.families import has_closed_form, rail_of
from solver.methods.any_arm import over_rail
from solver.methods.candidate import Candidate
from solver.methods.other_arm import solve_other_arm
from solver.methods.semi_analytic import ArcOptimum, best_on_arcs, solve_ssas, why_none
from solver.nlp.backends import ProgrammeResult, solve_programme
from solver.solution import Reason


def solve_ncos(task: ApproachTask) -> Candidate | Reason:
    """The programme's approach, or its warm start where the programme fails or is not better.

    The optimum is polished: an interior-point solver ends within its tolerance of limits and
    constraints, so its approach angle is put back on the closed form, which meets them exactly, and
    into the warm start's feasible arc. The answer is therefore never dearer than the warm start,
    and `status` says which of the two it is.
    """
    if (rail := rail_of(task.robot, task.tool)) is not None:
        return over_rail(task, rail, solve_ssas)
    if not has_closed_form(task.robot, task.tool):
        return solve_other_arm(task)
    warm_start = best_on_arcs(task)
    if warm_start is None:
        return why_none(task)
    result = solve_programme(task, warm_start)
    kept = Candidate(
        signed_angle(warm_start.angle_rad),
        warm_start.arc.tool_side,
        warm_start.arc.branch,
        task.thinning_joints(warm_start.angle_rad, warm_start.arc.tool_side, warm_start.arc.branch),
        warm_start.effort,
        result.iterations,
        f"warm_start_after_{result.status}",
    )
    if not result.success:
        return kept
    angle, thinning = _polish(task, warm_start, result)
    cost = posture_effort(thinning, task.reference, task.joint_weights, task.options.norm)
    if cost > warm_start.effort:
        return replace(kept, status="solved_warm_start_as_good")
    return replace(
        kept,
        approach_angle_rad=signed_angle(angle),
        thinning_joints=thinning,
        effort=cost,
        status="solved",
    )


def _polish(
    task: ApproachTask, warm_start: ArcOptimum, result: ProgrammeResult
) -> tuple[float, tuple[float, ...]]:
    """The programme's angle inside the arc, and the exact thinning posture there."""
    arc = warm_start.arc
    angle = min(max(result.approach_angle_rad, arc.lower_rad), arc.upper_rad)
    return angle, task.thinning_joints(angle, arc.tool_side, arc.branch)
