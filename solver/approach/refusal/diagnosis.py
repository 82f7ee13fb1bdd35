"""Why a target has no approach: what the approach that comes closest to feasible fails at."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from solver.approach.arcs.arcs import sample_angles, task_arcs
from solver.approach.refusal.closest import Stage, closest_failure
from solver.approach.refusal.nearest_change import nearest_angle, nearest_displacement
from solver.approach.refusal.tolerances import DIAGNOSED_ANGLES, HALF_TURN_DEG
from solver.approach.task.constraints import Constraint
from solver.approach.task.feasibility import trace
from solver.approach.task.task import ApproachTask
from solver.approach.tolerances import UNCERTAINTY_DEVIATIONS
from solver.approach.uncertainty.displacement import displacement_margin
from solver.approach.uncertainty.robust_parts import most_borne
from solver.approach.uncertainty.robustness import needed_margin
from solver.problem.solution import Arc, Reason
from solver.robots.model import Array
from solver.tolerances import JOINT_RATE_RAD_M


def diagnose(task: ApproachTask, tried: Array | None = None) -> Reason:
    """The reason, with the limiting joint or reach, by how much, and the nearest feasible change.

    Stages in order: the reach, the joint limits at thinning, the standby posture, the cut-in
    between them, the target's uncertainty. Margins are those of the angle and branch that come
    furthest, and there closest; limits are counted less the margin asked for.

    Args:
        task: a task for which the method found nothing.
        tried: the approach angles that the method tried, shape (n,) [rad]; None: all there are.
    """
    reason = _closest(task, tried) or _too_uncertain(task, tried)
    arcs = () if tried is None else task_arcs(task)
    if tried is not None and arcs:
        return replace(reason, nearest=nearest_angle(task, tried, arcs))
    return replace(reason, nearest=nearest_displacement(task))


def _closest(task: ApproachTask, tried: Array | None) -> Reason | None:
    """What the closest approach fails at; None when one is feasible as if the target were exact."""
    if tried is None and needed_margin(task.target) > 0 and task_arcs(_exact(task)):
        return None
    angles = sample_angles(DIAGNOSED_ANGLES) if tried is None else tried
    failures = (
        closest_failure(task.for_kernels(side), angles, tried is None) for side in task.tool_sides
    )
    stage, margin, joint, row, *_ = max(failures, key=lambda failure: failure[:2])
    if stage == Stage.FEASIBLE:
        return None
    return _stage_reason(task, Stage(stage), float(margin), int(joint), int(row))


def _stage_reason(task: ApproachTask, stage: Stage, margin: float, joint: int, row: int) -> Reason:
    name = task.robot.joints[joint].name
    behind = f"{task.retreats_m[row] * 1000:.1f} mm before the target"
    outside = f"{-margin * 1000:.1f} mm outside the reach"
    beyond = f"{name} is {np.degrees(-margin):.2f} degrees beyond its limit"
    match stage:
        case Stage.REACH_AT_THINNING:
            detail = f"the wrist centre stays {outside} at every approach angle tried"
            return Reason("out_of_reach", detail, margin_m=margin)
        case Stage.LIMIT_AT_THINNING:
            detail = f"{beyond} in the thinning posture that comes closest to feasible"
            return Reason("joint_limit", detail, joint=name, margin_rad=margin)
        case Stage.REACH_AT_STANDBY:
            detail = (
                f"the standby posture's wrist centre stays {outside} where the thinning posture is "
                "feasible"
            )
            return Reason("standby_infeasible", detail, margin_m=margin)
        case Stage.LIMIT_AT_STANDBY:
            detail = f"{beyond} in the standby posture that comes closest to feasible"
            return Reason("standby_infeasible", detail, joint=name, margin_rad=margin)
        case Stage.REACH_IN_CUT_IN:
            detail = f"between feasible ends the wrist centre is {outside}, {behind}"
            return Reason("cut_in_infeasible", detail, margin_m=margin)
        case Stage.LIMIT_IN_CUT_IN:
            detail = f"between feasible ends {beyond}, {behind}"
            return Reason("cut_in_infeasible", detail, joint=name, margin_rad=margin)
        case _:
            each_mm = np.degrees(np.array([JOINT_RATE_RAD_M - margin, JOINT_RATE_RAD_M])) / 1000
            turn = f"{each_mm[0]:.1f} degrees" if each_mm[0] < HALF_TURN_DEG else "half a turn"
            detail = (
                f"{name} turns too fast, {behind}: by {turn} for each millimetre of the cut-in, "
                f"where {each_mm[1]:.1f} degrees are allowed"
            )
            return Reason("cut_in_infeasible", detail, joint=name)


def _exact(task: ApproachTask) -> ApproachTask:
    return replace(task, target=replace(task.target, position_std_m=None))


@dataclass(frozen=True)
class _Spot:
    """A place of the approach: tool side, branch and angle."""

    tool_side: int
    branch: int
    angle_rad: float


def _too_uncertain(task: ApproachTask, tried: Array | None) -> Reason:
    """The reason where approaches are feasible, but none bears the target's uncertainty."""
    needed = needed_margin(task.target)
    exact = task_arcs(_exact(task))
    spots = _best_spots(task, exact) if tried is None else _tried_spots(task, tried)
    best: tuple[float, int, int] = (-1.0, 0, 0)
    rows = np.empty((len(task.retreats_m), 6))
    for spot in spots:
        found = displacement_margin(
            task.for_kernels(spot.tool_side), spot.angle_rad, spot.branch, rows
        )
        best = max(best, found)
    margin, row, joint = best
    last = len(task.retreats_m) - 1
    code = {0: "standby_infeasible", last: "joint_limit"}.get(row, "cut_in_infeasible")
    name = None if joint == Constraint.REACH else task.robot.joints[joint].name
    if name is None and row == last:
        code = "out_of_reach"
    detail = (
        f"feasible if the target is where it was seen, but it may be {needed * 1000:.1f} mm away "
        f"({UNCERTAINTY_DEVIATIONS:g} standard deviations) and {margin * 1000:.1f} mm meets "
        f"{'the reach' if name is None else f'the limit of {name}'}; a standard deviation up to "
        f"{margin / UNCERTAINTY_DEVIATIONS * 1000:.2f} mm could be borne"
    )
    return Reason(code, detail, joint=name, margin_m=margin - needed)


def _best_spots(task: ApproachTask, arcs: Sequence[Arc]) -> list[_Spot]:
    spots = []
    for arc in arcs:
        packed = task.packed(arc.tool_side)
        angle = most_borne(packed, arc.branch, arc.lower_rad, arc.upper_rad)
        spots.append(_Spot(arc.tool_side, arc.branch, float(angle)))
    return spots


def _tried_spots(task: ApproachTask, tried: Array) -> list[_Spot]:
    rows = np.empty((len(task.retreats_m), 6))
    return [
        _Spot(side, branch, float(angle))
        for side in task.tool_sides
        for branch in range(8)
        for angle in tried
        if trace(task.for_kernels(side), angle, branch, np.asarray(task.retreats_m), rows) >= 0
    ]
