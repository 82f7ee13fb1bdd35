"""`ncos`: the task definition as a nonlinear programme in CasADi, warm-started by the closed form.

Source: S 3.3 for the idea; the programme is in `solver.methods.nlp.formulation`.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from solver.approach.optimum.on_arcs import ArcOptimum, best_on_arcs
from solver.approach.refusal.diagnosis import diagnose
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.approach.uncertainty.levels import first_at_level
from solver.kinematics.families.registry import family_of
from solver.methods.candidates import at_angle
from solver.methods.coupling import Coupling
from solver.methods.nlp.backends import solve_instance
from solver.methods.nlp.formulation import build_programme
from solver.methods.nlp.instance import ProgrammeResult, Start, make_instance, shape_of
from solver.methods.on_rail import solve_on_rail
from solver.methods.other_arm import solve_other_arm
from solver.methods.relaxed.approach import between_neighbours, solve_relaxed
from solver.problem.retreats import even_retreats
from solver.problem.solution import Reason

SOLVED = "solved"
AS_GOOD = "solved_warm_start_as_good"


def solve_ncos(task: ApproachTask) -> Candidate | Reason:
    """The programme's approach, or its warm start where the programme fails or is not better.

    The optimum is polished: a programme ends within its tolerance of limits and constraints, so its
    answer is put back on the closed form, which meets them exactly. The answer is therefore never
    dearer than the warm start, and `status` says which of the two it is.
    """
    family = family_of(task.robot, task.tool)
    if (rail := family.rail_of(task.robot)) is not None:
        return solve_on_rail(task, rail)
    if not family.has_closed_form:
        return solve_other_arm(task)
    if task.options.relaxed:
        return solve_relaxed(task)
    warm_start = best_on_arcs(task)
    return diagnose(task) if warm_start is None else improved(task, warm_start)


def improved_in_chain(
    task: ApproachTask, start: ArcOptimum, next_thinning: Sequence[float] | None
) -> Candidate:
    """The programme's approach between its neighbours, never dearer for the batch than the start.

    It counts the effort of its own thinning posture from the previous standby and that of the next
    thinning posture from its standby, so what it gains the batch gains.

    Args:
        task: seen from the previous standby.
        start: what the ladder graph chose, without relaxations.
        next_thinning: the next target's thinning posture, shape (joints,); None without one.
    """
    if not task.options.relaxed:
        return improved(task, start, next_thinning)
    kept = _at_angle(task, start, start.angle_rad)
    return between_neighbours(task, kept, Coupling(task, next_thinning))


def improved(
    task: ApproachTask, warm_start: ArcOptimum, next_thinning: Sequence[float] | None = None
) -> Candidate:
    """The unrelaxed programme's approach from a warm start, or that start if it is not better.

    Args:
        task: the target's task.
        warm_start: where the programme starts, and on which arc it stays.
        next_thinning: the next target's thinning posture; where given, the travel to it from this
            standby counts too. `Candidate.effort` stays that of this thinning posture.
    """
    coupling = Coupling(task, next_thinning)
    result = solve_on_arc(task, warm_start, next_thinning)
    kept = _at_angle(task, warm_start, warm_start.angle_rad)
    if not result.success:
        return _told(kept, result.iterations, f"warm_start_after_{result.status}")
    arc = warm_start.arc
    angle = min(max(float(result.x[2 * len(task.robot.joints)]), arc.lower_rad), arc.upper_rad)
    found = _at_angle(task, warm_start, angle)
    if coupling.cost(found) > coupling.cost(kept) or _bears_less(task, found, kept):
        return _told(kept, result.iterations, AS_GOOD)
    return _told(found, result.iterations, SOLVED)


def _bears_less(task: ApproachTask, found: Candidate, kept: Candidate) -> bool:
    """Whether one approach bears a smaller level of the task's margins than another."""
    places = [(one.approach_angle_rad, one.tool_side, one.branch or 0) for one in (found, kept)]
    return first_at_level(task, places) != 0


def solve_on_arc(
    task: ApproachTask, warm_start: ArcOptimum, next_thinning: Sequence[float] | None = None
) -> ProgrammeResult:
    """The unrelaxed programme from a warm start, its approach angle kept on that start's arc."""
    arc, ends = warm_start.arc, even_retreats(task.options, 2)
    rows = task.postures(warm_start.angle_rad, arc.tool_side, arc.branch, ends)
    start = Start(
        arc.tool_side,
        warm_start.angle_rad,
        arc.lower_rad,
        arc.upper_rad,
        rows[::-1],
        ends[::-1],
        strike_m=0.0,
        swing_rad=np.zeros(3),
    )
    shape = replace(shape_of(task, coupled=next_thinning is not None), strike=False, tilt=False)
    programme = build_programme(task.robot, shape)
    instance = make_instance(task, programme, start, next_thinning)
    return solve_instance(task.robot, instance, task.options)


def _at_angle(task: ApproachTask, warm_start: ArcOptimum, angle: float) -> Candidate:
    arc = warm_start.arc
    thinning = task.thinning_joints(angle, arc.tool_side, arc.branch)
    return at_angle(task, angle, arc.tool_side, arc.branch, thinning)


def _told(candidate: Candidate, iterations: int, status: str) -> Candidate:
    return replace(candidate, iterations=iterations, status=status)
