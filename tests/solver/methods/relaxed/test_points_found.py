"""What is told of a point, and what is done with one, on a task of data set 3."""

import numpy as np
import pytest

from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.relaxation import Placement, rotation
from solver.kinematics.forward import forward_kinematics
from solver.methods.relaxed import points
from solver.methods.relaxed.points import (
    Point,
    angle_in,
    descended,
    fixed_task,
    optima_at,
    optimum_at,
)
from solver.problem.effort import posture_effort
from tests.solver.methods.synthetic import small_task

RELAXED = {"strike_zone_m": 0.02, "tilt_tolerance_rad": 0.2}


def point(level_m: float, effort: float) -> Point:
    return Point(Placement(0.0, 0.0, np.zeros(3)), 1, 2, effort, level_m, np.zeros((2, 6)))


def test_the_best_bears_most_and_then_costs_least() -> None:
    ranked = [point(0.002, 3.0), point(0.002, 4.0), point(0.001, 1.0), point(0.0, 0.5)]
    assert sorted(ranked[::-1], key=lambda one: one.rank) == ranked
    assert ranked[0].rank == (-0.002, 3.0)


@pytest.mark.parametrize("norm", ["l1", "l2"])
@pytest.mark.parametrize("symmetric", [False, True])
def test_a_point_tells_its_posture_and_where_it_stands(norm: str, symmetric: bool) -> None:
    task = small_task(1, norm=norm, symmetric_tool=symmetric, **RELAXED)
    frame, strikes = task.frame, np.array([0.0, 0.01, 0.005])
    swings = np.array([[0.0, 0.0], [0.1, 0.0], [0.02, -0.05]]) @ (frame.outward, frame.sideways)
    found = optima_at(task, strikes, swings)
    assert len(found) == 3
    for one, strike, swing in zip(found, strikes, swings, strict=True):
        best = best_on_arcs(fixed_task(task, strike, swing))
        assert best is not None
        assert one.effort == pytest.approx(best.effort, rel=1e-9)
        assert (one.tool_side, one.branch) == (best.arc.tool_side, best.arc.branch)
        assert (one.placement.strike_m, one.level_m) == (strike, 0.0)
        assert one.placement.swing_rad == pytest.approx(swing)
        thinning = one.postures[0]
        cost = posture_effort(thinning, task.reference, task.joint_weights, task.options.norm)
        assert one.effort == pytest.approx(cost, rel=1e-12)
        pose, behind = forward_kinematics(task.robot, task.tool, one.postures)
        axes = rotation(swing) @ frame.axes(one.placement.approach_angle_rad, one.tool_side)
        np.testing.assert_allclose(pose[:3, :3], axes, atol=1e-9)
        place = np.asarray(task.target.position_m) + strike * pose[:3, 2]
        np.testing.assert_allclose(pose[:3, 3], place, atol=1e-9)
        back = pose[:3, 3] - task.options.standoff_m * pose[:3, 2]
        np.testing.assert_allclose(behind[:3, 3], back, atol=1e-9)


def test_points_without_an_approach_are_left_out() -> None:
    task = small_task(0, **RELAXED)
    # A tool that is a metre longer leaves the arm no room.
    found = optima_at(task, np.array([0.0, -1.0, 0.01]), np.zeros((3, 3)))
    assert [one.placement.strike_m for one in found] == [0.0, 0.01]


@pytest.mark.parametrize("margin_m", [0.001, 0.004, 0.05])
def test_a_margin_that_is_wished_for_raises_the_level_first(margin_m: float) -> None:
    plain = small_task(2, **RELAXED)
    wishing = small_task(2, **{**RELAXED, "position_margin_m": margin_m})
    at = np.array([0.0, 0.01]), np.zeros((2, 3))
    for before, after in zip(optima_at(plain, *at), optima_at(wishing, *at), strict=True):
        assert after.level_m in {margin_m / 2**k for k in range(4)} | {0.0}
        assert after.effort >= before.effort - 1e-12
        best = best_on_arcs(fixed_task(wishing, after.placement.strike_m, np.zeros(3)))
        assert best is not None
        assert after.effort == pytest.approx(best.effort, rel=1e-6)
        pose = forward_kinematics(plain.robot, plain.tool, after.postures[0])
        turned = plain.frame.axes(after.placement.approach_angle_rad, after.tool_side)
        np.testing.assert_allclose(pose[:3, :3], turned, atol=1e-9)


def test_strike_and_swing_are_kept_inside_their_zone(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def optima(*arguments: object) -> list[Point]:
        asked.append(arguments[1:])
        return []

    monkeypatch.setattr(points, "optima_at", optima)
    task = small_task(0, **RELAXED)
    for strike, turn in ((-0.01, 0.1), (0.01, 0.4), (0.05, -0.4)):
        assert optimum_at(task, strike, turn * task.frame.sideways) == []
    strikes, swings = zip(*asked, strict=True)
    assert [one.tolist() for one in strikes] == [[0.0], [0.01], [0.02]]
    turns = [one @ task.frame.sideways for one in swings]
    assert np.ravel(turns) == pytest.approx([0.1, 0.2, -0.2])


def test_a_descent_begins_where_it_is_told_and_its_end_is_asked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    task = small_task(0, **RELAXED)
    u, v = task.frame.outward, task.frame.sideways
    told: list[object] = []

    def descend(numbers: object, retreats: object, steps: object, zone: np.ndarray,
                start: np.ndarray, most: int) -> np.ndarray:  # fmt: skip
        told.extend((zone.tolist(), start.tolist(), most))
        return np.array([0.25, -0.5, 0.1])

    monkeypatch.setattr(points, "descend", descend)
    monkeypatch.setattr(points, "optimum_at", lambda _, strike, swing: (strike, swing))
    strike, swing = descended(task, Placement(0.3, 0.005, 0.1 * u - 0.04 * v), 70)
    assert told[0] == [0.02, 0.2]
    assert told[1] == pytest.approx([0.25, 0.5, -0.2])
    assert told[2] == 70
    assert strike == pytest.approx(0.005)
    assert swing == pytest.approx(-0.1 * u + 0.02 * v)
    one_off = small_task(0, strike_zone_m=0.02)
    descended(one_off, Placement(0.3, 0.015, np.zeros(3)), 7)
    assert told[3:] == [[0.02, 0.0], pytest.approx([0.75, 0.0, 0.0]), 7]


@pytest.mark.parametrize("strike", [0.0, 0.013])
@pytest.mark.parametrize("turn", [0.0, 0.15])
def test_a_fixed_task_has_the_branch_turned_and_the_tool_shorter(
    strike: float, turn: float
) -> None:
    task = small_task(0, **RELAXED)
    swing = turn * task.frame.outward
    fixed = fixed_task(task, strike, swing)
    assert fixed.tool.length_m == pytest.approx(task.tool.length_m - strike)
    np.testing.assert_allclose(fixed.frame.branch, rotation(swing) @ task.frame.branch, atol=1e-12)
    assert fixed.target.position_m == task.target.position_m
    for angle in (-2.0, 0.0, 0.7):
        other = angle_in(fixed, task, Placement(angle, strike, swing))
        z = rotation(swing) @ task.frame.direction(angle)
        np.testing.assert_allclose(fixed.frame.direction(other), z, atol=1e-12)
