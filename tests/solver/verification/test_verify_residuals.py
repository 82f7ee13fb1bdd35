"""Each residual has a row with an answer in which it fails and no other that is looked at.

Parts are looked at in turn, and what is wrong in one hides those behind it.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

from solver import Robot, verify
from solver.approach.numerical.warm_start import same_side
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.spherical_wrist import inverse_kinematics
from solver.robots.model import Array
from solver.verification.path_residuals import deviation_residuals
from solver.verification.verify import judge
from tests.solver.verification.spoiling import (
    Answer,
    Spoil,
    asked,
    at_pace,
    begins_late,
    certified,
    claim,
    emptied,
    for_robot,
    for_target,
    limited,
    more,
    moved,
    on_rail,
    relaxed,
    row_moved,
    rows_added,
    second,
    timed,
    too_fast,
    unhurried,
    untimed,
    without_branches,
    without_level,
)

HAIR_RAD = 1e-8
"""Above SAME_POSTURE_RAD and below all that is seen of a place or an axis."""


@dataclass(frozen=True)
class Row:
    """What breaks a residual: an honest answer, how it is spoilt, and what cannot but fail too."""

    honest: Callable[[], Answer]
    spoil: Spoil
    too: tuple[str, ...] = ()


def with_nan(field: str) -> Spoil:
    return more(field, np.nan, (0,) if field != "path_joints" else (0, 0))


def along_branch(target: Any) -> Any:
    """Where the approach directions are the same ones."""
    ahead = np.asarray(target.branch_direction) / np.linalg.norm(target.branch_direction)
    return replace(target, position_m=tuple(np.asarray(target.position_m) + 3e-6 * ahead))


def other_end(row: int, field: str) -> Spoil:
    """With one end of the cut-in on another branch, where the tool is at the same place."""

    def spoil(answer: Answer) -> Answer:
        robot, tool = answer.problem.robot, answer.problem.mounted_tool
        path = np.array(answer.approach.path_joints)
        pose = forward_kinematics(robot, tool, path[row])
        branch = (answer.approach.branch or 0) ^ 1
        path[row] = inverse_kinematics(robot, tool, pose[None]).joints[0, branch]
        return claim(**{"path_joints": path, field: path[row]})(answer)

    return spoil


def across(answer: Answer) -> Answer:
    """With standby in another posture of an arm without branches, at the same place."""
    robot, tool = answer.problem.robot, answer.problem.mounted_tool
    path = np.array(answer.approach.path_joints)
    wanted = forward_kinematics(robot, tool, path[0])

    def off(q: Array) -> Array:
        return np.asarray(forward_kinematics(robot, tool, q) - wanted).ravel()

    for q in np.random.default_rng(3).uniform(-np.pi, np.pi, (200, len(robot.joints))):
        found = least_squares(off, q, xtol=1e-15, ftol=1e-15, gtol=1e-15)
        rows = np.concatenate((found.x[None], path[1:]))
        if found.cost < 1e-20 and not same_side(robot, tool, rows):
            return claim(path_joints=rows, standby_joints=found.x)(answer)
    raise AssertionError("no other posture was found")


def narrower(joint: int, lower: float | None = None, upper: float | None = None) -> Spoil:
    def change(robot: Robot) -> Robot:
        old = robot.joints[joint]
        new = replace(
            old,
            lower=old.lower if lower is None else lower,
            upper=old.upper if upper is None else upper,
        )
        return replace(robot, joints=(*robot.joints[:joint], new, *robot.joints[joint + 1 :]))

    return for_robot(change)


def beyond_the_rail(answer: Answer) -> Answer:
    path = np.asarray(answer.approach.path_joints)
    return narrower(0, upper=float(path[0, 0]) - 1e-6)(answer)


def beyond_in_the_transfer(answer: Answer) -> Answer:
    """A joint's limit is where only the posture is beyond it that the transfer begins from."""
    joint, start = 1, answer.reference[1]
    narrow = narrower(joint, upper=start - 1e-6)(answer)
    times, rows = answer.trajectory.times_s, answer.trajectory.joints
    cut_in = rows[times >= answer.trajectory.segments[1].start_s]
    assert cut_in[:, joint].max() < start - 0.1
    margin = float(narrow.problem.robot.limit_margin(cut_in).min())
    return claim(margin_rad=margin, displacement_margin_m=0.002)(narrow)


