"""Rows of a cut-in, how straight the motion through them is, and what rates leave."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from solver import load_robot
from solver.approach.cut_in.cut_in import (
    build_cut_in,
    line_deviation,
    line_deviations,
    many_retreat_rows,
    rate_room,
    refined_rows,
    retreat_rows,
)
from solver.approach.cut_in.tolerances import DEVIATION_SAMPLES
from solver.kinematics.chain_rates import rates_behind
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.kinematics.straight_rates import posture_rate_room
from solver.methods.candidates import at_angle
from solver.tolerances import JOINT_RATE_RAD_M, LEAST_REFINED_ROWS
from tests.solver.kinematics.arms import ur5
from tests.solver.methods.synthetic import ROBOT, small_task

TASK = small_task(2)
TOOL = TASK.tool
RETREATS = np.array([0.04, 0.02, 0.01, 0.0])
THINNING = np.asarray(TASK.thinning_joints(0.2, 1, 2))
ROWS = retreat_rows(ROBOT, TOOL, THINNING, 2, RETREATS)
POSE = forward_kinematics(ROBOT, TOOL, THINNING)
LINE = POSE[:3, 3], POSE[:3, 2]


def test_rows_are_on_the_line_and_many_are_as_one() -> None:
    poses = forward_kinematics(ROBOT, TOOL, ROWS)
    assert poses[:, :3, 3] == pytest.approx(LINE[0] - np.outer(RETREATS, LINE[1]), abs=1e-9)
    assert poses[:, :3, :3] == pytest.approx(np.repeat(POSE[None, :3, :3], 4, axis=0), abs=1e-9)
    other = np.asarray(TASK.thinning_joints(0.35, 1, 2))
    many = many_retreat_rows(ROBOT, TOOL, np.stack((THINNING, other)), np.array([2, 2]), RETREATS)
    assert many[0] == pytest.approx(ROWS, abs=1e-12)
    assert many[1] == pytest.approx(retreat_rows(ROBOT, TOOL, other, 2, RETREATS), abs=1e-12)


def plain_deviation(rows: np.ndarray, line: tuple[np.ndarray, np.ndarray]) -> float:
    """Of the places between rows that are looked at, and the rows."""
    worst = 0.0
    for before, after in itertools.pairwise(rows):
        for share in np.arange(DEVIATION_SAMPLES + 2) / (DEVIATION_SAMPLES + 1):
            place = forward_kinematics(ROBOT, TOOL, before + share * (after - before))[:3, 3]
            off = place - line[0]
            worst = max(worst, float(np.linalg.norm(off - (off @ line[1]) * line[1])))
    return worst


def test_the_motion_s_largest_distance_from_the_line() -> None:
    found = line_deviation(ROBOT, TOOL, ROWS, *LINE)
    assert found == pytest.approx(plain_deviation(ROWS, LINE), rel=1e-9)
    assert 1e-6 < found < 1e-2
    beside = LINE[0] + np.array([0.0, 0.0, 0.01]), LINE[1]
    several = line_deviations(
        ROBOT, TOOL, np.stack((ROWS, ROWS[::-1])), np.stack((LINE[0], beside[0])),
        np.stack((LINE[1], LINE[1])),
    )  # fmt: skip
    assert several == pytest.approx([found, plain_deviation(ROWS, beside)])
    bent = ROWS.copy()
    bent[-1, 1] += 0.1
    assert line_deviation(ROBOT, TOOL, bent, *LINE) == pytest.approx(
        plain_deviation(bent, LINE), rel=1e-9
    )


@pytest.mark.parametrize("points", [2, 9, 40])
@pytest.mark.parametrize("straightness", [1e-2, 1e-4, 2e-6])
def test_rows_are_doubled_until_they_are_straight(points: int, straightness: float) -> None:
    options = replace(TASK.options, path_points=points, straightness_m=straightness)
    path = retreat_rows(ROBOT, TOOL, THINNING, 2, np.linspace(0.04, 0.0, points))
    rows, deviation = refined_rows(ROBOT, TOOL, options, path, 2, LINE)
    assert deviation <= straightness
    assert deviation == line_deviation(ROBOT, TOOL, rows, *LINE)
    counts = [max(points, LEAST_REFINED_ROWS)]
    while counts[-1] < len(rows):
        counts.append(2 * counts[-1] - 1)
    assert len(rows) == counts[-1]
    if len(counts) > 1:
        before = retreat_rows(ROBOT, TOOL, THINNING, 2, np.linspace(0.04, 0.0, counts[-2]))
        assert line_deviation(ROBOT, TOOL, before, *LINE) > straightness
    if points >= LEAST_REFINED_ROWS and len(counts) == 1:
        assert rows is path


@pytest.mark.parametrize("timed", [True, False])
def test_a_cut_in_has_the_rows_asked_for_and_a_motion_where_that_is(timed: bool) -> None:
    include = ("path", "trajectory") if timed else ("path",)
    task = replace(TASK, options=replace(TASK.options, path_points=7, include=include))
    candidate = at_angle(task, 0.2, 1, 2, tuple(THINNING))
    made = build_cut_in(task, candidate)
    expected = retreat_rows(ROBOT, TOOL, THINNING, 2, np.linspace(0.04, 0.0, 7))
    assert made.path_joints == pytest.approx(expected, abs=1e-12)
    assert made.deviation_m <= task.options.straightness_m
    assert made.deviation_m == pytest.approx(line_deviation(ROBOT, TOOL, made.rows, *LINE))
    assert (made.motion is not None) == timed
    assert made.rows[0] == pytest.approx(expected[0], abs=1e-9)
    assert made.rows[-1] == pytest.approx(THINNING, abs=1e-9)
    if made.motion is not None:
        assert made.motion.joints is made.rows or made.motion.joints.shape == made.rows.shape


def test_what_joints_are_short_of_the_highest_rate() -> None:
    geometry = wrist_geometry(ROBOT, TOOL)
    expected = [posture_rate_room(geometry, q) for q in ROWS]
    assert rate_room(ROBOT, TOOL, 2, ROWS) == pytest.approx(expected)
    rail = load_robot("puma560_rail")
    rows = np.asarray(rail.home_joints) + 0.1 * np.arange(3)[:, None]
    arm = wrist_geometry(replace(rail, joints=rail.joints[1:]), rail.tools[0])
    found = rate_room(rail, rail.tools[0], 0, rows)
    assert found == pytest.approx([posture_rate_room(arm, q[1:]) for q in rows])
    other = ur5()
    rows = np.asarray(other.home_joints) + 0.3 * np.arange(1, 3)[:, None]
    fastest = (rates_behind(other, other.tools[0], rows) * other.turning).max(axis=1)
    found = rate_room(other, other.tools[0], None, rows)
    assert found == pytest.approx(1 - fastest / JOINT_RATE_RAD_M)
