"""The verifier for many cut-ins at once, without timed motion.

Nobody claims efforts, deviations or distances to limits here: the verifier measures them from the
rows, and what it measured is the answer. How far targets may move is claimed, and tried out.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.approach.task.frame import approach_frames
from solver.approach.uncertainty.levels import told_level
from solver.approach.uncertainty.robustness import needed_margin
from solver.problem.problem import Problem
from solver.problem.solution import PLANNED, Approach, SolverReport
from solver.robots.model import Array
from solver.verification.path_residuals import (
    ClaimedPaths,
    Residuals,
    branch_residuals,
    deviation_residuals,
    displacement_residuals,
    efforts_between,
    margin_residuals,
    path_residuals,
)
from solver.verification.straightness import as_executed


@dataclass(frozen=True)
class ProposedPaths:
    """Approaches to n targets of a problem.

    Attributes:
        target_ids: whose.
        positions: of the targets, shape (n, 3) [m].
        directions: of their branches, any length, shape (n, 3).
        angles_rad: approach angles, in (-pi, pi], shape (n,) [rad].
        tool_sides: 1 or -1, shape (n,).
        branches: 0 to 7, shape (n,).
        paths: the cut-ins, standby first, shape (n, path_points, 6) [rad].
        references: postures from which efforts count, shape (n, 6) [rad].
        displacement_margins_m: how far each target may move, as it is claimed, shape (n,) [m].
    """

    target_ids: Sequence[str]
    positions: Array
    directions: Array
    angles_rad: Array
    tool_sides: NDArray[np.int64]
    branches: NDArray[np.int64]
    paths: Array
    references: Array
    displacement_margins_m: Array


@dataclass(frozen=True)
class Verified:
    """What the verifier finds of n approaches.

    Attributes:
        residuals: recomputed errors, each of all approaches.
        deviations: how far motion leaves the lines, shape (n,) [m].
        margins: smallest distances of a joint to a limit, shape (n,) [rad].
    """

    residuals: tuple[Residuals, ...]
    deviations: Array
    margins: Array

    @property
    def accepted(self) -> NDArray[np.bool_]:
        """Whether every residual of an approach is, shape (n,)."""
        return np.asarray(np.all([residual.accepted for residual in self.residuals], axis=0))


def verify_many(problem: Problem, proposed: ProposedPaths) -> Verified:
    """Residuals of approaches that claim to be solutions.

    Args:
        problem: without relaxations, of an arm with a closed form that is not on a rail.
        proposed: its approaches, at least one.
    """
    claimed = _claimed(proposed)
    standby, thinning = claimed.paths[:, 0], claimed.paths[:, -1]
    deviations, margins = as_executed(problem, claimed, proposed.branches)
    room, targets = proposed.displacement_margins_m, problem.targets_by_id
    needed = np.array([needed_margin(targets[target_id]) for target_id in proposed.target_ids])
    sides = (1, -1) if problem.options.symmetric_tool else (1,)
    wrong = np.isin(proposed.tool_sides, sides, invert=True).astype(np.float64)
    residuals = (
        Residuals("tool_side", wrong, 0.0),
        *path_residuals(problem, claimed, standby, thinning),
        *branch_residuals(problem, claimed, proposed.branches),
        *deviation_residuals(problem, deviations, deviations),
        *margin_residuals(problem, claimed, margins, margins),
        *displacement_residuals(problem, claimed, proposed.branches, room, needed),
    )
    return Verified(residuals, deviations, margins)


def judge_many(
    problem: Problem, proposed: ProposedPaths, reports: Sequence[SolverReport]
) -> dict[str, Approach]:
    """The approaches that verify, as planned, by target id; the others are left out.

    Args:
        problem: without relaxations, of an arm with a closed form that is not on a rail.
        proposed: its approaches.
        reports: what the method did for each.
    """
    if not proposed.target_ids:
        return {}
    found, options, targets = verify_many(problem, proposed), problem.options, problem.targets_by_id
    paths, room = np.ascontiguousarray(proposed.paths), proposed.displacement_margins_m
    efforts = efforts_between(problem, paths[:, -1], proposed.references)
    columns = zip(
        proposed.target_ids,
        reports,
        proposed.angles_rad.tolist(),
        proposed.tool_sides.tolist(),
        proposed.branches.tolist(),
        paths,
        found.deviations.tolist(),
        efforts.tolist(),
        found.margins.tolist(),
        room.tolist(),
        found.accepted.tolist(),
        strict=True,
    )
    levels = {
        target_id: told_level(options, targets[target_id], margin)
        for target_id, margin in zip(proposed.target_ids, room.tolist(), strict=True)
    }
    return {
        target_id: Approach(
            target_id=target_id,
            status=PLANNED,
            solver=report,
            approach_angle_rad=angle,
            tool_side=side,
            branch=branch,
            thinning_joints=path[-1],
            standby_joints=path[0],
            path_joints=path,
            path_deviation_m=deviation,
            effort=effort,
            margin_rad=margin,
            displacement_margin_m=displacement,
            position_margin_m=levels[target_id][0],
            margin_short=levels[target_id][1],
        )
        for (
            target_id, report, angle, side, branch, path, deviation, effort, margin, displacement,
            holds,
        ) in columns
        if holds
    }  # fmt: skip


def _claimed(proposed: ProposedPaths) -> ClaimedPaths:
    branch, outward, sideways = approach_frames(proposed.positions, proposed.directions)
    angles = proposed.angles_rad[:, None]
    z = np.cos(angles) * outward + np.sin(angles) * sideways
    y = proposed.tool_sides[:, None] * branch
    axes = np.stack((np.cross(y, z), y, z), axis=-1)
    return ClaimedPaths(np.ascontiguousarray(proposed.paths), proposed.positions, axes)
