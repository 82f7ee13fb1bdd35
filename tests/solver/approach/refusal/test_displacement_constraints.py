"""What a displaced target has to meet: values by hand, gradients by differences."""

import math
from typing import Any

import numpy as np
import pytest

from solver.approach.refusal.displacement_constraints import (
    Watched,
    calm_reach,
    constraints,
    copy_at,
    posture_with_rates,
    rate_constraint,
    rate_room_at,
    row_constraints,
    scratch_arrays,
)
from solver.approach.task.constraints import LIMITS, REACH
from solver.approach.task.feasibility import CutInTask, posture, tool_axes
from solver.approach.uncertainty.sensitivity import joint_rates
from solver.kinematics.straight_rates import between_rate_room, posture_rate_room
from solver.tolerances import JOINT_RATE_RAD_M
from tests.solver.methods.synthetic import small_task

TASKS = {1: small_task(2, symmetric_tool=True).for_kernels(1),
         -1: small_task(2, symmetric_tool=True).for_kernels(-1)}  # fmt: skip
TASK = TASKS[1]
TURN = np.cross(TASK.outward, TASK.sideways)
SCALE = (TASK.geometry.a2 + TASK.geometry.l3) / 2
X = np.array([0.003, -0.002, 0.004, 0.25])
BRANCH = 2


def watched(rows: tuple[int, ...] = (15, 0), jumps: tuple[int, ...] = (), **more: float) -> Watched:
    given = {"spread": 0.0, "inside": 0.0, "bent": 0.0} | more
    return Watched(np.array([*rows, 0, 0]), len(rows), np.array([*jumps, 0]), len(jumps), **given)


def evaluated(x: np.ndarray, of: Watched, branch: int = BRANCH, task: CutInTask = TASK) -> Any:
    moved, count = copy_at(task, task.position.copy()), LIMITS * of.rows_count + of.jumps_count
    values, gradients = np.full(count, np.nan), np.full((count, 4), np.nan)
    constraints(moved, task.position, x, TURN, branch, of, scratch_arrays(), values, gradients)
    assert moved.position == pytest.approx(task.position + x[:3])
    return values, gradients


def plain(x: np.ndarray, retreat: float, branch: int = BRANCH, task: CutInTask = TASK) -> Any:
    there, axes, q = copy_at(task, task.position + x[:3]), np.empty((3, 3)), np.empty(6)
    tool_axes(there, x[3], axes)
    return posture(there, axes, retreat, branch, q), q


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("branch", range(8))
def test_postures_and_rates_in_one(side: int, branch: int) -> None:
    """As the closed form and its derivatives tell them one by one."""
    task = TASKS[side]
    axes, q, alone = np.empty((3, 3)), np.empty(6), np.empty(6)
    for angle, retreat in ((0.2, 0.0), (0.2, 0.04), (-0.6, 0.02), (2.0, 0.0)):
        tool_axes(task, angle, axes)
        rates, reach_rates = np.empty((6, 4)), np.empty(4)
        reach = posture_with_rates(task, axes, retreat, TURN, branch, q, rates, reach_rates)
        assert reach == pytest.approx(posture(task, axes, retreat, branch, alone), abs=1e-12)
        turned = np.remainder(q - alone + np.pi, 2 * np.pi) - np.pi
        assert turned == pytest.approx(np.zeros(6), abs=1e-9)
        if reach < 0.0:
            continue
        lever = retreat + task.geometry.tool_length
        expected, expected_reach = np.empty((6, 4)), np.empty(4)
        joint_rates(task.geometry, q, axes, lever, TURN, expected, expected_reach)
        assert rates == pytest.approx(expected, rel=1e-6, abs=1e-6)
        assert reach_rates == pytest.approx(expected_reach, abs=1e-9)


def test_values_are_rooms_as_lengths_less_a_hair() -> None:
    """Half the arm's length times the angle; 1e-4 rad inside."""
    values, _ = evaluated(X, watched(inside=0.002))
    for w, retreat in enumerate((0.0, 0.04)):
        reach, q = plain(X, retreat)
        own = values[LIMITS * w : LIMITS * (w + 1)]
        assert own[:12:2] == pytest.approx(SCALE * (q - TASK.lower - 1e-4))
        assert own[1:12:2] == pytest.approx(SCALE * (TASK.upper - q - 1e-4))
        assert own[2 * REACH] == pytest.approx(reach - 0.002)


@pytest.mark.parametrize("rows", [(15, 0), (15, 7, 3)])
@pytest.mark.parametrize("jumps", [(), (4, 15)])
def test_gradients_are_differences(rows: tuple[int, ...], jumps: tuple[int, ...]) -> None:
    of = watched(rows, jumps)
    values, gradients = evaluated(X, of)
    assert np.isfinite(values).all()
    for k in range(4):
        step = np.zeros(4)
        step[k] = 1e-6
        change = evaluated(X + step, of)[0] - evaluated(X - step, of)[0]
        exact = LIMITS * len(rows)
        assert gradients[:exact, k] == pytest.approx(change[:exact] / 2e-6, abs=1e-6, rel=1e-5)
        assert gradients[exact:, k] == pytest.approx(change[exact:] / 2e-6, abs=1e-3, rel=1e-3)


def test_what_every_limit_has_to_bear_is_taken_along_its_slope() -> None:
    spread = 0.002
    values, _ = evaluated(X, watched(spread=spread))
    bare, gradients = evaluated(X, watched())
    slopes = np.linalg.norm(gradients[:, :3], axis=1)
    joints = [i for i in range(26) if i % 13 != 12 and i % 13 not in (8, 9)]
    assert values[joints] == pytest.approx(bare[joints] - spread * slopes[joints])
    assert values[[12, 25]] == pytest.approx(bare[[12, 25]] - spread)


