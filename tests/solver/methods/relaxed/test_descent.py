"""Points of the relaxations for the kernels, and the descent among them against a plain simplex."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from solver.approach.optimum.cheapest import cheapest_scratch
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.packed import COLUMNS, jump_cosines
from solver.approach.task.relaxation import rotation
from solver.methods.relaxed import descent
from solver.methods.relaxed.descent import descend, effort_in_zone, write_fixed, write_points
from solver.methods.relaxed.points import fixed_task
from tests.solver.interpreted import interpreted
from tests.solver.methods.synthetic import small_task

TURNED = ("y", "outward", "sideways", "x_outward", "x_sideways")
Effort = Callable[[np.ndarray], float]


def three(numbers: np.ndarray, name: str) -> np.ndarray:
    return numbers[COLUMNS[name] : COLUMNS[name] + 3]


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("strike", "along", "across"), [(0.01, 0.2, -0.3), (0.0, 0.0, 0.1), (0.02, -0.4, 0.0)]
)
def test_a_fixed_point_is_a_shorter_tool_on_a_turned_circle(
    side: int, strike: float, along: float, across: float
) -> None:
    task = small_task(symmetric_tool=True)
    numbers = task.packed(side).numbers
    fixed = np.full_like(numbers, np.nan)
    write_fixed(numbers, strike, along, across, fixed)
    turn = rotation(along * three(numbers, "outward") + across * three(numbers, "sideways"))
    expected = numbers.copy()
    expected[COLUMNS["tool_length"]] -= strike
    for name in TURNED:
        three(expected, name)[:] = turn @ three(numbers, name)
    np.testing.assert_allclose(fixed, expected, rtol=1e-14, atol=1e-14)


def test_without_a_swing_nothing_is_turned() -> None:
    numbers = small_task().packed(1).numbers
    fixed = np.full_like(numbers, np.nan)
    write_fixed(numbers, 0.01, 0.0, 0.0, fixed)
    fixed[COLUMNS["tool_length"]] += 0.01
    np.testing.assert_allclose(fixed, numbers, atol=1e-16)


def test_many_points_are_written_for_each_side_of_the_tool() -> None:
    numbers = small_task(symmetric_tool=True).numbers_by_side
    strikes, along, across = np.array([[0.0, 0.01, 0.02], [0.1, 0.0, -0.2], [0.0, 0.0, 0.3]])
    fixed = np.full((2, 3, numbers.shape[1]), np.nan)
    write_points(numbers, strikes, along, across, fixed)
    one = np.empty(numbers.shape[1])
    for side in range(2):
        for k in range(3):
            write_fixed(numbers[side], strikes[k], along[k], across[k], one)
            np.testing.assert_array_equal(fixed[side, k], one)


@pytest.mark.parametrize(
    ("x", "inside"),
    [
        ((0.5, 0.3, -0.4), (0.5, 0.3, -0.4)),
        ((-0.2, 0.6, 0.8), (0.0, 0.6, 0.8)),
        ((1.3, -1.2, 1.6), (1.0, -0.6, 0.8)),
    ],
)
def test_the_effort_at_a_point_is_that_of_its_unrelaxed_task(
    x: tuple[float, ...], inside: tuple[float, ...]
) -> None:
    """And what lies outside the zone is brought back into it."""
    task, zone = small_task(symmetric_tool=True), np.array([0.01, 0.06])
    retreats, at = np.asarray(task.retreats_m), np.array(x)
    effort = effort_in_zone(
        task.numbers_by_side, retreats, jump_cosines(retreats),
        cheapest_scratch(len(retreats)), zone, at, np.empty(task.numbers_by_side.shape[1]),
    )  # fmt: skip
    np.testing.assert_allclose(at, inside, rtol=1e-14, atol=1e-14)
    swing = zone[1] * (inside[1] * task.frame.outward + inside[2] * task.frame.sideways)
    best = best_on_arcs(fixed_task(task, zone[0] * inside[0], swing))
    assert best is not None
    assert effort == pytest.approx(best.effort, rel=1e-9)


def brought_in(x: np.ndarray) -> None:
    x[0] = np.clip(x[0], 0.0, 1.0)
    x[1:] /= max(1.0, float(np.hypot(x[1], x[2])))


def run(
    monkeypatch: pytest.MonkeyPatch,
    effort: Effort,
    zone: tuple[float, float],
    start: tuple[float, float, float],
    most: int,
) -> tuple[np.ndarray, list[np.ndarray]]:
    """Where a descent of some other effort ends, and the points that it looked at."""
    seen: list[np.ndarray] = []

    def stand_in(*arguments: object) -> float:
        x = arguments[5]
        assert isinstance(x, np.ndarray)
        brought_in(x)
        seen.append(x.copy())
        return effort(x)

    monkeypatch.setattr(descent, "effort_in_zone", stand_in)
    task = small_task()
    retreats = np.asarray(task.retreats_m)
    ended = interpreted(descend)(
        task.numbers_by_side, retreats, jump_cosines(retreats), np.array(zone), np.array(start),
        most,
    )  # fmt: skip
    return ended, seen


def plain_simplex(
    effort: Effort, moving: list[int], start: tuple[float, float, float], most: int
) -> tuple[np.ndarray, list[np.ndarray]]:
    """Nelder and Mead, 1965, in lists; begun anew with a quarter of the size until it gains less.

    Edges of 0.3 and a ten thousandth at which it is begun anew.
    """
    seen: list[np.ndarray] = []

    def looked(x: np.ndarray) -> tuple[float, np.ndarray]:
        x = x.copy()
        brought_in(x)
        seen.append(x)
        return effort(x), x

    at, best, size = np.array(start), math.inf, 0.3
    while len(seen) < most:
        corners = [looked(at)]
        for i in moving:
            x = at.copy()
            x[i] += size if x[i] + size <= 1.0 else -size
            corners.append(looked(x))
        while len(seen) < most:
            corners.sort(key=lambda corner: corner[0])
            if max(np.abs(x - corners[0][1]).max() for _, x in corners) < 1e-4:
                break
            *others, (dearest, worst) = corners
            centre = np.mean([x for _, x in others], axis=0)
            new = looked(centre + (centre - worst))
            if new[0] < corners[0][0]:
                new = min(new, looked(centre + 2 * (centre - worst)), key=lambda corner: corner[0])
            elif new[0] >= others[-1][0]:
                beside = new[1] if new[0] < dearest else worst
                inner = looked((centre + beside) / 2)
                if inner[0] >= min(new[0], dearest):
                    corners[1:] = [looked((corners[0][1] + x) / 2) for _, x in corners[1:]]
                    continue
                new = inner
            corners[-1] = new
        before, (best, at) = best, min(corners, key=lambda corner: corner[0])
        size = max(size / 4, 2e-4)
        if before - best <= 1e-5 * best:
            break
    return at, seen


def bowl(x: np.ndarray) -> float:
    return float(1.0 + (x[0] - 0.3) ** 2 + 4 * (x[1] + 0.2) ** 2 + 2 * (x[2] - 0.5) ** 2)


def crease(x: np.ndarray) -> float:
    along = 0.93 * abs(x[0] - 0.31) + 3.1 * abs(x[1] - 0.87 * x[2])
    return float(2.0 + along + abs(x[1] + 0.4) ** 1.1)


def cliff(x: np.ndarray) -> float:
    """None at all beyond an edge; the least is on it."""
    return math.inf if x[0] > 0.62 or x[1] < -0.7 else 3.0 - x[0] + x[1] + (x[2] - 0.1) ** 2


def ripples(x: np.ndarray) -> float:
    return 2.0 + math.sin(9 * x[0]) + math.sin(7 * x[1]) * math.cos(8 * x[2])


@pytest.mark.parametrize("effort", [bowl, crease, cliff, ripples])
@pytest.mark.parametrize(
    ("zone", "moving"), [((0.02, 0.2), [0, 1, 2]), ((0.02, 0.0), [0]), ((0.0, 0.2), [1, 2])]
)
@pytest.mark.parametrize("start", [(0.0, 0.0, 0.0), (0.9, -0.6, 0.5)])
def test_the_descent_is_nelder_and_mead_s(
    monkeypatch: pytest.MonkeyPatch,
    effort: Effort,
    zone: tuple[float, float],
    moving: list[int],
    start: tuple[float, float, float],
) -> None:
    for most in (1, 7, 40, 300):
        ended, seen = run(monkeypatch, effort, zone, start, most)
        expected, looked = plain_simplex(effort, moving, start, most)
        assert len(seen) == len(looked)
        np.testing.assert_allclose(seen, looked, atol=1e-9)
        np.testing.assert_allclose(ended, expected, atol=1e-9)


def test_a_descent_ends_at_the_bottom_of_a_bowl(monkeypatch: pytest.MonkeyPatch) -> None:
    ended, seen = run(monkeypatch, bowl, (0.02, 0.2), (0.9, 0.0, 0.0), 400)
    assert ended == pytest.approx([0.3, -0.2, 0.5], abs=5e-3)
    assert len(seen) < 300
    ended, _ = run(monkeypatch, bowl, (0.02, 0.0), (0.9, 0.0, 0.0), 400)
    assert ended == pytest.approx([0.3, 0.0, 0.0], abs=1e-4)


def test_the_kernel_ends_where_its_efforts_say() -> None:
    """Compiled, on a real task: no point that it could step to is much cheaper."""
    task, zone = small_task(2), np.array([0.02, 0.0])
    retreats = np.asarray(task.retreats_m)
    known = task.numbers_by_side, retreats, jump_cosines(retreats)
    ended = descend(*known, zone, np.array([0.5, 0.0, 0.0]), 12)
    scratch, fixed = cheapest_scratch(len(retreats)), np.empty(known[0].shape[1])

    def effort(share: float) -> float:
        return float(effort_in_zone(*known, scratch, zone, np.array([share, 0.0, 0.0]), fixed))

    assert effort(ended[0]) <= min(effort(share) for share in (0.0, 0.25, 0.5, 0.75, 1.0))
