"""`ncos` with relaxations: one target alone, and one between its neighbours in a batch."""

from dataclasses import replace

import numpy as np

from solver.approach.arcs.arcs import task_arcs
from solver.approach.cut_in.cut_in import retreat_rows
from solver.approach.refusal.diagnosis import diagnose
from solver.approach.task.candidate import Candidate
from solver.approach.task.relaxation import placement
from solver.approach.task.task import ApproachTask
from solver.approach.uncertainty.levels import level_borne, margin_levels
from solver.approach.uncertainty.robustness import path_displacement_margin
from solver.kinematics.forward import forward_kinematics
from solver.methods.candidates import at_angle, from_thinning
from solver.methods.coupling import Coupling
from solver.methods.relaxed.points import Point, angle_in, fixed_task, optima_at
from solver.methods.relaxed.programme import ProgrammeEnd, programme_from
from solver.methods.relaxed.search import relaxed_offers
from solver.methods.relaxed.tolerances import POINTS_KEPT
from solver.methods.relaxed.zones import looked_at
from solver.problem.retreats import even_retreats
from solver.problem.solution import Reason


def solve_relaxed(task: ApproachTask) -> Candidate | Reason:
    """The approach of least effort found in a task's strike zone and tilt tolerance.

    Never dearer than that of a smaller zone on the ladder, none at all among them.
    """
    offers = relaxed_offers(task)
    if not offers.points:
        reason = diagnose(task)
        return replace(
            reason, detail=f"{reason.detail}; none was found with the relaxations either"
        )
    first, *others = (_candidate(task, point) for point in offers.points)
    solved = offers.status == "solved"
    status = offers.status if solved else f"warm_start_after_{offers.status}"
    return replace(first, iterations=offers.iterations, status=status, others=tuple(others))


def between_neighbours(task: ApproachTask, kept: Candidate, coupling: Coupling) -> Candidate:
    """A stop's approach with the relaxations, never dearer for the batch than the one it had.

    The programme starts from that one, and from what is cheapest for the batch of the points looked
    at; where it ends the closed form's arcs are asked.

    Args:
        task: the stop's, seen from the standby before it.
        kept: its approach so far, its effort counted from there.
        coupling: with the stop behind it.
    """
    points = sorted(
        optima_at(task, *looked_at(task)),
        key=lambda point: (-point.level_m, point.effort + coupling.onwards(point.postures[1])),
    )
    offers = [kept, *(_candidate(task, point) for point in points[:POINTS_KEPT])]
    iterations, statuses = 0, list[str]()
    for start in (_point(task, kept), *points[:1]):
        end = programme_from(task, start, coupling.next_thinning)
        iterations += end.iterations
        statuses.append(end.status)
        offers += _on_its_arc(task, start, end)
    offers.sort(key=lambda offer: (-_level(task, offer), coupling.cost(offer)))
    status = "solved" if "solved" in statuses else f"warm_start_after_{statuses[0]}"
    return replace(offers[0], iterations=iterations, status=status, others=tuple(offers[1:]))


def _candidate(task: ApproachTask, point: Point) -> Candidate:
    joints = tuple(point.postures[0].tolist())
    angle = point.placement.approach_angle_rad
    return at_angle(task, angle, point.tool_side, point.branch, joints)


def _point(task: ApproachTask, candidate: Candidate) -> Point:
    ends, branch = even_retreats(task.options, 2), candidate.branch
    assert branch is not None, "only arms with a closed form come here"
    rows = retreat_rows(task.robot, task.tool, candidate.thinning_joints, branch, ends)
    pose = forward_kinematics(task.robot, task.tool, rows[-1])
    seen = placement(task.frame, np.asarray(task.target.position_m), candidate.tool_side, pose)
    level = _level(task, candidate)
    return Point(seen, candidate.tool_side, branch, candidate.effort, level, rows[::-1])


def _level(task: ApproachTask, candidate: Candidate) -> float:
    """The largest level of the task's margins that a candidate bears [m]; -1 for not even the last.

    What nobody wishes for is not looked at.
    """
    levels = margin_levels(task.options, task.target)
    if levels == (0.0,):
        return 0.0
    margin = path_displacement_margin(
        task.robot, task.tool, task.options, candidate.branch or 0, candidate.thinning_joints
    )
    level = level_borne(levels, margin)
    return -1.0 if level is None else level


def _on_its_arc(task: ApproachTask, start: Point, end: ProgrammeEnd) -> list[Candidate]:
    """The approach where the programme ended, brought onto the arc that it lies on or next to."""
    seen = end.placement
    fixed = fixed_task(task, seen.strike_m, seen.swing_rad)
    angle = angle_in(fixed, task, seen)
    side, branch = start.tool_side, start.branch
    found = []
    for arc in task_arcs(fixed):
        if (arc.tool_side, arc.branch) == (side, branch):
            middle = (arc.lower_rad + arc.upper_rad) / 2
            on_turn = middle + np.remainder(angle - middle + np.pi, 2 * np.pi) - np.pi
            nearest = min(max(on_turn, arc.lower_rad), arc.upper_rad)
            thinning = np.asarray(fixed.thinning_joints(nearest, side, branch))
            found.append(from_thinning(task, side, branch, thinning))
    return found