def wider_claim(spoil: Spoil) -> Spoil:
    """And a deviation claimed that covers what is done to the line."""
    return lambda answer: claim(path_deviation_m=1e-3)(spoil(answer))


def slowly(spoil: Spoil, **factors: float) -> Spoil:
    return lambda answer: spoil(at_pace(answer, **factors))


MARGIN = "displacement_margin_m"
REFINED = "path_deviation_m"
ROWS = {
    # Shapes.
    "missing_fields": Row(timed, claim(effort=None)),
    "thinning_joints_shape": Row(timed, with_nan("thinning_joints")),
    "standby_joints_shape": Row(timed, with_nan("standby_joints")),
    "path_joints_shape": Row(timed, with_nan("path_joints")),
    "trajectory_shape": Row(timed, lambda a: moved(joints=a.trajectory.joints[:, :-1])(a)),
    "transfer_shape": Row(
        timed,
        lambda a: claim(transfer=replace(a.approach.transfer, joints=np.zeros((2, 5))))(a),  # type: ignore[type-var]
    ),
    "trajectory_times": Row(timed, lambda a: moved(segments=a.trajectory.segments[:-1])(a)),
    "tool_side": Row(timed, claim(tool_side=-1)),
    "approach_angle_turns": Row(timed, more("approach_angle_rad", 2 * np.pi)),
    # The path.
    "path_position_m": Row(timed, for_target(along_branch)),
    "path_axes_rad": Row(timed, more("approach_angle_rad", 3e-6)),
    "standby_is_path_end_rad": Row(timed, more("standby_joints", HAIR_RAD, (0,))),
    "thinning_is_path_end_rad": Row(timed, more("thinning_joints", HAIR_RAD, (0,))),
    "wrist_jump_rad_m": Row(too_fast, lambda a: a),
    "branch_exists": Row(timed, claim(branch=8)),
    # From one branch to another a joint jumps.
    "branch_continuity": Row(without_branches, across, ("wrist_jump_rad_m",)),
    "standby_branch_rad": Row(timed, other_end(0, "standby_joints"), ("wrist_jump_rad_m",)),
    "thinning_branch_rad": Row(timed, other_end(-1, "thinning_joints"), ("wrist_jump_rad_m",)),
    # Relaxations.
    "strike_claim_m": Row(relaxed, more("strike_m", 2e-6)),
    "tilt_claim_rad": Row(relaxed, more("tilt_rad", -2e-6)),
    # Numbers.
    "effort_relative": Row(timed, more("effort", -1e-6)),
    "lower_bound_above_effort": Row(
        certified, lambda a: claim(lower_bound=(a.approach.effort or 0.0) + 1e-6)(a)
    ),
    "path_deviation_claim_m": Row(untimed, more("path_deviation_m", -2e-6)),
    "margin_claim_rad": Row(timed, more("margin_rad", HAIR_RAD)),
    "path_limit_excess_rad": Row(on_rail, beyond_the_rail),
    "limit_excess_rad": Row(
        timed, lambda a: asked(limit_margin_rad=(a.approach.margin_rad or 0.0) + 1e-6)(a)
    ),
    # Displacements.
    "displacement_margin_absent": Row(timed, claim(displacement_margin_m=None)),
    "displacement_margin_claim_m": Row(
        timed, lambda a: more(MARGIN, 0.1 * (a.approach.displacement_margin_m or 0.0))(a)
    ),
    "displacement_margin_negative_m": Row(without_level, claim(displacement_margin_m=-1e-7)),
    "uncertainty_excess_m": Row(
        without_level, for_target(lambda target: replace(target, position_std_m=0.02))
    ),
    "position_margin_absent": Row(timed, claim(position_margin_m=None)),
    "margin_short": Row(timed, claim(margin_short=True)),
    "position_margin_is_level": Row(timed, claim(position_margin_m=0.0007, margin_short=True)),
    "position_margin_excess_m": Row(
        timed, lambda a: claim(position_margin_m=0.03)(asked(position_margin_m=0.03)(a))
    ),
    # Motion.
    "cut_in_rows": Row(timed, emptied("cut_in")),
    "dwell_rows": Row(timed, emptied("dwell")),
    "transfer_ends_rad": Row(unhurried, row_moved("transfer", 0.0, {0: HAIR_RAD})),
    "cut_in_ends_rad": Row(unhurried, begins_late("cut_in", HAIR_RAD)),
    # Whoever begins to dwell elsewhere moves in it.
    "dwell_ends_rad": Row(unhurried, begins_late("dwell", HAIR_RAD), ("dwell_moves_rad",)),
    "retreat_ends_rad": Row(unhurried, row_moved("retreat", 1.0, {0: HAIR_RAD})),
    "transfer_velocity_share": Row(unhurried, limited("velocity", "transfer")),
    "cut_in_velocity_share": Row(unhurried, limited("velocity", "cut_in")),
    "retreat_velocity_share": Row(unhurried, limited("velocity", "retreat")),
    # From rest to rest nobody is fast in no distance without being faster still in getting there.
    "dwell_velocity_share": Row(
        unhurried,
        rows_added("dwell", 0.0, (1.0, 1.0 + 2e-10), 0.9e-9),
        ("dwell_acceleration_share",),
    ),
    "transfer_acceleration_share": Row(unhurried, limited("acceleration", "transfer")),
    "cut_in_acceleration_share": Row(unhurried, limited("acceleration", "cut_in")),
    "retreat_acceleration_share": Row(unhurried, limited("acceleration", "retreat")),
    "dwell_acceleration_share": Row(
        unhurried, rows_added("dwell", 0.0, (1.0, 1.0 + 1e-6, 1.0 + 2e-6), 0.9e-9)
    ),
    "transfer_corners_rad": Row(
        timed,
        lambda a: claim(
            transfer=replace(a.approach.transfer, joints=a.approach.transfer.joints + HAIR_RAD)  # type: ignore[type-var,union-attr]
        )(a),
    ),
    "trajectory_limit_excess_rad": Row(second, beyond_in_the_transfer),
    "dwell_s": Row(timed, asked(dwell_s=5.1)),
    "dwell_moves_rad": Row(unhurried, rows_added("dwell", 0.0, (1.0, 2.0), HAIR_RAD)),
    "cut_in_deviation_m": Row(
        timed, wider_claim(slowly(row_moved("cut_in", 0.5, {0: 1e-3}), cut_in=8.0))
    ),
    "retreat_deviation_m": Row(
        timed, wider_claim(slowly(row_moved("retreat", 0.5, {0: 1e-3}), retreat=8.0))
    ),
    "cut_in_deviation_claim_m": Row(timed, slowly(row_moved("cut_in", 0.5, {0: 1e-4}), cut_in=8.0)),
    "retreat_deviation_claim_m": Row(
        timed, slowly(row_moved("retreat", 0.5, {0: 1e-4}), retreat=8.0)
    ),
}


