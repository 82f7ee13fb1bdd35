"""Turns of joints and their margins, against postures of the closed form one by one."""

import itertools
import math
from collections.abc import Iterator

import numpy as np
import pytest

from solver import Options, Problem, Robot, Target
from solver.approach.arcs.turns import (
    CONSTRAINTS,
    JOINT_OF_ROW,
    ROW_CONSTRAINTS,
    TURN_ROWS,
    joints_of_turns,
    jump_margin,
    passes_behind,
    path_columns,
    path_margins,
    reaches_at_angles,
    row_constraints,
    row_margin,
    turn_cosine,
    turns_along_path,
    turns_at_angles,
    write_turns,
)
from solver.approach.task.constraints import BESIDE, JUMP, REACH
from solver.approach.task.feasibility import posture, tool_axes
from solver.approach.task.packed import COS_HALF, COS_MIDDLE, SIN_MIDDLE
from solver.approach.task.task import ApproachTask, approach_task
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.kinematics.straight_rates import between_rate_room, posture_rate_room
from solver.robots.model import Array
from tests.solver.interpreted import interpreted
from tests.solver.kinematics.arms import arms
from tests.solver.methods.synthetic import small_task

ASKEW = arms()[7]


def askew_task() -> ApproachTask:
    """Of an arm with offsets and twists of both signs."""
    target = Target("1", (0.2, 0.1, 0.35), (0.3, 1.0, -0.2))
    problem = Problem(ASKEW, [target], options=Options(symmetric_tool=True))
    return approach_task(problem, target, problem.start)


TASKS = {"tabletop": small_task(2, symmetric_tool=True), "askew": askew_task()}
ANGLES = np.array([-2.5, -0.4, 0.1, 0.2, 0.9, 3.0])


@pytest.fixture(params=TASKS)
def task(request: pytest.FixtureRequest) -> ApproachTask:
    return TASKS[request.param]


def rows_of(task: ApproachTask, side: int, angle: float, branch: int) -> tuple[Array, Array]:
    """Postures as the closed form writes them, and both reach margins."""
    kernels, axes = task.for_kernels(side), np.empty((3, 3))
    tool_axes(kernels, angle, axes)
    rows = np.empty((len(task.retreats_m), 6))
    reach = [
        posture(kernels, axes, r, branch, q) for r, q in zip(task.retreats_m, rows, strict=True)
    ]
    return rows, np.array(reach)


def cases(task: ApproachTask) -> Iterator[tuple[int, float, int]]:
    return itertools.product(task.tool_sides, ANGLES.tolist(), range(8))


def turns_of(task: ApproachTask, side: int, angle: float, arm: int) -> Array:
    turns = np.full((TURN_ROWS, path_columns_of(task)), np.nan)
    turns_along_path(task.packed(side), angle, arm, turns)
    return turns


def path_columns_of(task: ApproachTask) -> int:
    return int(interpreted(path_columns)(len(task.retreats_m)))


@pytest.mark.parametrize(("rows", "columns"), [(2, 24), (24, 24), (25, 32), (32, 32), (33, 40)])
def test_columns_are_a_multiple_of_a_vector_s_and_enough(rows: int, columns: int) -> None:
    assert interpreted(path_columns)(rows) == columns


