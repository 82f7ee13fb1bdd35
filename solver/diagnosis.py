"""Why a target has no approach: the first stage at which every angle and branch has failed."""

import numpy as np

from solver.approach.task import ApproachTask
from solver.kinematics.spherical_wrist import inverse_kinematics
from solver.robots.model import Array
from solver.solution import Reason


def diagnose(task: ApproachTask, angles: Array) -> Reason:
    """The reason at the best of the given approach angles, shape (n,) [rad].

    Stages in order: the reach, the joint limits at thinning, the standby posture, the cut-in
    between them. Margins are those of the angle and branch that comes closest; limits are counted
    less the margin asked for.
    """
    reach, inside = _stage(task, angles, 0.0)
    best_reach = float(reach.max())
    if best_reach < 0:
        return Reason(
            "out_of_reach",
            f"the wrist centre stays {-best_reach * 1000:.1f} mm outside the reach at every "
            "approach angle tried",
            margin_m=best_reach,
        )
    thinning = np.where(reach >= 0, inside.min(axis=-1), -np.inf)
    if thinning.max() < 0:
        return _by_joint(task, "joint_limit", "the thinning posture", thinning, inside)
    standby_reach, standby_inside = _stage(task, angles, task.options.standoff_m)
    candidate_reach = np.where(thinning >= 0, standby_reach, -np.inf)
    if candidate_reach.max() < 0:
        short = float(candidate_reach.max())
        return Reason(
            "standby_infeasible",
            f"the standby posture's wrist centre stays {-short * 1000:.1f} mm outside the reach "
            "where the thinning posture is feasible",
            margin_m=short,
        )
    standby = np.where(candidate_reach >= 0, standby_inside.min(axis=-1), -np.inf)
    if standby.max() < 0:
        return _by_joint(task, "standby_infeasible", "the standby posture", standby, standby_inside)
    return Reason(
        "cut_in_infeasible",
        "thinning and standby postures are inside the limits at some approach angles, but at none "
        "of those tried the straight cut-in between them on one branch",
    )


def _stage(task: ApproachTask, angles: Array, retreat: float) -> tuple[Array, Array]:
    """Reach margins (n, sides 8) and each joint's distance inside its limits (n, sides 8, 6)."""
    reach, inside = [], []
    for side in task.tool_sides:
        poses = np.tile(np.eye(4), (len(angles), 1, 1))
        for k, angle in enumerate(angles):
            poses[k, :3, :3] = task.frame.axes(angle, side)
            poses[k, :3, 3] = np.asarray(task.target.position_m) - retreat * poses[k, :3, 2]
        found = inverse_kinematics(task.robot, task.tool, poses)
        reach.append(np.repeat(found.reach_margin_m, 2, axis=1))
        inside.append(np.minimum(found.joints - task.lower, task.upper - found.joints))
    return np.concatenate(reach, axis=1), np.concatenate(inside, axis=1)


def _by_joint(task: ApproachTask, code: str, what: str, margins: Array, inside: Array) -> Reason:
    best = np.unravel_index(int(margins.argmax()), margins.shape)
    joint = task.robot.joints[int(inside[best].argmin())].name
    beyond = float(margins[best])
    return Reason(
        code,
        f"{joint} is {np.degrees(-beyond):.2f} degrees beyond its limit in {what} that comes "
        "closest to feasible",
        joint=joint,
        margin_rad=beyond,
    )