@pytest.mark.parametrize(("spread", "bent"), [(0.002, 0.0), (0.0, 0.05), (0.002, 0.05)])
def test_the_wrist_is_kept_from_straight_where_that_is_asked_for(
    spread: float, bent: float
) -> None:
    values, _ = evaluated(X, watched(spread=spread, bent=bent))
    _, gradients = evaluated(X, watched())
    _, q = plain(X, 0.0)
    slope = spread * np.linalg.norm(gradients[8, :3])
    offset = TASK.geometry.offsets[4]
    below = math.pi * math.floor((q[4] + offset) / math.pi) - offset
    low = max(TASK.lower[4], below + bent)
    high = min(TASK.upper[4], below + math.pi - bent)
    assert values[8] == pytest.approx(SCALE * (q[4] - low - 1e-4) - slope)
    assert values[9] == pytest.approx(SCALE * (high - q[4] - 1e-4) - slope)


def test_out_of_reach_slopes_of_joints_are_held() -> None:
    """At ten half arm's lengths a metre; the reach's own are as they are."""
    far = np.array([0.25, 0.1, 0.3, 0.25])
    values, gradients = evaluated(far, watched())
    assert values[2 * REACH] < 0.0
    slopes = np.linalg.norm(gradients[:12, :3], axis=1)
    assert slopes.max() <= 10.0 + 1e-9
    axes, rates = np.empty((3, 3)), np.empty((6, 4))
    there = copy_at(TASK, TASK.position + far[:3])
    tool_axes(there, far[3], axes)
    posture_with_rates(there, axes, 0.0, TURN, BRANCH, np.empty(6), rates, np.empty(4))
    for i in range(6):
        slope = float(np.linalg.norm(rates[i, :3]))
        held = SCALE * min(1.0, 10.0 / (slope * SCALE))
        assert gradients[2 * i] == pytest.approx(held * rates[i])
        assert gradients[2 * i + 1] == pytest.approx(-held * rates[i])


def test_rows_behind_are_on_the_turn_of_the_one_at_the_target() -> None:
    scratch, values = scratch_arrays(), np.empty(LIMITS)
    tool_axes(TASK, 0.2, scratch.axes)
    gradients = np.empty((LIMITS, 4))
    row_constraints(TASK, TURN, 0.0, BRANCH, watched(), scratch, values, gradients)
    assert scratch.near == pytest.approx(plain(np.array([0, 0, 0, 0.2]), 0.0)[1])
    before = scratch.near.copy()
    scratch.near[5] += 2 * math.pi
    row_constraints(TASK, TURN, 0.04, BRANCH, watched(), scratch, values, gradients)
    assert scratch.q[5] - before[5] == pytest.approx(2 * math.pi, abs=1.0)
    assert scratch.near[5] == before[5] + 2 * math.pi


@pytest.mark.parametrize("row", [0, 6, 15])
def test_rates_have_room_in_a_row_and_on_to_the_next(row: int) -> None:
    scratch, moved = scratch_arrays(), copy_at(TASK, TASK.position.copy())
    room = rate_room_at(moved, TASK.position, X, 0, 0.0, row, BRANCH, scratch)
    geometry, retreats = TASK.geometry, TASK.retreats
    _, here = plain(X, retreats[row])
    expected = posture_rate_room(geometry, here)
    if row < 15:
        _, ahead = plain(X, retreats[row + 1])
        swing = between_rate_room(geometry, here, ahead, retreats[row] - retreats[row + 1])
        expected = min(expected, swing, posture_rate_room(geometry, ahead))
    assert room == pytest.approx(expected)
    gradient = np.full(4, np.nan)
    value = rate_constraint(moved, TASK.position, X, row, BRANCH, scratch, gradient)
    assert value == pytest.approx(SCALE * (expected - 1e-3))
    for k in range(4):
        step = np.zeros(4)
        step[k] = 1e-6
        other = rate_room_at(moved, TASK.position, X + step, 0, 0.0, row, BRANCH, scratch)
        assert gradient[k] == pytest.approx(SCALE * (other - room) / 1e-6, abs=1e-6)
        same = rate_room_at(moved, TASK.position, X, k, 1e-6, row, BRANCH, scratch)
        assert same == pytest.approx(other, abs=1e-12)


def test_out_of_reach_there_is_less_room_by_as_much() -> None:
    far = np.array([0.25, 0.1, 0.3, 0.25])
    scratch, moved = scratch_arrays(), copy_at(TASK, TASK.position.copy())
    reach, q = plain(far, TASK.retreats[-1])
    assert reach < 0.0
    room = rate_room_at(moved, TASK.position, far, 0, 0.0, 15, BRANCH, scratch)
    expected = posture_rate_room(TASK.geometry, q) + reach / (2 * SCALE)
    assert room == pytest.approx(expected)


def test_a_copy_has_a_target_of_its_own() -> None:
    position = np.array([1.0, 2.0, 3.0])
    copied = copy_at(TASK, position)
    assert copied.position is position or copied.position.tolist() == position.tolist()
    for name, value in TASK._asdict().items():
        if name != "position":
            assert repr(getattr(copied, name)) == repr(value), name


def test_how_far_inside_the_reach_no_elbow_is_too_fast() -> None:
    g = TASK.geometry
    expected = (1 / g.a2 + 1 / g.l3) / JOINT_RATE_RAD_M**2 / 2
    assert calm_reach(g) == pytest.approx(expected)
    mirrored = g._replace(a2=-g.a2)
    assert calm_reach(mirrored) == pytest.approx(expected)