def test_turns_are_those_of_the_closed_form(task: ApproachTask) -> None:
    count = len(task.retreats_m)
    for side, angle, branch in cases(task):
        rows, reach = rows_of(task, side, angle, branch)
        turns = turns_of(task, side, angle, branch // 2)
        joints = np.empty((6, count))
        joints_of_turns(task.packed(side), turns, count, branch % 2, joints)
        apart = np.remainder(joints.T - rows + np.pi, 2 * np.pi) - np.pi
        assert apart == pytest.approx(np.zeros_like(rows), abs=1e-7)
        assert np.all(np.abs(joints.T - (task.robot.lower + task.robot.upper) / 2) <= np.pi + 1e-9)
        least = np.minimum(turns[6 + REACH], turns[6 + BESIDE])
        assert least[:count] == pytest.approx(reach, abs=1e-12)
        assert turns[0] ** 2 + turns[1] ** 2 == pytest.approx(np.ones(turns.shape[1]))
        # What is beyond the rows is the thinning posture again.
        beyond = np.repeat(turns[:14, count - 1 : count], turns.shape[1] - count, axis=1)
        assert turns[:14, count:] == pytest.approx(beyond)


def test_turns_of_several_angles_and_of_a_path_are_the_same(task: ApproachTask) -> None:
    packed, retreat = task.packed(1), task.retreats_m[3]
    for arm in range(4):
        turns = np.full((TURN_ROWS, 8), np.nan)
        turns_at_angles(packed, ANGLES, 6, retreat, arm, turns)
        assert np.isnan(turns[:, 6:]).all()
        for n, angle in enumerate(ANGLES):
            along = turns_of(task, 1, angle, arm)
            assert turns[:14, n] == pytest.approx(along[:14, 3])
        given = np.full((TURN_ROWS, 3), np.nan)
        given[0, :2], given[1, :2] = np.cos(ANGLES[:2]), np.sin(ANGLES[:2])
        given[2, :2] = retreat
        write_turns(packed, 2, arm, given)
        assert given[:14, :2] == pytest.approx(turns[:14, :2])
        assert np.isnan(given[:, 2]).all()


def test_reaches_at_thinning_are_those_of_both_elbows(task: ApproachTask) -> None:
    values = np.empty((2, len(ANGLES)))
    for shoulder in range(2):
        reaches_at_angles(task.packed(1), np.cos(ANGLES), np.sin(ANGLES), shoulder, values)
        for n, angle in enumerate(ANGLES):
            for elbow in range(2):
                last = turns_of(task, 1, angle, 2 * shoulder + elbow)[:, -1]
                assert values[:, n] == pytest.approx(last[[6 + REACH, 6 + BESIDE]])


def plain_margins(task: ApproachTask, side: int, joints: Array) -> Array:
    """Cosine of how far each joint is from the middle of its limits, less that of half of them."""
    middle, half = (task.lower + task.upper) / 2, (task.upper - task.lower) / 2
    return np.asarray(np.cos(joints - middle) - np.where(half < np.pi, np.cos(half), -2.0))


def test_a_margin_is_not_negative_where_a_joint_is_inside(task: ApproachTask) -> None:
    for side, angle, branch in cases(task):
        rows, _ = rows_of(task, side, angle, branch)
        turns, packed = turns_of(task, side, angle, branch // 2), task.packed(side)
        expected = plain_margins(task, side, rows)
        least = np.empty(CONSTRAINTS)
        path_margins(packed, turns, branch % 2, least)
        for i in range(6):
            margins = [row_margin(packed, turns, n, branch % 2, i) for n in range(len(rows))]
            assert margins == pytest.approx(expected[:, i], abs=1e-7)
            assert least[i] == pytest.approx(min(margins), abs=1e-12)
        for i in (REACH, BESIDE):
            assert row_margin(packed, turns, 4, branch % 2, i) == turns[6 + i, 4]
            assert least[i] == turns[6 + i].min()
        assert least[JUMP] == jump_margin(packed, turns, branch % 2)


def test_constraints_of_a_row_stand_in_their_order(task: ApproachTask) -> None:
    packed, values = task.packed(1), np.empty((ROW_CONSTRAINTS, 6))
    for arm in range(4):
        turns = np.empty((TURN_ROWS, 8))
        turns_at_angles(packed, ANGLES, 6, 0.01, arm, turns)
        row_constraints(packed, turns, 6, values)
        assert values[:2].tolist() == turns[12:14, :6].tolist()
        wrists = [0] * 8 + [1] * 3
        for row in range(2, ROW_CONSTRAINTS):
            for n in range(6):
                margin = row_margin(packed, turns, n, wrists[row], JOINT_OF_ROW[row])
                assert values[row, n] == pytest.approx(margin, abs=1e-14)


def feasible(task: ApproachTask) -> list[tuple[int, float, int]]:
    found = []
    for side, angle, branch in itertools.product(task.tool_sides, np.arange(-3, 3, 0.1), range(8)):
        _, reach = rows_of(task, side, float(angle), branch)
        if reach.min() > 0.0:
            found.append((side, float(angle), branch))
    return found


def test_the_jump_is_the_least_room_of_rates_in_rows_and_between(task: ApproachTask) -> None:
    geometry = wrist_geometry(task.robot, task.tool)
    seen = set()
    for side, angle, branch in feasible(task)[::5]:
        rows, _ = rows_of(task, side, angle, branch)
        steps = -np.diff(task.retreats_m)
        room = min(posture_rate_room(geometry, q) for q in rows)
        between = [
            between_rate_room(geometry, before, after, step)
            for before, after, step in zip(rows, rows[1:], steps, strict=False)
        ]
        turns = turns_of(task, side, angle, branch // 2)
        found = jump_margin(task.packed(side), turns, branch % 2)
        expected = min(room, *between)
        assert found == pytest.approx(expected, abs=1e-7) or found == -1.0
        seen.add(bool(expected >= 0.0))
    assert True in seen
    assert False in seen or task is TASKS["askew"]


@pytest.mark.parametrize("wrist", [0, 1])
@pytest.mark.parametrize("row", [0, 7, 14])
@pytest.mark.parametrize("swing", [2.9, -3.0])
def test_a_joint_that_swings_between_two_rows_has_jumped(
    task: ApproachTask, wrist: int, row: int, swing: float
) -> None:
    """Slow in both rows: joints 4 and 6 beside a straight wrist, joint 1 at the waist's axis."""
    geometry = wrist_geometry(task.robot, task.tool)
    side, angle, branch = feasible(task)[10]
    for joint in (0, 3, 5):
        turns = turns_of(task, side, angle, branch // 2)
        turns[:14] = turns[:14, 15:16]
        cos, sin = math.cos(swing), math.sin(swing)
        c, s = turns[2 * joint].copy(), turns[2 * joint + 1].copy()
        turns[2 * joint, : row + 1] = (cos * c - sin * s)[: row + 1]
        turns[2 * joint + 1, : row + 1] = (sin * c + cos * s)[: row + 1]
        joints, count = np.empty((6, 16)), len(task.retreats_m)
        joints_of_turns(task.packed(side), turns, count, wrist, joints)
        rows, steps = joints.T, -np.diff(task.retreats_m)
        between = between_rate_room(geometry, rows[row], rows[row + 1], steps[row])
        least = min(between, *(posture_rate_room(geometry, q) for q in rows))
        found = jump_margin(task.packed(side), turns, wrist)
        assert found == pytest.approx(least, abs=1e-9) or found == -1.0
        assert between < 0.0


def two_columns(task: ApproachTask, i: int, wrist: int, left: float, right: float) -> Array:
    """Turns in which one joint is so far from the middle of its limits."""
    sign_cos = -1.0 if wrist and i in (3, 5) else 1.0
    sign_sin = -1.0 if wrist and i in (3, 4, 5) else 1.0
    numbers = task.packed(1).numbers
    middle = math.atan2(numbers[SIN_MIDDLE + i], numbers[COS_MIDDLE + i])
    turns = np.zeros((TURN_ROWS, 2))
    for n, off in enumerate((left, right)):
        turns[2 * i, n] = sign_cos * math.cos(middle + off)
        turns[2 * i + 1, n] = sign_sin * math.sin(middle + off)
    return turns


@pytest.mark.parametrize("wrist", [0, 1])
@pytest.mark.parametrize("i", range(6))
@pytest.mark.parametrize(
    ("left", "right", "passes"),
    [
        (3.0, -3.0, True),
        (-2.0, 2.5, True),
        (2.0, 3.0, False),
        (0.5, -0.5, False),
        (1.5, -1.6, False),
    ],
)
def test_a_joint_passes_behind_what_it_may_not_reach(
    i: int, wrist: int, left: float, right: float, passes: bool
) -> None:
    """On both sides of the back and in the back half: the short way leads through it."""
    task = TASKS["askew"]
    turns = two_columns(task, i, wrist, left, right)
    packed = task.packed(1)
    assert passes_behind(packed, turns, 0, turns, 1, wrist, i) == passes
    assert passes_behind(packed, turns, 1, turns, 0, wrist, i) == passes
    free = packed.numbers.copy()
    free[COS_HALF + i] = -1.0
    assert not passes_behind(packed._replace(numbers=free), turns, 0, turns, 1, wrist, i)
    nearly = packed.numbers.copy()
    nearly[COS_HALF + i] = -0.999
    assert passes_behind(packed._replace(numbers=nearly), turns, 0, turns, 1, wrist, i) == passes


def test_a_jump_of_a_joint_that_all_but_turns_round_is_one() -> None:
    """Its limits leave out the back, and it is on both sides of that from row to row."""
    task = TASKS["tabletop"]
    side, angle, branch = feasible(task)[40]
    turns, packed = turns_of(task, side, angle, branch // 2), task.packed(side)
    before = jump_margin(packed, turns, branch % 2)
    joint = two_columns(task, 5, branch % 2, 3.1, -3.1)
    turns[10:12, :2] = joint[10:12]
    # Slow enough otherwise: neither row's own rates depend on the last joint's turn.
    numbers = packed.numbers.copy()
    assert before > -1.0
    for half, step, jumps in ((-0.99, -2.0, True), (-0.99, 0.95, True), (-0.99, 0.97, False),
                              (0.1, -2.0, False)):  # fmt: skip
        numbers[COS_HALF + 5] = half
        steps = np.full_like(packed.cos_steps, step)
        found = jump_margin(packed._replace(numbers=numbers, cos_steps=steps), turns, branch % 2)
        assert (found <= -1.0) == jumps


def test_the_farthest_turn_of_any_joint_in_any_row(task: ApproachTask) -> None:
    left, right = turns_of(task, 1, 0.1, 1), turns_of(task, 1, 0.25, 1)
    for rows in (1, 3, len(task.retreats_m)):
        apart = [
            left[2 * i, n] * right[2 * i, n] + left[2 * i + 1, n] * right[2 * i + 1, n]
            for i in range(6)
            for n in range(rows)
        ]
        assert turn_cosine(left, right, rows) == pytest.approx(min(apart), abs=1e-14)
    assert turn_cosine(left, left, 3) == pytest.approx(1.0)


def test_a_robot_s_margin_is_kept_from_its_limits(tabletop: Robot) -> None:
    wide = small_task(2, limit_margin_rad=0.2)
    assert np.all(wide.lower > tabletop.lower + 0.1)
    rows, _ = rows_of(wide, 1, 0.2, 2)
    turns = turns_of(wide, 1, 0.2, 1)
    margins = [row_margin(wide.packed(1), turns, 0, 0, i) for i in range(6)]
    assert margins == pytest.approx(plain_margins(wide, 1, rows[0]), abs=1e-9)
