"""Residuals of timed motion on a trajectory made by hand, one violated at a time."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver import Options, Problem, Target, load_robot
from solver.kinematics.forward import forward_kinematics
from solver.problem.solution import Segment, Trajectory, Transfer
from solver.verification.motion_residuals import (
    SEGMENTS,
    Motion,
    motion_residuals,
    segment_rows,
    shape_residuals,
)
from solver.verification.straightness import line_distances
from solver.verification.verdict import Residual

ROBOT = load_robot("tabletop")
DWELL_S = 2.0
PROBLEM = Problem(
    ROBOT,
    [Target("a", (0.2, 0.0, 0.35), (0.0, 1.0, 0.0))],
    options=Options(dwell_s=DWELL_S, straightness_m=1e-4),
)
REFERENCE = np.zeros(6)
STANDBY = np.array([0.2, 0.5, -0.7, 0.1, 0.6, -0.1])
THINNING = STANDBY + np.array([0.0, 0.01, -0.015, 0.0, 0.005, 0.0])
PATH = np.stack((STANDBY, (STANDBY + THINNING) / 2, THINNING))
TOOL = PROBLEM.mounted_tool


def smooth(start: np.ndarray, end: np.ndarray, rows: int) -> np.ndarray:
    """From rest to rest."""
    shares = np.linspace(0.0, 1.0, rows)[:, None]
    return np.asarray(start + (end - start) * shares**2 * (3 - 2 * shares))


TIMES = np.concatenate(
    (np.linspace(0.0, 4.0, 21), 4.0 + np.linspace(0.1, 1.0, 10), [5.0 + DWELL_S],
     5.0 + DWELL_S + np.linspace(0.1, 1.0, 10))
)  # fmt: skip
JOINTS = np.concatenate(
    (smooth(REFERENCE, STANDBY, 21), smooth(STANDBY, THINNING, 11)[1:], [THINNING],
     smooth(THINNING, STANDBY, 11)[1:])
)  # fmt: skip
NAMED = tuple(
    Segment(name, start, end)
    for name, start, end in zip(
        SEGMENTS,
        (0.0, 4.0, 5.0, 5.0 + DWELL_S),
        (4.0, 5.0, 5.0 + DWELL_S, 6.0 + DWELL_S),
        strict=True,
    )
)
TRAJECTORY = Trajectory(TIMES, JOINTS, NAMED)
# Rows of each segment, both ends included.
ROWS = {"transfer": slice(0, 21), "cut_in": slice(20, 31), "dwell": slice(30, 32),
        "retreat": slice(31, 42)}  # fmt: skip


def transfer(joints: np.ndarray) -> Transfer:
    return Transfer("joint_line", joints, 0.0)


CORNERS = np.stack((REFERENCE, STANDBY))


def motion(
    joints: np.ndarray = JOINTS, times: np.ndarray = TIMES, corners: Any = CORNERS
) -> Motion:
    return Motion(REFERENCE, transfer(corners), replace(TRAJECTORY, joints=joints, times_s=times))


def line() -> tuple[np.ndarray, np.ndarray]:
    """As wide of the motion as the joint-linear cut-in is of it."""
    first, last = (forward_kinematics(ROBOT, TOOL, q)[:3, 3] for q in (STANDBY, THINNING))
    return last, (last - first) / np.linalg.norm(last - first)


def residuals(moved: Motion, claimed_m: float = 1.0, path: np.ndarray = PATH,
              problem: Problem = PROBLEM) -> dict[str, Residual]:  # fmt: skip
    found = list(motion_residuals(problem, moved, path, line(), claimed_m))
    assert len({one.name for one in found}) == len(found)
    return {one.name: one for one in found}


def failures(found: dict[str, Residual]) -> set[str]:
    return {name for name, one in found.items() if not one.accepted}


def test_a_motion_made_by_hand_has_no_failure() -> None:
    found = residuals(motion())
    assert failures(found) == set()
    names = [f"{segment}_{what}" for segment in SEGMENTS
             for what in ("ends_rad", "velocity_share", "acceleration_share")]  # fmt: skip
    names += ["transfer_corners_rad", "trajectory_limit_excess_rad", "dwell_s", "dwell_moves_rad"]
    names += ["cut_in_deviation_m", "cut_in_deviation_claim_m", "retreat_deviation_m",
              "retreat_deviation_claim_m"]  # fmt: skip
    assert list(found) == names


def test_what_is_allowed() -> None:
    allowed = {name: one.allowed for name, one in residuals(motion()).items()}
    for segment in SEGMENTS:
        assert allowed[f"{segment}_ends_rad"] == 1e-9
        assert allowed[f"{segment}_velocity_share"] == 1 + 1e-6
        assert allowed[f"{segment}_acceleration_share"] == 1 + 1e-6
    assert allowed["transfer_corners_rad"] == allowed["dwell_moves_rad"] == 1e-9
    assert allowed["trajectory_limit_excess_rad"] == 1e-9
    assert allowed["dwell_s"] == 1e-9
    assert allowed["cut_in_deviation_m"] == allowed["retreat_deviation_m"] == 1e-4
    assert allowed["cut_in_deviation_claim_m"] == allowed["retreat_deviation_claim_m"] == 1e-6


@pytest.mark.parametrize("segment", SEGMENTS)
def test_rates_are_shares_of_the_limits(segment: str) -> None:
    found, own = residuals(motion()), ROWS[segment]
    times, rows = TIMES[own], JOINTS[own]
    speeds = np.diff(rows, axis=0) / np.diff(times)[:, None]
    share = (np.abs(speeds) / ROBOT.velocity).max()
    assert found[f"{segment}_velocity_share"].value == pytest.approx(share)
    # At rest before and after; a change of speed takes from middle to middle of two rows.
    steps = np.diff(times)
    changes = np.diff(speeds, axis=0) / ((steps[1:] + steps[:-1]) / 2)[:, None]
    ends = np.stack((speeds[0] / (steps[0] / 2), speeds[-1] / (steps[-1] / 2)))
    share = (np.abs(np.concatenate((changes, ends))) / ROBOT.acceleration).max()
    assert found[f"{segment}_acceleration_share"].value == pytest.approx(share)


@pytest.mark.parametrize("segment", ["transfer", "cut_in", "retreat"])
def test_a_segment_that_is_too_fast_is_told(segment: str) -> None:
    times = TIMES.copy()
    own = ROWS[segment]
    spent = times[own.stop - 1] - times[own.start]
    scale = 1e-3
    times[own] = times[own.start] + (times[own] - times[own.start]) * scale
    times[own.stop :] -= spent * (1 - scale)
    ends = [times[ROWS[name].stop - 1] for name in SEGMENTS]
    starts = [times[ROWS[name].start] for name in SEGMENTS]
    named = tuple(map(Segment, SEGMENTS, starts, ends))
    moved = replace(motion(), trajectory=Trajectory(times, JOINTS, named))
    found = residuals(moved)
    assert failures(found) == {f"{segment}_velocity_share", f"{segment}_acceleration_share"}
    before = residuals(motion())
    for name, power in ((f"{segment}_velocity_share", 1), (f"{segment}_acceleration_share", 2)):
        assert found[name].value == pytest.approx(before[name].value / scale**power)


def bent(row: int, joint: int, by: float) -> np.ndarray:
    joints = JOINTS.copy()
    joints[row, joint] += by
    return joints


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("row", "names"),
    [
        (0, {"transfer_ends_rad"}),
        (20, {"transfer_ends_rad", "cut_in_ends_rad"}),
        (30, {"cut_in_ends_rad", "dwell_ends_rad", "dwell_moves_rad"}),
        (31, {"dwell_ends_rad", "retreat_ends_rad", "dwell_moves_rad"}),
        (41, {"retreat_ends_rad"}),
    ],
)
def test_every_segment_ends_where_the_next_begins(sign: float, row: int, names: set[str]) -> None:
    """A hair off is told of by as much."""
    found = residuals(motion(bent(row, 2, sign * 3e-9)))
    assert failures(found) == names
    for name in names:
        assert found[name].value == pytest.approx(3e-9, rel=1e-6)
    within = residuals(motion(bent(row, 2, sign * 0.9e-9)))
    assert failures(within) == set()


@pytest.mark.parametrize("place", [0, -1])
def test_the_corners_of_the_transfer_are_its_ends(place: int) -> None:
    corners = CORNERS.copy()
    corners[place, 4] -= 2e-9
    found = residuals(motion(corners=corners))
    assert failures(found) == {"transfer_corners_rad"}
    assert found["transfer_corners_rad"].value == pytest.approx(2e-9, rel=1e-6)
    between = np.stack((REFERENCE, np.ones(6), STANDBY))
    assert failures(residuals(motion(corners=between))) == set()


@pytest.mark.parametrize("side", ["lower", "upper"])
def test_limits_hold_in_the_motion_and_in_the_rows(side: str) -> None:
    joints, sign = JOINTS.copy(), 1.0 if side == "upper" else -1.0
    limit = getattr(ROBOT, side)[5]
    joints[10, 5] = limit + sign * 2e-9
    found = residuals(motion(joints))
    assert "trajectory_limit_excess_rad" in failures(found)
    assert found["trajectory_limit_excess_rad"].value == pytest.approx(2e-9, rel=1e-5)
    path = PATH.copy()
    path[1, 5] = limit + sign * 0.25
    found = residuals(motion(), path=path)
    assert failures(found) == {"trajectory_limit_excess_rad"}
    assert found["trajectory_limit_excess_rad"].value == pytest.approx(0.25)
    inside = residuals(motion())["trajectory_limit_excess_rad"].value
    rows = np.concatenate((JOINTS, PATH))
    assert inside == pytest.approx(-np.minimum(rows - ROBOT.lower, ROBOT.upper - rows).min())


@pytest.mark.parametrize("asked", [DWELL_S + 1e-8, DWELL_S - 1e-8, DWELL_S + 0.5e-9])
def test_the_dwell_is_as_long_as_was_asked_for(asked: float) -> None:
    problem = replace(PROBLEM, options=replace(PROBLEM.options, dwell_s=asked))
    found = residuals(motion(), problem=problem)
    late = abs(asked - DWELL_S) > 1e-9
    assert failures(found) == ({"dwell_s"} if late else set())
    assert found["dwell_s"].value == pytest.approx(abs(asked - DWELL_S), abs=1e-15)


def test_the_arm_stands_still_meanwhile() -> None:
    """In a row between as well, which is no end of anything."""
    times = np.insert(TIMES, 31, 5.5)
    joints = np.insert(JOINTS, 31, THINNING, axis=0)
    assert failures(residuals(motion(joints, times))) == set()
    joints[31, 3] += 2e-9
    found = residuals(motion(joints, times))
    assert failures(found) == {"dwell_moves_rad"}
    assert found["dwell_moves_rad"].value == pytest.approx(2e-9, rel=1e-6)


@pytest.mark.parametrize("name", ["cut_in", "retreat"])
def test_how_straight_a_segment_is_and_is_said_to_be(name: str) -> None:
    found = residuals(motion(), claimed_m=0.0)
    place, direction = line()
    rows = JOINTS[ROWS[name]]
    (deviation,) = line_distances(PROBLEM, rows[None], place[None], direction[None])
    assert deviation > 1e-6
    assert found[f"{name}_deviation_m"].value == pytest.approx(deviation)
    assert found[f"{name}_deviation_claim_m"].value == pytest.approx(deviation)
    assert failures(found) == {"cut_in_deviation_claim_m", "retreat_deviation_claim_m"}
    claimed = residuals(motion(), claimed_m=0.75 * float(deviation))
    assert claimed[f"{name}_deviation_claim_m"].value == pytest.approx(0.25 * deviation)
    crooked = motion(bent(25 if name == "cut_in" else 36, 1, 0.01))
    told = failures(residuals(crooked))
    assert f"{name}_deviation_m" in told
    other = "retreat" if name == "cut_in" else "cut_in"
    assert f"{other}_deviation_m" not in told


@pytest.mark.parametrize("segment", SEGMENTS)
def test_a_segment_without_rows_ends_the_judgement(segment: str) -> None:
    k = SEGMENTS.index(segment)
    start = NAMED[k].start_s + 0.001
    named = list(NAMED)
    named[k] = Segment(segment, start, start + 0.001)
    moved = replace(motion(), trajectory=replace(TRAJECTORY, segments=tuple(named)))
    found = residuals(moved)
    assert list(found)[-1] == f"{segment}_rows"
    assert found[f"{segment}_rows"] == Residual(f"{segment}_rows", 1.0, 0.0)
    assert len(found) == 3 * k + 1


def test_rows_of_neighbouring_segments_are_one() -> None:
    times, rows = segment_rows(TRAJECTORY, "cut_in", "dwell")
    assert times.tolist() == TIMES[20:32].tolist()
    assert rows.tolist() == JOINTS[20:32].tolist()
    for name, own in ROWS.items():
        times, rows = segment_rows(TRAJECTORY, name)
        assert times.tolist() == TIMES[own].tolist()
        assert rows.tolist() == JOINTS[own].tolist()


def shapes(trajectory: Trajectory, corners: Any = CORNERS) -> dict[str, float]:
    found = list(shape_residuals(trajectory, transfer(corners), 6))
    assert [one.allowed for one in found] == [0.0] * 3
    return {one.name: one.value for one in found}


GOOD = {"trajectory_shape": 0.0, "transfer_shape": 0.0, "trajectory_times": 0.0}


def test_shapes_of_a_motion_made_by_hand() -> None:
    assert shapes(TRAJECTORY) == GOOD


@pytest.mark.parametrize(
    "joints",
    [JOINTS[:-1], JOINTS[:, :5], JOINTS.ravel(), np.where(JOINTS[3] == JOINTS, np.nan, JOINTS),
     np.where(JOINTS[-1] == JOINTS, np.inf, JOINTS)],
)  # fmt: skip
def test_rows_of_another_shape_or_without_numbers_are_told(joints: np.ndarray) -> None:
    assert shapes(replace(TRAJECTORY, joints=joints)) == GOOD | {"trajectory_shape": 1.0}


@pytest.mark.parametrize("corners", [CORNERS[:, :5], CORNERS[0], np.full((2, 6), np.nan)])
def test_corners_of_another_shape_or_without_numbers_are_told(corners: np.ndarray) -> None:
    assert shapes(TRAJECTORY, corners) == GOOD | {"transfer_shape": 1.0}


Spoil = Callable[[Trajectory], Trajectory]


def with_segments(*segments: Segment) -> Spoil:
    return lambda good: replace(good, segments=segments)


def with_times(change: Callable[[np.ndarray], np.ndarray]) -> Spoil:
    return lambda good: replace(good, times_s=change(good.times_s))


@pytest.mark.parametrize(
    "spoil",
    [
        with_segments(*NAMED[:3]),
        with_segments(NAMED[1], NAMED[0], *NAMED[2:]),
        with_segments(replace(NAMED[0], start_s=0.1), *NAMED[1:]),
        with_segments(NAMED[0], replace(NAMED[1], start_s=4.1), *NAMED[2:]),
        with_segments(NAMED[0], replace(NAMED[1], start_s=3.9), *NAMED[2:]),
        with_segments(*NAMED[:3], replace(NAMED[3], end_s=7.9)),
        with_segments(*NAMED[:3], replace(NAMED[3], end_s=8.1)),
        with_segments(),
        with_times(lambda times: times + 0.1),
        with_times(lambda times: np.where(np.arange(len(times)) == 3, times[2], times)),
        with_times(lambda times: np.where(np.arange(len(times)) == 3, times[1], times)),
    ],
)
def test_segments_cover_the_times_without_a_gap(spoil: Spoil) -> None:
    assert shapes(spoil(TRAJECTORY)) == GOOD | {"trajectory_times": 1.0}


@pytest.mark.parametrize("count", [0, 1])
def test_a_motion_of_no_or_one_row_is_none(count: int) -> None:
    nothing = tuple(Segment(name, 0.0, 0.0) for name in SEGMENTS)
    for named in (NAMED, nothing):
        short = Trajectory(TIMES[:count], JOINTS[:count], named)
        assert shapes(short)["trajectory_times"] == 1.0