def failures(answer: Answer) -> list[str]:
    found = verify(answer.problem, answer.approach, answer.reference)
    return [residual.name for residual in found.failures]


def names(answer: Answer) -> set[str]:
    found = verify(answer.problem, answer.approach, answer.reference)
    return {residual.name for residual in found.residuals}


@pytest.mark.parametrize("name", ROWS)
def test_what_is_spoilt_is_what_fails(name: str) -> None:
    row = ROWS[name]
    honest = row.honest()
    spoilt = row.spoil(honest)
    assert spoilt is honest or failures(honest) == []
    assert set(failures(spoilt)) == {name, *row.too}
    judged = judge(spoilt.problem, spoilt.approach, spoilt.reference)
    assert judged.status == "infeasible"
    assert judged.reason is not None
    assert judged.reason.code == "solver_failed"
    assert name in judged.reason.detail


def test_motion_through_refined_rows_has_to_be_straight() -> None:
    """Rows are refined until it is, so no answer is known whose motion is not."""
    problem = untimed().problem
    allowed = problem.options.straightness_m
    for deviation, accepted in ((0.99 * allowed, True), (1.01 * allowed, False)):
        found = {
            one.name: one.of(0)
            for one in deviation_residuals(problem, *[np.array([deviation])] * 2)
        }
        assert found[REFINED].accepted is accepted


def test_the_rows_are_the_residuals() -> None:
    answers = [
        answer for row in ROWS.values() for answer in (row.honest(), row.spoil(row.honest()))
    ]
    assert set().union(*(names(answer) for answer in answers)) == {*ROWS, REFINED}
