"""The relaxed programme from a point: what it is given, and what is made of its end."""

from typing import Any

import numpy as np
import pytest

from solver.methods.nlp.instance import Instance, ProgrammeResult
from solver.methods.relaxed import programme
from solver.methods.relaxed.points import Point, optima_at
from solver.methods.relaxed.programme import programme_from
from solver.problem.effort import posture_effort
from tests.solver.methods.synthetic import small_task

RELAXED = {"strike_zone_m": 0.02, "tilt_tolerance_rad": 0.2}


def a_point(task: Any) -> Point:
    (point,) = optima_at(task, np.array([0.01]), 0.05 * task.frame.outward[None])
    return point


def ended(monkeypatch: pytest.MonkeyPatch, x: np.ndarray | None) -> list[Instance]:
    """The programme ends at once, at some x or where it started."""
    given: list[Instance] = []

    def solve(robot: object, instance: Instance, options: object) -> ProgrammeResult:
        given.append(instance)
        return ProgrammeResult(True, "somehow", 17, instance.x0 if x is None else x)

    monkeypatch.setattr(programme, "solve_instance", solve)
    return given


def test_it_starts_from_the_point_half_a_turn_to_both_sides(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    task = small_task(1, **RELAXED)
    point, given = a_point(task), ended(monkeypatch, None)
    end = programme_from(task, point)
    (instance,) = given
    angle = point.placement.approach_angle_rad
    assert instance.x0[:12].reshape(2, 6) == pytest.approx(point.postures)
    assert instance.x0[12:16] == pytest.approx([angle, 0.5, np.tan(0.025) / np.tan(0.1), 0.0])
    assert instance.lower[12] == pytest.approx(angle - np.pi)
    assert instance.upper[12] == pytest.approx(angle + np.pi)
    # Behind positions, axes, reference, next posture and weights stand the retreats.
    assert instance.parameters[30:32].tolist() == [0.0, 0.04]
    assert (end.status, end.iterations) == ("somehow", 17)
    assert end.effort == pytest.approx(point.effort)
    assert end.placement.approach_angle_rad == pytest.approx(angle)
    assert end.placement.strike_m == pytest.approx(0.01)
    assert end.placement.swing_rad == pytest.approx(point.placement.swing_rad)
    assert not instance.programme.shape.coupled


def test_a_next_posture_couples_it(monkeypatch: pytest.MonkeyPatch) -> None:
    task = small_task(1, **RELAXED)
    given = ended(monkeypatch, None)
    following = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    programme_from(task, a_point(task), following)
    assert given[0].programme.shape.coupled
    assert given[0].parameters[18:24].tolist() == list(following)


def test_numbers_that_are_none_leave_it_where_it_started(monkeypatch: pytest.MonkeyPatch) -> None:
    task = small_task(1, **RELAXED)
    point = a_point(task)
    ended(monkeypatch, np.full(22, np.nan))
    end = programme_from(task, point)
    assert (end.effort, end.placement) == (point.effort, point.placement)
    assert (end.status, end.iterations) == ("somehow", 17)


def test_its_effort_is_that_of_its_thinning_posture(monkeypatch: pytest.MonkeyPatch) -> None:
    task = small_task(1, norm="l2", **RELAXED)
    x = np.concatenate((np.linspace(-0.5, 0.5, 12), [0.3, 0.25, 0.0, 1.0]))
    ended(monkeypatch, x)
    end = programme_from(task, a_point(task))
    assert end.effort == posture_effort(x[:6], task.reference, task.joint_weights, "l2")
    assert end.placement.approach_angle_rad == 0.3
    assert end.placement.strike_m == pytest.approx(0.005)
    assert end.placement.swing_rad == pytest.approx(0.2 * task.frame.sideways)


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_it_gains_and_its_end_is_close_to_the_closed_form(norm: str) -> None:
    task = small_task(1, norm=norm, **RELAXED)
    point = a_point(task)
    end = programme_from(task, point)
    assert end.status == "solved"
    assert end.effort < point.effort
    placed = end.placement
    (there,) = optima_at(task, np.array([placed.strike_m]), placed.swing_rad[None])
    assert there.effort == pytest.approx(end.effort, rel=1e-3)
