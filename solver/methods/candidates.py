"""From a posture to the candidate that stands in it."""

from collections.abc import Sequence

import numpy as np

from solver.approach.task.candidate import Candidate
from solver.approach.task.frame import signed_angle
from solver.approach.task.relaxation import placement
from solver.approach.task.task import ApproachTask
from solver.kinematics.forward import forward_kinematics
from solver.problem.effort import posture_effort
from solver.robots.model import Array


def from_thinning(task: ApproachTask, tool_side: int, branch: int, thinning: Array) -> Candidate:
    """The candidate of a thinning posture on its branch, shape (joints,) [rad]; nothing spent."""
    pose = forward_kinematics(task.robot, task.tool, thinning)
    seen = placement(task.frame, np.asarray(task.target.position_m), tool_side, pose)
    joints = tuple(float(value) for value in thinning)
    return at_angle(task, seen.approach_angle_rad, tool_side, branch, joints)


def at_angle(
    task: ApproachTask, angle: float, tool_side: int, branch: int, thinning: Sequence[float]
) -> Candidate:
    """The candidate of a posture whose approach angle is known; nothing spent."""
    cost = posture_effort(thinning, task.reference, task.joint_weights, task.options.norm)
    return Candidate(signed_angle(angle), tool_side, branch, thinning, cost, 0, "")
