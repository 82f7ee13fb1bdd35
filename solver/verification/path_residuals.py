"""Residuals of cut-ins, of many approaches at once; part of the one verifier in `verification`.

One approach is a batch of one: the formulas are the same for a single target and for thousands.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.kinematics.families.registry import family_of
from solver.kinematics.forward import many_poses
from solver.kinematics.spherical_wrist import inverse_kinematics
from solver.problem.options import Options
from solver.problem.problem import Problem
from solver.robots.model import Array
from solver.tolerances import (
    AXIS_ERROR_RAD,
    EFFORT_ERROR_RELATIVE,
    JOINT_RATE_RAD_M,
    LIMIT_EXCESS_RAD,
    POSITION_ERROR_M,
    RATE_EXCESS_SHARE,
    SAME_BRANCH_RAD,
    SAME_POSTURE_RAD,
)
from solver.verification.displacement import displacement_overshoots
from solver.verification.joint_rates import fastest_rates
from solver.verification.tolerances import DISPLACED_ERROR_M
from solver.verification.verdict import Residual


@dataclass(frozen=True)
class Residuals:
    """One recomputed error of n approaches, shape (n,), and what is allowed."""

    name: str
    values: Array
    allowed: float

    @property
    def accepted(self) -> NDArray[np.bool_]:
        """Whether each is within what is allowed; a value that is not a number is not."""
        return np.asarray(self.values <= self.allowed)

    def of(self, k: int) -> Residual:
        """The residual of one approach."""
        return Residual(self.name, float(self.values[k]), self.allowed)


@dataclass(frozen=True)
class ClaimedPaths:
    """Cut-ins of n approaches, and where the problem wants them.

    Attributes:
        paths: evenly spaced rows, standby first, shape (n, path_points, joints) [rad or m].
        places: where the tool has to be at thinning, shape (n, 3) [m].
        axes: the tool's axes there, as columns, shape (n, 3, 3).
    """

    paths: Array
    places: Array
    axes: Array

    @property
    def ends(self) -> dict[str, Array]:
        """First and last rows, shape (n, joints)."""
        return {"standby": self.paths[:, 0], "thinning": self.paths[:, -1]}


def path_residuals(
    problem: Problem, claimed: ClaimedPaths, standby: Array, thinning: Array
) -> Iterator[Residuals]:
    """The rows are where they have to be, end where the answer says, and no joint is too fast.

    Args:
        problem: what was asked.
        claimed: the cut-ins.
        standby: standby postures of the answers, shape (n, joints).
        thinning: their thinning postures, shape (n, joints).
    """
    options, paths, axes = problem.options, claimed.paths, claimed.axes
    poses = many_poses(problem.robot, problem.mounted_tool, paths)
    retreats = retreats_of(options, options.path_points)
    places = claimed.places[:, None] - retreats[:, None] * axes[:, None, :, 2]
    errors = poses[..., :3, 3] - places
    yield Residuals("path_position_m", _longest(errors), POSITION_ERROR_M)
    turned = poses[..., :3, :3] - axes[:, None]
    yield Residuals("path_axes_rad", _longest(np.swapaxes(turned, -1, -2)), AXIS_ERROR_RAD)
    for (name, end), rows in zip(claimed.ends.items(), (standby, thinning), strict=True):
        apart = np.abs(rows - end).max(axis=1)
        yield Residuals(f"{name}_is_path_end_rad", apart, SAME_POSTURE_RAD)
    rates = fastest_rates(problem, paths)
    yield Residuals("wrist_jump_rad_m", rates, JOINT_RATE_RAD_M * (1 + RATE_EXCESS_SHARE))


def retreats_of(options: Options, rows: int) -> Array:
    """Where rows have to be behind the target, from the standoff down to 0, shape (rows,) [m]."""
    return np.linspace(options.standoff_m, 0.0, rows)


def branch_residuals(
    problem: Problem, claimed: ClaimedPaths, branches: NDArray[np.int64]
) -> Iterator[Residuals]:
    """Both ends are on the branch claimed, shape (n,), of an arm with a closed form."""
    tool = problem.mounted_tool
    family = family_of(problem.robot, tool)
    for name, postures in claimed.ends.items():
        # Many at once are of an arm that stands where it always does.
        standing = family.standing(problem.robot, postures[0])
        assert standing is not None, "it has branches"
        arm, rows = standing.arm, postures[:, standing.first :]
        found = inverse_kinematics(arm, tool, many_poses(arm, tool, rows)).joints
        apart = found[np.arange(len(rows)), branches] - rows
        turned = np.abs(np.remainder(apart + np.pi, 2 * np.pi) - np.pi).max(axis=1)
        yield Residuals(f"{name}_branch_rad", turned, SAME_BRANCH_RAD)


def effort_residuals(
    problem: Problem, thinning: Array, references: Array, efforts: Array
) -> Iterator[Residuals]:
    """Efforts claimed, shape (n,), between references and thinning, shape (n, joints) each."""
    truth = efforts_between(problem, thinning, references)
    errors = np.abs(truth - efforts) / np.maximum(1.0, truth)
    yield Residuals("effort_relative", errors, EFFORT_ERROR_RELATIVE)


def efforts_between(problem: Problem, thinning: Array, references: Array) -> Array:
    """Efforts from references to thinning postures, shape (n, joints) each, as shape (n,)."""
    change = np.abs(thinning - references)
    travel = change if problem.options.norm == "l1" else change * change
    # Not a matrix product, whose last bit depends on how many there are.
    return np.asarray(np.sum(travel * np.asarray(problem.joint_weights), axis=1))


def deviation_residuals(problem: Problem, deviations: Array, claims: Array) -> Iterator[Residuals]:
    """How far motion through the rows leaves the line, and what is claimed, shape (n,) each [m]."""
    yield Residuals("path_deviation_m", deviations, problem.options.straightness_m)
    yield Residuals("path_deviation_claim_m", deviations - claims, POSITION_ERROR_M)


def margin_residuals(
    problem: Problem, claimed: ClaimedPaths, margins: Array, claims: Array
) -> Iterator[Residuals]:
    """Smallest distances to a limit found and claimed, shape (n,) each [rad]."""
    robot, paths = problem.robot, claimed.paths
    yield Residuals("margin_claim_rad", np.abs(margins - claims), SAME_POSTURE_RAD)
    outside = np.maximum(robot.lower - paths, paths - robot.upper).max(axis=(1, 2))
    yield Residuals("path_limit_excess_rad", outside, LIMIT_EXCESS_RAD)
    excess = problem.options.limit_margin_rad - margins
    yield Residuals("limit_excess_rad", excess, LIMIT_EXCESS_RAD)


def displacement_residuals(
    problem: Problem,
    claimed: ClaimedPaths,
    branches: NDArray[np.int64],
    claims: Array,
    needed: Array,
) -> Iterator[Residuals]:
    """How far the targets may move, as it is claimed, and what they need, shape (n,) each [m].

    Only a claim that is too large is refused: one that is too small promises nothing untrue.
    """
    beyond = displacement_overshoots(problem, branches, claimed.paths, claims)
    yield Residuals("displacement_margin_claim_m", beyond, DISPLACED_ERROR_M)
    yield Residuals("displacement_margin_negative_m", -claims, 0.0)
    yield Residuals("uncertainty_excess_m", needed - claims, POSITION_ERROR_M)


def _longest(vectors: Array) -> Array:
    """Largest length of the vectors of each approach, shape (n, ..., 3) to (n,)."""
    squares = np.sum(vectors * vectors, axis=-1)
    return np.asarray(np.sqrt(squares.reshape(len(squares), -1).max(axis=1)))
