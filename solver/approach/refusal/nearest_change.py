"""The nearest feasible change to a target without an approach, made and verified."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from solver.approach.arcs.arcs import task_arcs
from solver.approach.cut_in.broken_between_rows import broken_between
from solver.approach.refusal.displacement_search import nearest_of_all
from solver.approach.refusal.offered import offer_holds
from solver.approach.refusal.tolerances import (
    NEAREST_INSIDE_ARC_RAD,
    NEAREST_SPARES_M,
    NEAREST_UPRIGHT_SINE,
)
from solver.approach.task.candidate import Candidate
from solver.approach.task.feasibility import trace
from solver.approach.task.frame import approach_frame, signed_angle
from solver.approach.task.task import ApproachTask
from solver.approach.uncertainty.robustness import bears_uncertainty, needed_margin
from solver.problem.retreats import looked_at_retreats
from solver.problem.solution import Arc, Nearest
from solver.robots.model import Array

ANGLE = "angle"
DISPLACEMENT = "displacement"


def nearest_angle(task: ApproachTask, tried: Array, arcs: Sequence[Arc]) -> Nearest:
    """The angle of the feasible arcs that is nearest to one of the angles tried, shape (n,) [rad].

    A hair inside its arc, so that rounding does not lose it.
    """
    offers: list[tuple[float, float, Arc]] = []
    for arc in arcs:
        hair = min(NEAREST_INSIDE_ARC_RAD, (arc.upper_rad - arc.lower_rad) / 2)
        # No angle tried lies in an arc, so the nearest point of an arc is one of its ends.
        for end in (arc.lower_rad + hair, arc.upper_rad - hair):
            away = np.abs(np.remainder(tried - end + np.pi, 2 * np.pi) - np.pi)
            offers.append((float(away.min()), signed_angle(end), arc))
    _, angle, arc = min(offers, key=lambda offer: offer[:2])
    verified = _feasible(task, angle, arc.tool_side, arc.branch)
    return Nearest(ANGLE, angle, (0.0, 0.0, 0.0), verified)


def nearest_displacement(task: ApproachTask) -> Nearest | None:
    """The smallest displacement found that makes the target feasible, the branch direction kept.

    Local minima from several branches and angles, the best estimates first. Verified by the arcs of
    the displaced target, in one of which the angle has to lie, and by its cut-in between the rows.
    One that does not verify gives way to one a little deeper inside; None when none does.
    """
    for spare in NEAREST_SPARES_M:
        found = _nearest_with(task, needed_margin(task.target) + spare)
        if found is not None and found.verified:
            return found
    return None


def _nearest_with(task: ApproachTask, spread: float) -> Nearest | None:
    """The smallest displacement found after which the target may move by `spread` [m]."""
    best, offer = np.inf, None
    for side in task.tool_sides:
        found, branch, x = nearest_of_all(task.for_kernels(side), spread, best)
        if found:
            best, offer = float(np.linalg.norm(x[:3])), (side, int(branch), x)
    if offer is None:
        return None
    side, branch, x = offer
    x_m, y_m, z_m = (float(value) for value in task.robot.mount[:3, :3] @ x[:3])
    moved = displaced(task, (x_m, y_m, z_m))
    angle = _same_direction(task, tuple(moved.target.position_m), float(x[3]))
    holds = _holds(task, side, branch, x) if needed_margin(task.target) == 0 else None
    if holds is None:
        holds = _on_an_arc(moved, angle, side, branch)
        holds = holds and _holds_between_rows(moved, angle, side, branch)
    return Nearest(DISPLACEMENT, signed_angle(angle), (x_m, y_m, z_m), holds)


def _same_direction(task: ApproachTask, position: tuple[float, ...], angle: float) -> float:
    """The angle of an approach direction where the target stands at another position [rad]."""
    branch = task.frame.branch
    place = np.asarray(position)
    across = place - (place @ branch) * branch
    if across @ across <= (NEAREST_UPRIGHT_SINE * float(np.abs(place).max())) ** 2:
        # All but along the branch "straight out" is chosen with care, and not from the position.
        across = approach_frame(position, task.target.branch_direction).outward
    turned = math.atan2(across @ task.frame.sideways, across @ task.frame.outward)
    return angle - turned


def _holds(task: ApproachTask, tool_side: int, branch: int, x: Array) -> bool | None:
    """Whether an exact target holds where it is displaced to; None where that needs a closer look.

    That is between the rows of the cut-in, or where rows were added to those that are even.
    """
    if len(task.retreats_m) > len(looked_at_retreats(task.options)):
        return None
    packed = task.packed(tool_side)
    inside, look_closer = offer_holds(task.for_kernels(tool_side), packed, branch, x)
    return None if inside and look_closer else bool(inside)


def _on_an_arc(task: ApproachTask, angle: float, tool_side: int, branch: int) -> bool:
    return any(
        (arc.tool_side, arc.branch) == (tool_side, branch)
        and (angle - arc.lower_rad) % (2 * np.pi) <= arc.upper_rad - arc.lower_rad
        for arc in task_arcs(task)
    )


def _holds_between_rows(task: ApproachTask, angle: float, tool_side: int, branch: int) -> bool:
    thinning = task.thinning_joints(angle, tool_side, branch)
    return broken_between(task, Candidate(angle, tool_side, branch, thinning, 0.0, 0, "")) is None


def displaced(task: ApproachTask, displacement: tuple[float, float, float]) -> ApproachTask:
    """The task with its target moved by a displacement [m]."""
    position = tuple(np.asarray(task.target.position_m) + displacement)
    return replace(task, target=replace(task.target, position_m=position))


def _feasible(task: ApproachTask, angle: float, tool_side: int, branch: int) -> bool:
    kernels = task.for_kernels(tool_side)
    margin = trace(kernels, angle, branch, kernels.retreats, np.empty((len(kernels.retreats), 6)))
    return bool(margin >= 0) and bears_uncertainty(task, angle, tool_side, branch)
