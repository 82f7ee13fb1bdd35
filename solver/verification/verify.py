"""The one verifier: recomputes every residual of an answer from the problem alone.

It is the only place that gives an approach the status "planned". It believes no number that a
method reports: positions, axes, limits, effort, straightness and speeds are computed anew from the
postures. Forward kinematics is plain NumPy here; methods use the closed form and CasADi.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from solver.approach.numerical.warm_start import same_side
from solver.approach.task.frame import approach_frame
from solver.approach.uncertainty.levels import margin_levels
from solver.approach.uncertainty.robustness import needed_margin
from solver.kinematics.families.registry import family_of
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.spherical_wrist import BRANCHES
from solver.problem.plan import Plan
from solver.problem.problem import Problem
from solver.problem.solution import (
    INFEASIBLE,
    PLANNED,
    Approach,
    Reason,
    Trajectory,
    Transfer,
)
from solver.problem.targets import Target
from solver.robots.model import Array
from solver.tolerances import (
    AXIS_ERROR_RAD,
    EFFORT_ERROR_RELATIVE,
    POSITION_ERROR_M,
)
from solver.verification.motion_residuals import (
    Motion,
    motion_residuals,
    segment_rows,
    shape_residuals,
)
from solver.verification.path_residuals import (
    ClaimedPaths,
    Residuals,
    branch_residuals,
    deviation_residuals,
    displacement_residuals,
    effort_residuals,
    efforts_between,
    margin_residuals,
    path_residuals,
)
from solver.verification.placement import Seen, seen_from
from solver.verification.straightness import as_executed, limit_margins
from solver.verification.verdict import Residual, Verification

MAY_BE_ABSENT = (
    "branch",
    "lower_bound",
    "displacement_margin_m",
    "position_margin_m",
    "margin_short",
)
TIMED_FIELDS = ("transfer", "trajectory")


def verify(problem: Problem, approach: Approach, reference: Sequence[float]) -> Verification:
    """Residuals of an approach that claims to be a solution, whatever status it carries.

    Args:
        problem: what was asked.
        approach: the answer for one of its targets.
        reference: posture from which effort and transfer count: the start, or unless independent
            the previous planned standby, shape (6,) [rad].
    """
    target = problem.targets_by_id.get(approach.target_id)
    claim = _claim(problem, approach)
    if target is None or claim is None:
        return Verification((Residual("missing_fields", 1.0, 0.0),))
    parts = (
        _shape_residuals(problem, claim),
        _path_residuals(problem, target, claim),
        _relaxation_residuals(problem, target, approach, claim),
        _number_residuals(problem, target, claim, reference),
        _displacement_residuals(problem, target, claim),
        _timing_residuals(problem, target, claim, reference),
    )
    found: list[Residual] = []
    for part in parts:
        found += part
        if not all(residual.accepted for residual in found):
            break  # later parts rely on the shapes and postures that earlier ones check
    return Verification(tuple(found))


def judge(problem: Problem, approach: Approach, reference: Sequence[float]) -> Approach:
    """The approach as planned if it verifies, else as infeasible with what failed."""
    verification = verify(problem, approach, reference)
    if verification.accepted:
        return replace(approach, status=PLANNED)
    reason = refusal(verification)
    return Approach(approach.target_id, INFEASIBLE, approach.solver, reason=reason)


def refusal(verification: Verification) -> Reason:
    """The reason why an approach is none: what of it did not verify."""
    failed = ", ".join(
        f"{residual.name} {residual.value:.3g} (allowed {residual.allowed:.3g})"
        for residual in verification.failures
    )
    return Reason("solver_failed", f"the answer did not verify: {failed}")


def verify_plan(plan: Plan) -> dict[str, Verification]:
    """Verification of every approach that a plan calls planned, by target id."""
    results: dict[str, Verification] = {}
    reference = plan.problem.start
    for approach in plan.approaches:
        if approach.status != PLANNED:
            continue
        results[approach.target_id] = verify(plan.problem, approach, reference)
        if plan.problem.options.order != "independent" and approach.standby_joints is not None:
            reference = tuple(approach.standby_joints)
    return results


@dataclass(frozen=True)
class _Claim:
    """The fields of an approach that claims to be planned; those that may be None may be absent."""

    approach_angle_rad: float
    tool_side: int
    branch: int | None
    thinning_joints: Array
    standby_joints: Array
    path_joints: Array
    path_deviation_m: float
    effort: float
    margin_rad: float
    displacement_margin_m: float | None
    position_margin_m: float | None
    margin_short: bool | None
    transfer: Transfer | None
    trajectory: Trajectory | None
    lower_bound: float | None


def _claim(problem: Problem, approach: Approach) -> _Claim | None:
    values = {entry.name: getattr(approach, entry.name) for entry in fields(_Claim)}
    may_be_absent = MAY_BE_ABSENT if problem.options.timed else (*MAY_BE_ABSENT, *TIMED_FIELDS)
    missing = any(value is None for name, value in values.items() if name not in may_be_absent)
    return None if missing else _Claim(**values)


def _seen(problem: Problem, target: Target, claim: _Claim, posture: Array) -> Seen:
    pose = forward_kinematics(problem.robot, problem.mounted_tool, np.asarray(posture))
    branch = approach_frame(target.position_m, target.branch_direction).branch
    return seen_from(np.asarray(target.position_m), branch, claim.tool_side, pose)


def _wanted_pose(problem: Problem, target: Target, claim: _Claim) -> tuple[Array, Array]:
    """Where the tool has to be at thinning, shape (3,), and its axes, shape (3, 3).

    At the claimed approach angle; strike and lean are those of the thinning posture, cut to what
    is allowed. Without relaxations that leaves the target itself and the unrelaxed axes.
    """
    options, seen = problem.options, _seen(problem, target, claim, claim.path_joints[-1])
    frame = approach_frame(target.position_m, target.branch_direction)
    upright = frame.axes(claim.approach_angle_rad, claim.tool_side)
    axes = seen.leaning(upright, options.tilt_tolerance_rad)
    strike = min(max(seen.strike_m, 0.0), options.strike_zone_m)
    return np.asarray(target.position_m) + strike * axes[:, 2], axes


def _relaxation_residuals(
    problem: Problem, target: Target, approach: Approach, claim: _Claim
) -> Iterator[Residual]:
    """Claims of how much of the relaxations is used: there where one is on, true, and only there.

    That no more is used than allowed is in the residuals of the path.
    """
    used, options = _seen(problem, target, claim, claim.thinning_joints), problem.options
    for name, claimed, truth, on, allowed in (
        ("strike_claim_m", approach.strike_m, used.strike_m, options.strike_zone_m > 0,
         POSITION_ERROR_M),
        ("tilt_claim_rad", approach.tilt_rad, used.tilt_rad, options.tilt_tolerance_rad > 0,
         AXIS_ERROR_RAD),
    ):  # fmt: skip
        if claimed is None or not on:
            yield Residual(name, float((claimed is not None) != on), 0.0)
        else:
            yield Residual(name, abs(claimed - truth), allowed)


def _shape_residuals(problem: Problem, claim: _Claim) -> Iterator[Residual]:
    n = len(problem.robot.joints)
    wanted: dict[str, tuple[Array, tuple[int, ...]]] = {
        "thinning_joints": (claim.thinning_joints, (n,)),
        "standby_joints": (claim.standby_joints, (n,)),
        "path_joints": (claim.path_joints, (problem.options.path_points, n)),
    }
    for name, (array, shape) in wanted.items():
        wrong = np.shape(array) != shape or not np.isfinite(np.asarray(array)).all()
        yield Residual(f"{name}_shape", float(wrong), 0.0)
    if claim.trajectory is not None and claim.transfer is not None:
        yield from shape_residuals(claim.trajectory, claim.transfer, n)
    sides = (1, -1) if problem.options.symmetric_tool else (1,)
    yield Residual("tool_side", float(claim.tool_side not in sides), 0.0)
    yield Residual("approach_angle_turns", abs(claim.approach_angle_rad) / np.pi, 1.0)


def _path_residuals(problem: Problem, target: Target, claim: _Claim) -> Iterator[Residual]:
    claimed = _claimed_path(problem, target, claim)
    standby, thinning = np.asarray(claim.standby_joints), np.asarray(claim.thinning_joints)
    yield from _single(path_residuals(problem, claimed, standby[None], thinning[None]))
    yield from _branch_residuals(problem, claim, claimed)


def _claimed_path(problem: Problem, target: Target, claim: _Claim) -> ClaimedPaths:
    place, axes = _wanted_pose(problem, target, claim)
    return ClaimedPaths(np.asarray(claim.path_joints)[None], place[None], axes[None])


def _single(residuals: Iterator[Residuals]) -> Iterator[Residual]:
    return (residual.of(0) for residual in residuals)


def _branch_residuals(problem: Problem, claim: _Claim, claimed: ClaimedPaths) -> Iterator[Residual]:
    """The branch claimed, at both ends; of an arm without branches, that its rows hang together."""
    robot, tool, rows = problem.robot, problem.mounted_tool, np.asarray(claim.path_joints)
    known = claim.branch is not None and 0 <= claim.branch < BRANCHES
    if known != family_of(robot, tool).has_branches or (claim.branch is not None and not known):
        yield Residual("branch_exists", 1.0, 0.0)
        return
    if claim.branch is None:
        yield Residual("branch_continuity", float(not same_side(robot, tool, rows)), 0.0)
        return
    yield from _single(branch_residuals(problem, claimed, np.array([claim.branch])))


def _number_residuals(
    problem: Problem, target: Target, claim: _Claim, reference: Sequence[float]
) -> Iterator[Residual]:
    thinning, references = np.asarray(claim.thinning_joints)[None], np.asarray(reference)[None]
    efforts = np.array([claim.effort])
    yield from _single(effort_residuals(problem, thinning, references, efforts))
    if claim.lower_bound is not None:
        (effort,) = efforts_between(problem, thinning, references).tolist()
        above = (claim.lower_bound - effort) / max(1.0, effort)
        yield Residual("lower_bound_above_effort", above, EFFORT_ERROR_RELATIVE)
    claimed = _claimed_path(problem, target, claim)
    if claim.trajectory is None:
        branches = None if claim.branch is None else np.array([claim.branch])
        deviations, margins = as_executed(problem, claimed, branches)
        claims = np.array([claim.path_deviation_m])
        yield from _single(deviation_residuals(problem, deviations, claims))
    else:
        executed = segment_rows(claim.trajectory, "cut_in", "dwell", "retreat")[1]
        rows = np.concatenate((claimed.paths[0], executed))
        margins = limit_margins(problem.robot, rows[None])
    yield from _single(margin_residuals(problem, claimed, margins, np.array([claim.margin_rad])))


def _displacement_residuals(problem: Problem, target: Target, claim: _Claim) -> Iterator[Residual]:
    if claim.branch is None or claim.displacement_margin_m is None:
        # Only an arm without a closed form has neither; `_branch_residuals` checks that it is one.
        yield Residual("displacement_margin_absent", float(claim.branch is not None), 0.0)
        return
    claimed, branches = _claimed_path(problem, target, claim), np.array([claim.branch])
    claims, needed = np.array([claim.displacement_margin_m]), np.array([needed_margin(target)])
    yield from _single(displacement_residuals(problem, claimed, branches, claims, needed))
    yield from _level_residuals(problem, target, claim, claim.displacement_margin_m)


def _level_residuals(
    problem: Problem, target: Target, claim: _Claim, margin: float
) -> Iterator[Residual]:
    """The level told is one of those to try, borne, and short where it is said to be."""
    wished, level = problem.options.position_margin_m or 0.0, claim.position_margin_m
    asked, told = wished > 0.0, level is not None
    yield Residual("position_margin_absent", float(told != asked), 0.0)
    short = asked and level is not None and level < wished
    yield Residual("margin_short", float((claim.margin_short or False) != short), 0.0)
    if level is not None:
        levels = (*margin_levels(problem.options, target), 0.0)
        yield Residual("position_margin_is_level", float(level not in levels), 0.0)
        yield Residual("position_margin_excess_m", level - margin, POSITION_ERROR_M)


def _timing_residuals(
    problem: Problem, target: Target, claim: _Claim, reference: Sequence[float]
) -> Iterator[Residual]:
    if claim.trajectory is None or claim.transfer is None:
        return
    place, axes = _wanted_pose(problem, target, claim)
    motion = Motion(np.asarray(reference), claim.transfer, claim.trajectory)
    yield from motion_residuals(
        problem, motion, claim.path_joints, (place, axes[:, 2]), claim.path_deviation_m
    )
