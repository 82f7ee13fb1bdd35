"""What is told of a cell from samples at its ends and beside them."""

import numpy as np
import pytest

from solver.approach.optimum.search import (
    is_smooth,
    least_in_cell,
    swings_between,
    valley,
)
from solver.approach.task.packed import REFERENCE
from solver.robots.model import Array
from tests.solver.approach.optimum.told import WEIGHTS_OF, task_of


@pytest.mark.parametrize("squared", [False, True])
def test_what_effort_is_at_least_between_two_samples(squared: bool) -> None:
    """Each joint's smaller travel less half of how its turn changes; nothing where it passes."""
    task = task_of(squared)
    joints = np.random.default_rng(1).uniform(-1.0, 1.0, (6, 5))
    for k in range(4):
        expected = 0.0
        for i in range(6):
            travel = joints[i] - task.numbers[REFERENCE + i]
            turns = np.diff(travel)
            changes = [abs(turns[n] - turns[k]) for n in (k - 1, k + 1) if 0 <= n < 4]
            a, b = travel[k], travel[k + 1]
            least = 0.0 if a * b < 0 else max(min(abs(a), abs(b)) - max(changes) / 2, 0.0)
            expected += WEIGHTS_OF[i] * (least**2 if squared else least)
        assert least_in_cell(task, joints, k, 5) == pytest.approx(expected)


def steady(travel: float, step: float) -> Array:
    """Joints so far from their references, that turn so far from sample to sample."""
    start = task_of().numbers[REFERENCE : REFERENCE + 6, None]
    return np.asarray(start + travel + step * np.arange(6.0))


@pytest.mark.parametrize(
    ("travel", "step", "squared", "smooth"),
    [
        (1.0, 0.09, False, True),
        (1.0, 0.11, False, False),
        (1.0, 0.11, True, False),
        (-1.0, -0.09, False, True),
        # Nearer to its reference than half of what it turns: it may have passed it.
        (0.01, 0.04, False, False),
        (0.01, 0.04, True, True),
        (-0.01, -0.04, False, False),
        # From one side of it to the other.
        (-0.2, 0.08, False, False),
        (-0.2, 0.08, True, True),
    ],
)
def test_effort_is_smooth_where_no_joint_swings_or_passes_its_reference(
    travel: float, step: float, squared: bool, smooth: bool
) -> None:
    joints = steady(5.0, 0.0)
    for i in (0, 5):
        moved = joints.copy()
        moved[i] = steady(travel, step)[i]
        assert is_smooth(task_of(squared), moved, 1, 6) == smooth
    assert is_smooth(task_of(squared), joints, 1, 6)


def test_smoothness_is_looked_for_one_sample_beside_the_cell() -> None:
    task = task_of(True)
    for n in range(6):
        joints = steady(5.0, 0.0)
        joints[2, n:] += 0.2
        # The change lies between samples n - 1 and n; cells look from k - 1 to k + 2.
        smooth = [bool(is_smooth(task, joints, k, 6)) for k in range(5)]
        assert smooth == [not (k - 1 < n <= k + 2) or n == 0 for k in range(5)]


def test_a_valley_is_where_lines_from_outside_meet() -> None:
    efforts = np.array([4.0, 2.0, 1.0, 2.5, 9.0])
    assert valley(efforts, 1, 5) == pytest.approx(
        2.0 - 2.0 * (2.0 - 1.0 - 1.5 + 2.0) / 3.5, abs=1.0
    )
    # Of a convex function it is a bound.
    xs = np.array([-1.0, 0.0, 1.0, 2.0])
    for least in (0.2, 0.5, 0.9):
        bound = valley((xs - least) ** 2 + 3.0, 1, 4)
        assert bound <= 3.0
        assert bound == pytest.approx(-(_lines_meet(-((xs - least) ** 2) - 3.0)))
    # At the arc's ends one line is enough, and without one the samples are.
    assert valley(efforts, 0, 5) == 2.0
    assert valley(np.array([2.0, 1.0, 4.0]), 0, 3) == -2.0
    assert valley(np.array([4.0, 1.0, 2.0]), 1, 3) == -2.0
    assert valley(np.array([1.0, 2.0, 5.0]), 1, 3) == 2.0
    assert valley(np.array([5.0, 2.0, 1.0]), 0, 3) == 2.0


def _lines_meet(values: Array) -> float:
    before, left, right, after = values
    rise, fall = left - before, right - after
    return float(left + rise * (right - left + fall) / (rise + fall))


def test_a_joint_swings_that_turns_by_half_in_half_a_cell() -> None:
    joints = np.zeros((6, 4))
    joints[4, 2:] = 0.51
    assert swings_between(joints, 2)
    assert not swings_between(joints, 1)
    joints[4, 2:] = -0.51
    assert swings_between(joints, 2)
    joints[4, 2:] = 0.49
    assert not swings_between(joints, 3)
