"""How straight cut-ins are as executed, and how near to limits, by means of the verifier's own.

Motion goes through the rows that are sent, or where those are not straight enough through finer
ones. Those are found here in plain NumPy: on the branch, or without a closed form by Newton's
method from the rows that are sent.
"""

import numpy as np
from numpy.typing import NDArray

from solver.kinematics.families.registry import family_of
from solver.kinematics.forward import forward_kinematics, jacobian, many_poses, tool_centres
from solver.problem.problem import Problem
from solver.robots.model import Array, Robot
from solver.tolerances import LEAST_REFINED_ROWS, TRAJECTORY_HALVINGS
from solver.verification.path_residuals import ClaimedPaths, retreats_of
from solver.verification.postures import arms_of
from solver.verification.tolerances import (
    ROW_ERROR,
    ROW_LARGEST_STEP,
    ROW_ROUNDS,
    STRAIGHTNESS_SHARES,
)


def as_executed(
    problem: Problem, claimed: ClaimedPaths, branches: NDArray[np.int64] | None
) -> tuple[Array, Array]:
    """How far motion leaves the lines [m], and its distance to a limit [rad], shape (n,) each.

    Args:
        problem: what was asked.
        claimed: n cut-ins.
        branches: inverse kinematics branches, on a rail those of the arm, shape (n,); None for an
            arm without a closed form.
    """
    options = problem.options
    deviations = np.full(len(claimed.paths), np.inf)
    margins = limit_margins(problem.robot, claimed.paths)
    count = max(options.path_points, LEAST_REFINED_ROWS)
    for _ in range(TRAJECTORY_HALVINGS + 1):
        bent = np.flatnonzero(deviations > options.straightness_m)
        if not len(bent):
            break
        rows = claimed.paths[bent]
        if count > options.path_points:
            rows = finer_rows(problem, rows, None if branches is None else branches[bent], count)
            margins[bent] = np.minimum(margins[bent], limit_margins(problem.robot, rows))
        lines = claimed.places[bent], claimed.axes[bent, :, 2]
        deviations[bent] = line_distances(problem, rows, *lines)
        count = 2 * count - 1
    return deviations, margins


def line_distances(problem: Problem, paths: Array, points: Array, directions: Array) -> Array:
    """How far the tool centre point leaves lines in motion through rows, shape (n,) [m].

    Args:
        problem: of the arm and its tool.
        paths: shape (n, rows, joints) [rad or m].
        points: a point of each line, shape (n, 3) [m].
        directions: unit directions, shape (n, 3).
    """
    n, _, joints = paths.shape
    before, step = paths[:, :-1, None], np.diff(paths, axis=1)[:, :, None]
    moving = before + np.array(STRAIGHTNESS_SHARES)[:, None] * step
    postures = np.concatenate((moving.reshape(n, -1, joints), paths[:, -1:]), axis=1)
    x, y, z = tool_centres(problem.robot, problem.mounted_tool, postures) - points.T[..., None]
    a, b, c = directions.T[..., None]
    squares = (y * c - z * b) ** 2 + (z * a - x * c) ** 2 + (x * b - y * a) ** 2
    return np.asarray(np.sqrt(squares.max(axis=1)))


def limit_margins(robot: Robot, paths: Array) -> Array:
    """Smallest distance of a joint that turns to a limit on n paths, shape (n,) [rad].

    What slides has no distance in an angle; `path_limit_excess_rad` covers it.
    """
    turning = robot.turning > 0
    nearer = np.minimum(paths - robot.lower, robot.upper - paths)[..., turning]
    return np.asarray(nearer.reshape(len(paths), -1).min(axis=1))


def finer_rows(
    problem: Problem, paths: Array, branches: NDArray[np.int64] | None, count: int
) -> Array:
    """Postures straight behind the last rows of n cut-ins, shape (n, count, joints) [rad or m].

    Args:
        problem: the arm, its tool and the standoff.
        paths: the cut-ins, standby first, shape (n, path_points, joints) [rad or m].
        branches: their branches, shape (n,); None without a closed form.
        count: so many evenly spaced rows; the last ones are those of the paths.
    """
    if branches is None:
        return np.stack([_followed(problem, path, count) for path in paths])
    family = family_of(problem.robot, problem.mounted_tool)
    if family.has_closed_form:
        return _on_branches(problem, problem.robot, paths, branches, count)
    found = np.repeat(paths[:, -1:], count, axis=1)
    for k, path in enumerate(paths):
        standing, own = family.standing(problem.robot, path[-1]), slice(k, k + 1)
        assert standing is not None, "it has branches"
        arm, first = standing
        joints = paths[own, :, first:]
        found[own, :, first:] = _on_branches(problem, arm, joints, branches[own], count)
    return found


def _on_branches(
    problem: Problem, robot: Robot, paths: Array, branches: NDArray[np.int64], count: int
) -> Array:
    thinning = paths[:, -1]
    arms = arms_of(robot, problem.mounted_tool, branches, thinning)
    behind = retreats_of(problem.options, count)[:-1]
    near = np.broadcast_to(thinning.T[..., None], (6, len(paths), len(behind)))
    joints = arms.postures(arms.centres_behind(behind), near)[:6]
    rows = np.concatenate((np.moveaxis(joints, 0, -1), thinning[:, None]), axis=1)
    # From the target backwards without a turn between rows.
    return np.asarray(np.unwrap(rows[:, ::-1], axis=1)[:, ::-1])


def _followed(problem: Problem, path: Array, count: int) -> Array:
    """Rows by Newton's method on the forward kinematics, all at once, from between those sent.

    Joints beyond six stand still, as they do from row to row of what was sent.
    """
    robot, tool, options = problem.robot, problem.mounted_tool, problem.options
    behind, sent = retreats_of(options, count), retreats_of(options, len(path))
    rows = np.stack([np.interp(-behind, -sent, joint) for joint in path.T], axis=1)
    moves = np.ptp(path, axis=0) > 0.0
    if np.count_nonzero(moves) < 6:
        moves = np.ones_like(moves)
    pose = forward_kinematics(robot, tool, path[-1])
    places = pose[:3, 3] - behind[:, None] * pose[:3, 2]
    for _ in range(ROW_ROUNDS):
        poses = many_poses(robot, tool, rows)
        # To first order the rotation that is missing is half the sum of its axes' cross products.
        turned = np.cross(poses[..., :3, :3], pose[:3, :3], axis=-2).sum(axis=-1) / 2
        missing = np.concatenate((places - poses[..., :3, 3], turned), axis=-1)
        if np.abs(missing).max() < ROW_ERROR:
            break
        steps = np.linalg.pinv(jacobian(robot, tool, rows)[..., moves]) @ missing[..., None]
        longest = np.abs(steps).max(axis=(-2, -1), keepdims=True)
        rows[:, moves] += (steps * np.minimum(1.0, ROW_LARGEST_STEP / (longest + ROW_ERROR)))[
            ..., 0
        ]
    rows[-1] = path[-1]
    return rows
