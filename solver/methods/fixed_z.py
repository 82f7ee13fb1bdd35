"""`fixed_z`: T 3.4.1. The forks point along the world's x axis; the cheapest branch wins."""

import math
from dataclasses import replace

import numpy as np

from solver.approach.arcs.arcs import sample_angles_of
from solver.approach.refusal.diagnosis import diagnose
from solver.approach.task.candidate import Candidate
from solver.approach.task.frame import signed_angle
from solver.approach.task.task import ApproachTask
from solver.approach.uncertainty.levels import first_at_level
from solver.kinematics.spherical_wrist import BRANCHES
from solver.problem.solution import Reason
from solver.robots.model import Array
from solver.tolerances import AXIS_ERROR_RAD

_FORWARD = np.array([1.0, 0.0, 0.0])


def solve_fixed_z(task: ApproachTask) -> Candidate | Reason:
    """The cheapest branch with z along the world's x axis and y along the part of b normal to it.

    T assumes that branches lie in the plane normal to x. One that leans out of it further than
    `tilt_tolerance_rad` has no such approach: reason `method_not_applicable`. Ties go to tool side
    1, then to the lower branch number.
    """
    branch = task.frame.branch
    lean = math.atan2(abs(branch[0]), math.hypot(branch[1], branch[2]))
    allowed = task.options.tilt_tolerance_rad
    if lean > allowed + AXIS_ERROR_RAD / 2:
        return Reason(
            "method_not_applicable",
            f"the branch leans {math.degrees(lean):.2f} degrees out of the plane normal to the "
            f"world's x axis, {math.degrees(allowed):.2f} are tolerated",
        )
    flat = _in_the_plane(task)
    angle = _angle_forward(flat, _FORWARD)
    offers: list[tuple[float, int, int]] = []
    for side in flat.tool_sides:
        margins, efforts = sample_angles_of(flat, side, np.array([angle]))
        offers += [
            (float(efforts[branch_number, 0]), -side, branch_number)
            for branch_number in range(BRANCHES)
            if margins[branch_number, 0] >= 0
        ]
    offers.sort()
    chosen = first_at_level(flat, ((angle, -side, number) for _, side, number in offers))
    if chosen is None:
        return diagnose(flat, np.array([angle]))
    cost, negative_side, number = offers[chosen]
    thinning = flat.thinning_joints(angle, -negative_side, number)
    # The swing from b to its part in the plane also takes the turned-back x axis to the x axis.
    reported = _angle_forward(task, _swing_back(branch, flat.frame.branch, _FORWARD))
    return Candidate(
        signed_angle(reported), -negative_side, number, thinning, cost, 1, "along_world_x"
    )


def _in_the_plane(task: ApproachTask) -> ApproachTask:
    """The task of the same target on a branch without its component along x."""
    across = task.frame.branch * (1.0 - _FORWARD)
    target = replace(task.target, branch_direction=tuple(float(value) for value in across))
    return replace(task, target=target)


def _angle_forward(task: ApproachTask, direction: Array) -> float:
    return math.atan2(direction @ task.frame.sideways, direction @ task.frame.outward)


def _swing_back(start: Array, end: Array, vector: Array) -> Array:
    """The vector turned by the smallest rotation that takes `end` to `start` (both unit)."""
    axis = np.cross(end, start)
    cosine = float(end @ start)
    across = np.cross(axis, vector)
    return np.asarray(vector + across + np.cross(axis, across) / (1.0 + cosine))
