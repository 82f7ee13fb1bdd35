"""The least effort on arcs, of joints that turn as they are told, against dense samples."""

import math
from typing import Any

import numpy as np
import pytest

from solver.approach.optimum import search
from solver.approach.optimum.search import (
    kink,
    least_effort,
    optimum_on_arcs,
    refine_cell,
    smooth_minimum,
)
from solver.approach.task.packed import REFERENCE
from solver.robots.model import Array
from tests.solver.approach.optimum.told import (
    MOVES,
    Told,
    cost,
    dense,
    scratch_of,
    task_of,
)
from tests.solver.interpreted import interpret, interpreted


@pytest.mark.parametrize("name", MOVES)
@pytest.mark.parametrize("squared", [False, True])
@pytest.mark.parametrize(("low", "high"), [(-1.0, 1.3), (0.2, 0.35), (0.29, 0.2901), (-3.0, 3.2)])
def test_nothing_on_an_arc_is_cheaper(
    monkeypatch: pytest.MonkeyPatch, name: str, squared: bool, low: float, high: float
) -> None:
    task, told = task_of(squared), Told(monkeypatch, MOVES[name])
    angle, effort, refined = interpreted(least_effort)(
        task, scratch_of(), scratch_of(), 5, low, high, True, True, math.inf
    )
    least = dense(task, MOVES[name], low, high)
    assert low <= angle <= high
    assert effort == pytest.approx(cost(task, MOVES[name](np.array([angle])))[0], rel=1e-12)
    assert effort <= least + 1e-11
    assert effort >= least - 4e-3
    assert told.branches == {5}
    assert refined >= 1
    # What is not below what is known already is not looked for.
    again = interpreted(least_effort)(
        task, scratch_of(), scratch_of(), 5, low, high, True, True, effort
    )
    assert math.isnan(again[0])
    assert again[1] == effort
    beaten = interpreted(least_effort)(
        task, scratch_of(), scratch_of(), 5, low, high, True, True, effort * (1 + 1e-6)
    )
    assert beaten[1] == pytest.approx(effort, rel=1e-12)


