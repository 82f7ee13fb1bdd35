"""The programme from one start to an exact posture whose whole cut-in holds, by itself.

For a start that the closed form had no part in.
"""

from dataclasses import dataclass, replace

import numpy as np

from solver.approach.cut_in.cut_in import rate_room, retreat_rows
from solver.approach.task.relaxation import Placement, rotation
from solver.approach.task.task import ApproachTask
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.spherical_wrist import inverse_kinematics
from solver.methods.nlp.backends import solve_instance
from solver.methods.nlp.formulation import build_programme
from solver.methods.nlp.instance import Start, make_instance, placed, shape_of
from solver.methods.nlp.slower import slower_limits
from solver.methods.nlp.tolerances import WHOLE_CUT_IN_ROUNDS
from solver.robots.model import Array
from solver.tolerances import LIMIT_EXCESS_RAD, POSITION_ERROR_M, SAME_BRANCH_RAD


@dataclass(frozen=True)
class ProgrammeAnswer:
    """What one start came to.

    Attributes:
        status: "solved", or what went wrong.
        iterations: of the backend, over all rounds.
        tool_side: 1 or -1.
        branch: of the thinning posture.
        thinning: the exact posture, shape (joints,) [rad]; None without an answer.
    """

    status: str
    iterations: int
    tool_side: int
    branch: int = 0
    thinning: Array | None = None


def solve_whole_cut_in(task: ApproachTask, start: Start) -> ProgrammeAnswer:
    """Solves a task, relaxed or not, from one start.

    The programme keeps limits at thinning and standby. A row of the cut-in that does not hold
    becomes a further posture of the programme, which goes on from where it was; one whose joints
    turn too fast gets closer limits.
    """
    spent = 0
    for _ in range(WHOLE_CUT_IN_ROUNDS):
        shape = shape_of(task, rows=len(start.postures) - 2)
        programme = build_programme(task.robot, shape)
        instance = make_instance(task, programme, start)
        result = solve_instance(task.robot, instance, task.options)
        spent += result.iterations
        if not result.success:
            return ProgrammeAnswer(result.status, spent, start.tool_side)
        seen = placed(task, programme, result.x)
        exact = _exact_posture(task, start.tool_side, seen, result.x[: programme.joints])
        if exact is None:
            return ProgrammeAnswer("not_on_the_closed_form", spent, start.tool_side)
        branch, thinning = exact
        retreats = np.asarray(task.retreats_m)
        rows = retreat_rows(task.robot, task.tool, tuple(thinning), branch, retreats)
        broken = _broken_row(task, rows, retreats)
        fast = None
        if broken is None:
            room = rate_room(task.robot, task.tool, branch, rows)
            if room.min() >= 0.0:
                return ProgrammeAnswer("solved", spent, start.tool_side, branch, thinning)
            broken = fast = int(room.argmin())
        elif retreats[broken] in start.retreats_m:
            return ProgrammeAnswer("cut_in_infeasible", spent, start.tool_side)
        postures = result.x[: programme.angle].reshape(programme.postures, programme.joints)
        start = replace(
            start,
            approach_angle_rad=seen.approach_angle_rad,
            postures=postures,
            strike_m=seen.strike_m,
            swing_rad=seen.swing_rad,
        )
        if retreats[broken] not in start.retreats_m:
            start = with_row(task, start, rows[broken], float(retreats[broken]))
        if fast is not None:
            k = int(np.flatnonzero(start.retreats_m == retreats[fast])[0])
            limits = start.limits_of(task).copy()
            drawn = slower_limits(task, rows[fast], limits[:, k])
            if drawn is None:
                return ProgrammeAnswer("wrist_jump", spent, start.tool_side)
            limits[:, k] = drawn
            start = replace(start, limits=limits)
    return ProgrammeAnswer("cut_in_infeasible", spent, start.tool_side)


def with_row(task: ApproachTask, start: Start, row: Array, retreat: float) -> Start:
    """The start with a further posture, shape (joints,), at a retreat [m]."""
    limits = np.concatenate((start.limits_of(task), np.stack(task.limits)[:, None]), axis=1)
    return replace(
        start,
        postures=np.vstack((start.postures, row)),
        retreats_m=np.append(start.retreats_m, retreat),
        limits=limits,
    )


def pose_of(task: ApproachTask, tool_side: int, seen: Placement) -> Array:
    """The tool frame of a placement, shape (4, 4) [m]."""
    pose = np.eye(4)
    pose[:3, :3] = rotation(seen.swing_rad) @ task.frame.axes(seen.approach_angle_rad, tool_side)
    pose[:3, 3] = np.asarray(task.target.position_m) + seen.strike_m * pose[:3, 2]
    return pose


def _exact_posture(
    task: ApproachTask, tool_side: int, seen: Placement, near: Array
) -> tuple[int, Array] | None:
    """Branch and posture of the closed form next to a programme's, if there is one."""
    found = inverse_kinematics(task.robot, task.tool, pose_of(task, tool_side, seen)[None])
    # On the programme's turn, for joints that can turn further than once.
    turned = np.remainder(found.joints[0] - near + np.pi, 2 * np.pi) - np.pi
    apart = np.where(found.reachable[0], np.abs(turned).max(axis=1), np.inf)
    branch = int(apart.argmin())
    if apart[branch] > SAME_BRANCH_RAD:
        return None
    return branch, near + turned[branch]


def _broken_row(task: ApproachTask, rows: Array, retreats: Array) -> int | None:
    """The row that is furthest from holding: outside the limits, or not where it has to be."""
    beyond = np.maximum(task.lower - rows, rows - task.upper).max(axis=1)
    poses = forward_kinematics(task.robot, task.tool, rows)
    wanted = poses[-1, :3, 3] - np.outer(retreats, poses[-1, :3, 2])
    off = np.linalg.norm(poses[:, :3, 3] - wanted, axis=1)
    outside = np.where(off > POSITION_ERROR_M / 2, off, 0.0)
    worst = np.maximum(beyond, outside)
    k = int(worst.argmax())
    return k if worst[k] > LIMIT_EXCESS_RAD / 2 else None
