"""What the direct search is begun from, and what it ends with, on searches that are told."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver.approach.numerical import refinement
from solver.approach.numerical.refinement import _directions, refined
from solver.approach.numerical.sweep import Arrival
from solver.approach.task.task import ApproachTask
from tests.solver.approach.numerical.test_multi_start import ROBOTS, task_of

TASK = task_of(ROBOTS[0], symmetric=True)


def told(
    monkeypatch: pytest.MonkeyPatch, holding: Any = lambda q: True, task: ApproachTask = TASK
) -> list[tuple[Any, ...]]:
    """The search moves the first joint to half of what it was."""
    asked: list[tuple[Any, ...]] = []

    def descend(chain: Any, family: Any, retreats: Any, weights: Any, squared: bool,
                directions: Any, angle: float, q: np.ndarray) -> float:  # fmt: skip
        side = 1 if np.array_equal(family.y_axis, task.frame.branch) else -1
        asked.append((side, angle, q.tolist(), squared, weights.tolist(), retreats.tolist()))
        assert directions.shape == (80, 7)
        q[0] /= 2
        return angle + 1.0

    monkeypatch.setattr(refinement, "descend", descend)
    monkeypatch.setattr(refinement, "holds", lambda c, f, r, q: holding(q))
    return asked


def arrival(first: float, side: int = 1, angle: float = 0.25) -> Arrival:
    q = np.array(TASK.reference)
    q[0] += first
    return Arrival(q, angle, side)


def test_each_family_is_searched_from_its_cheapest_arrival(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = told(monkeypatch)
    first = np.array(TASK.reference)[0]
    arrivals = [arrival(0.5, -1), arrival(0.55), arrival(0.65, angle=0.5), arrival(0.2)]
    found = refined(TASK, arrivals)
    assert [one[0] for one in asked] == [-1, 1, 1]
    assert [one[1] for one in asked] == [0.25, 0.5, 0.25]
    assert asked[0][5] == pytest.approx(np.linspace(TASK.retreats_m[0], 0.0, 5))
    assert asked[0][4] == [1.0] * 6
    assert [one.angle_rad for one in found] == sorted(
        (one.angle_rad for one in found),
        key=lambda angle: [one.angle_rad for one in found].index(angle),
    )
    travels = [abs(one.posture[0] - first) for one in found]
    assert travels == sorted(travels)
    assert {one.tool_side for one in found} == {1, -1}
    assert arrivals[0].posture[0] == first + 0.5
    assert {one.angle_rad for one in found} == {1.25, 1.5}


def test_arrivals_whose_cut_in_does_not_hold_are_passed_over(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first = np.array(TASK.reference)[0]
    asked = told(monkeypatch, lambda q: q[0] - first > 0.4)
    # One beside one that does not hold is of its family, and not asked.
    found = refined(TASK, [arrival(0.2), arrival(0.25), arrival(0.5), arrival(0.9)])
    assert len(asked) == len(found) == 2


def test_forty_eight_searches_are_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = told(monkeypatch)
    assert len(refined(TASK, [arrival(0.2 * k) for k in range(60)])) == 48
    assert len(asked) == 48


def test_arms_of_five_joints_have_nothing_to_choose(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = told(monkeypatch)
    few = replace(TASK, reference=TASK.reference[:5])
    arrivals = [arrival(0.5), arrival(0.2)]
    assert refined(few, arrivals) == arrivals
    assert asked == []


def test_directions_are_of_length_one_and_the_seed_s() -> None:
    directions = _directions(3, 7)
    assert directions.shape == (80, 7)
    assert np.linalg.norm(directions, axis=1) == pytest.approx(np.ones(80))
    assert np.array_equal(directions, _directions(3, 7))
    assert not np.array_equal(directions, _directions(4, 7))
    assert np.abs(directions.mean(axis=0)).max() < 0.15