def test_few_cells_of_a_smooth_effort_are_looked_at_closely(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Where it has a cusp at an end those cells are, however smooth it looks."""

    def flat(x: Array) -> Array:
        joints = np.full((6, len(x)), 3.0)
        joints[0] += 0.5 * x + 0.01 * (x - 0.3) ** 2
        joints[4] -= 0.5 * x
        return joints

    counts = {}
    for cusps in ((False, False), (True, False), (False, True), (True, True)):
        Told(monkeypatch, flat)
        found = interpreted(least_effort)(
            task_of(), scratch_of(), scratch_of(), 0, 0.0, 0.62, *cusps, math.inf
        )
        counts[cusps] = found[2]
    assert counts[False, False] <= 3
    assert counts[True, False] == counts[False, True] == counts[False, False] + 1
    assert counts[True, True] == counts[False, False] + 2


def test_arcs_are_sampled_every_three_hundredths_and_four_times_at_least(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen: list[int] = []

    def sample(task: Any, scratch: Any, branch: int, count: int) -> None:
        seen.append(count)
        angles = scratch.angles[:count]
        assert np.diff(angles) == pytest.approx(np.full(count - 1, angles[1] - angles[0]))
        assert (angles[0], angles[-1]) == (0.25, high)
        scratch.joints[:, :count], scratch.efforts[:count] = 5.0, 9.0

    interpret(monkeypatch, search, sample_effort=sample, least_in_cell=lambda *_: 10.0)
    for high, count in ((0.26, 5), (0.25 + 0.29, 11), (0.25 + 2 * math.pi, 211)):
        seen.clear()
        result = interpreted(least_effort)(
            task_of(), scratch_of(), scratch_of(), 0, 0.25, high, True, True, math.inf
        )
        assert seen == [count]
        assert result == (0.25, 9.0, 0)


def test_the_cheapest_of_some_arcs(monkeypatch: pytest.MonkeyPatch) -> None:
    efforts = {0.1: 5.0, 0.2: 3.0, 0.3: 4.0, 0.4: 3.0}
    asked: list[tuple[Any, ...]] = []

    def least(task: Any, samples: Any, cell: Any, branch: int, low: float, high: float,
              low_cusp: bool, high_cusp: bool, best: float) -> Any:  # fmt: skip
        assert low_cusp
        assert high_cusp
        asked.append((task.numbers.tolist(), int(branch), float(low), float(high), best))
        cost = efforts[float(low)]
        return (low + 0.01, cost, 3) if cost < best else (math.nan, best, 2)

    interpret(monkeypatch, search, least_effort=least, effort_scratch=lambda rows: rows)
    numbers, given = np.array([[1.0], [2.0]]), np.array([0, 1, 1, 0])
    lower = np.array([0.1, 0.2, 0.3, 0.4])
    found = interpreted(optimum_on_arcs)(
        numbers, np.zeros(3), np.zeros(2), given, np.array([4, 5, 6, 7]), lower, lower + 0.05
    )
    assert found == (1, pytest.approx(0.21), 3.0, 10)
    assert [one[:2] for one in asked] == [([1.0], 4), ([2.0], 5), ([2.0], 6), ([1.0], 7)]
    assert [one[4] for one in asked] == [math.inf, 5.0, 3.0, 3.0]
    none = interpreted(optimum_on_arcs)(numbers, np.zeros(3), np.zeros(2), *[np.zeros(0)] * 4)
    assert (none[0], none[2], none[3]) == (-1, math.inf, 0)
    assert math.isnan(none[1])


@pytest.mark.parametrize("offset", [-0.7, 0.0, 0.4])
def test_a_kink_is_where_a_joint_passes_its_reference(
    monkeypatch: pytest.MonkeyPatch, offset: float
) -> None:
    def curve(x: Array) -> Array:
        return np.tanh(3 * (np.asarray(x) - offset)) + 0.2 * (np.asarray(x) - offset) ** 3

    task = task_of()
    told = Told(
        monkeypatch, lambda x: np.full((6, 1), 9.0) + curve(x) - 9.0 + task.numbers[REFERENCE + 2]
    )
    for a, b in ((-1.0, 1.0), (1.0, -1.0), (offset - 1e-3, 1.0)):
        told.count = 0
        fa, fb = float(curve(np.array(a))), float(curve(np.array(b)))
        found = interpreted(kink)(task, scratch_of(), 0, 2, a, fa, b, fb)
        assert found == pytest.approx(offset, abs=1e-12)
        assert told.count <= 20


@pytest.mark.parametrize("least", [0.05, 0.4, 0.95, -0.5, 1.5])
@pytest.mark.parametrize("power", [2, 4])
def test_a_smooth_minimum_is_closed_in_on(
    monkeypatch: pytest.MonkeyPatch, least: float, power: int
) -> None:
    """Or is an end, where effort does not fall from it."""
    task = task_of()

    def joints(x: Array) -> Array:
        moved = np.repeat(task.numbers[REFERENCE : REFERENCE + 6, None], len(x), axis=1)
        moved[0] += 2.0 + np.abs(x - least) ** power + 0.3 * np.sin(x - least) ** 2
        return moved

    told = Told(monkeypatch, joints)
    where, effort = interpreted(smooth_minimum)(task, scratch_of(), 0, 0.0, 1.0)
    expected = min(max(least, 0.0), 1.0)
    assert where == pytest.approx(expected, abs=3e-6)
    assert effort == pytest.approx(cost(task, joints(np.array([expected])))[0], abs=1e-11)
    assert told.count <= (4 if expected != least else 30)


@pytest.mark.parametrize("name", MOVES)
@pytest.mark.parametrize("squared", [False, True])
def test_a_cell_is_refined_to_its_least(
    monkeypatch: pytest.MonkeyPatch, name: str, squared: bool
) -> None:
    task = task_of(squared)
    told = Told(monkeypatch, MOVES[name])
    for low, high in ((0.1, 0.13), (0.3, 0.33), (-0.8, -0.77), (0.305, 0.32)):
        angle, effort = interpreted(refine_cell)(task, scratch_of(), 0, low, high, math.inf)
        assert effort <= dense(task, MOVES[name], low, high) + 1e-11
        assert low <= angle <= high
        unbeaten = interpreted(refine_cell)(task, scratch_of(), 0, low, high, effort)
        assert math.isnan(unbeaten[0])
        assert unbeaten[1] == effort
    assert told.count < 3000


@pytest.mark.parametrize("kinks", [(0.311, 0.3177), (0.3177, 0.311), (0.3049, 0.3211)])
def test_a_least_in_a_kink_is_found_exactly(
    monkeypatch: pytest.MonkeyPatch, kinks: tuple[float, float]
) -> None:
    """Two joints pass their references in one cell; between them effort falls or rises."""
    task = task_of()

    def joints(x: Array) -> Array:
        moved = np.repeat(task.numbers[REFERENCE : REFERENCE + 6, None], len(x), axis=1)
        moved[1] += 0.9 * np.sin(x - kinks[0])
        moved[5] -= 1.1 * np.sin(x - kinks[1])
        return moved

    Told(monkeypatch, joints)
    angle, effort = interpreted(refine_cell)(task, scratch_of(), 0, 0.3, 0.33, math.inf)
    # The heavier joint stands where its reference is.
    assert angle == pytest.approx(kinks[1], abs=1e-12)
    assert effort == pytest.approx(2 * 0.9 * abs(math.sin(kinks[1] - kinks[0])), abs=1e-12)
