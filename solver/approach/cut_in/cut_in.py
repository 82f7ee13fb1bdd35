"""The straight cut-in of a candidate: its rows, its motion as executed, how straight that is."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.approach.cut_in.line_behind import LineBehind
from solver.approach.cut_in.tolerances import (
    DEVIATION_SAMPLES,
)
from solver.approach.task.candidate import Candidate
from solver.approach.task.feasibility import retreat_from_many
from solver.approach.task.task import ApproachTask
from solver.kinematics.chain_rates import rates_behind
from solver.kinematics.families.registry import family_of
from solver.kinematics.forward import forward_kinematics, many_poses, tool_centres
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.kinematics.straight_rates import rows_rate_room
from solver.motion.timing import TimedRows, time_cut_in
from solver.problem.options import Options
from solver.problem.retreats import even_retreats, looked_at_retreats
from solver.robots.model import Array, Robot, Tool
from solver.robots.rigid import inverse
from solver.tolerances import (
    JOINT_RATE_RAD_M,
    LEAST_REFINED_ROWS,
    TRAJECTORY_HALVINGS,
    TRAJECTORY_STEP_S,
)


@dataclass(frozen=True)
class CutIn:
    """A cut-in from standby to thinning.

    Attributes:
        path_joints: evenly spaced rows, shape (path_points, 6) [rad].
        motion: what is executed; None where no timing was asked for.
        rows: the postures that motion goes through, or without timing rows refined until they are
            straight, shape (n, joints).
        deviation_m: how far they leave the straight line, in between too [m].
    """

    path_joints: Array
    motion: TimedRows | None
    rows: Array
    deviation_m: float


def build_cut_in(task: ApproachTask, candidate: Candidate) -> CutIn:
    """The candidate's cut-in, sampled finely enough in time to be straight within `straightness_m`.

    Straightness that the finest sampling does not reach is left for the verifier to refuse.
    """
    options = task.options
    behind = LineBehind(task.robot, task.tool, candidate.thinning_joints, candidate.branch)

    def path(distances: Array) -> Array:
        return behind.rows(options.standoff_m - distances)

    rows = path(np.linspace(0.0, options.standoff_m, options.path_points))
    pose = forward_kinematics(task.robot, task.tool, rows[-1])
    if not options.timed:
        line = (pose[:3, 3], pose[:3, 2])
        return CutIn(
            rows, None, *refined_rows(task.robot, task.tool, options, rows, candidate.branch, line)
        )
    # Not those that are sent: how long it takes does not depend on them.
    looked_at = path(options.standoff_m - looked_at_retreats(options))
    step_s = TRAJECTORY_STEP_S
    for _ in range(TRAJECTORY_HALVINGS + 1):
        motion = time_cut_in(task.robot, options.standoff_m, looked_at, path, step_s)
        deviation = line_deviation(task.robot, task.tool, motion.joints, pose[:3, 3], pose[:3, 2])
        if deviation <= options.straightness_m:
            break
        step_s /= 2
    return CutIn(rows, motion, motion.joints, deviation)


def retreat_rows(
    robot: Robot,
    tool: Tool,
    thinning: Sequence[float] | Array,
    branch: int | None,
    retreats: Array,
) -> Array:
    """Postures straight behind a thinning posture, with its orientation, on its branch.

    Args:
        robot: the arm.
        tool: its tool.
        thinning: the posture at the target, shape (joints,) [rad or m].
        branch: the inverse kinematics branch, on a rail that of the arm, while the rail stands
            still; None for an arm without a closed form, where each row follows from its neighbour.
        retreats: distances behind the target, descending to 0, shape (rows,) [m].

    Returns:
        Shape (rows, joints), without turns between rows; the last row is `thinning` itself.
    """
    return LineBehind(robot, tool, thinning, branch).rows(retreats)


def refined_rows(
    robot: Robot,
    tool: Tool,
    options: Options,
    path: Array,
    branch: int | None,
    line: tuple[Array, Array],
) -> tuple[Array, float]:
    """Rows of the cut-in, refined until they are straight, and their deviation from the line [m].

    Args:
        robot: the arm.
        tool: its tool.
        options: standoff, and how straight is straight.
        path: the rows to begin with, evenly spaced, thinning last, shape (path_points, joints).
        branch: its branch; None without a closed form.
        line: a point of the line, shape (3,) [m], and its unit direction, shape (3,).
    """
    rows, deviation = path, np.inf
    count = max(len(path), LEAST_REFINED_ROWS)
    for _ in range(TRAJECTORY_HALVINGS + 1):
        if count > len(path):
            retreats = even_retreats(options, count)
            rows = retreat_rows(robot, tool, path[-1], branch, retreats)
        deviation = line_deviation(robot, tool, rows, *line)
        if deviation <= options.straightness_m:
            break
        count = 2 * count - 1
    return rows, float(deviation)


def many_retreat_rows(
    robot: Robot, tool: Tool, thinning: Array, branches: NDArray[np.int64], retreats: Array
) -> Array:
    """`retreat_rows` of n thinning postures of an arm that is not on a rail.

    Args:
        robot: an arm with a spherical wrist.
        tool: its tool.
        thinning: postures at the targets, shape (n, 6) [rad].
        branches: inverse kinematics branches, shape (n,).
        retreats: distances behind the targets, descending to 0, shape (rows,) [m].

    Returns:
        Shape (n, rows, 6).
    """
    paths = np.empty((len(thinning), len(retreats), 6))
    paths[:, -1] = thinning
    poses = inverse(robot.mount) @ many_poses(robot, tool, thinning)
    retreat_from_many(
        wrist_geometry(robot, tool), np.ascontiguousarray(poses), branches, retreats, paths
    )
    return paths


def line_deviation(robot: Robot, tool: Tool, rows: Array, point: Array, direction: Array) -> float:
    """Largest distance of the tool centre point from a line, in motion through rows [m].

    Args:
        robot: the arm.
        tool: its tool.
        rows: postures, shape (n, 6) [rad].
        point: a point of the line, shape (3,) [m].
        direction: the line's unit direction, shape (3,).
    """
    return float(line_deviations(robot, tool, rows[None], point[None], direction[None])[0])


def line_deviations(
    robot: Robot, tool: Tool, paths: Array, points: Array, directions: Array
) -> Array:
    """`line_deviation` of n motions, shape (n,) [m].

    Args:
        robot: the arm.
        tool: its tool.
        paths: postures, shape (n, rows, joints).
        points: a point of each line, shape (n, 3) [m].
        directions: unit directions, shape (n, 3).
    """
    n, _, joints = paths.shape
    shares = np.linspace(0.0, 1.0, DEVIATION_SAMPLES + 2)[:-1, None, None, None]
    between = (paths[:, :-1] + shares * np.diff(paths, axis=1)).swapaxes(0, 1)
    postures = np.concatenate((between.reshape(n, -1, joints), paths[:, -1:]), axis=1)
    offsets = tool_centres(robot, tool, postures) - points.T[:, :, None]
    along = np.einsum("ink,ni->nk", offsets, directions)
    across = offsets - along * directions.T[:, :, None]
    return np.asarray(np.sqrt(np.max(np.sum(across * across, axis=0), axis=1)))


def rate_room(robot: Robot, tool: Tool, branch: int | None, rows: Array) -> Array:
    """What joints are short of JOINT_RATE_RAD_M in each row of a cut-in, shape (rows,).

    A sine, or for an arm without a closed form (branch None) a share of it; below zero where one
    turns faster. What slides has no such limit.
    """
    if branch is None:
        fastest = np.max(rates_behind(robot, tool, rows) * robot.turning, axis=1)
        return np.asarray(1.0 - fastest / JOINT_RATE_RAD_M)
    standing = family_of(robot, tool).standing(robot, rows[-1])
    assert standing is not None, "it has branches"
    room = np.empty(len(rows))
    joints = np.ascontiguousarray(rows[:, standing.first :])
    rows_rate_room(wrist_geometry(standing.arm, tool), joints, room)
    return room
