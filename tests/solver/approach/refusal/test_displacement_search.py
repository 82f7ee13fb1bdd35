"""Rows that break, and the displacement that makes a target feasible."""

import math
from typing import Any

import numpy as np
import pytest

from solver.approach.refusal import displacement_search as module
from solver.approach.refusal.displacement_constraints import copy_at
from solver.approach.refusal.displacement_search import (
    broken_row,
    fastest_row,
    nearest_displacement,
    nearest_of_all,
)
from solver.approach.task.feasibility import trace
from solver.kinematics.straight_rates import between_rate_room, posture_rate_room
from tests.solver.interpreted import interpret, interpreted
from tests.solver.methods.synthetic import small_task

SMALL = small_task(2)
TASK = SMALL.for_kernels(1)
ROWS = SMALL.postures(0.2, 1, 2, TASK.retreats)
FAR_FROM_ALL = np.full(4, np.inf)


def test_the_row_that_breaks_its_limits_most() -> None:
    assert broken_row(TASK, ROWS) == -1
    for worst in (0, 7, 15):
        rows = ROWS.copy()
        rows[4, 2] = TASK.upper[2] + 0.1
        rows[worst, 3] = TASK.lower[3] - 0.2
        assert broken_row(TASK, rows) == worst


def test_the_row_in_which_joints_are_fastest() -> None:
    rows = ROWS.copy()
    rows[6, 4] = 1e-4 - TASK.geometry.offsets[4]

    def room(n: int) -> float:
        own = posture_rate_room(TASK.geometry, rows[n])
        if n == 15:
            return float(own)
        spacing = TASK.retreats[n] - TASK.retreats[n + 1]
        return float(min(own, between_rate_room(TASK.geometry, rows[n], rows[n + 1], spacing)))

    rooms = [room(n) for n in range(16)]
    assert fastest_row(TASK, rows) == int(np.argmin(rooms))
    last = ROWS.copy()
    last[15, 4] = 1e-5 - TASK.geometry.offsets[4]
    assert fastest_row(TASK, last) in (14, 15)


@pytest.mark.parametrize("spread", [0.0, 0.001])
def test_a_displaced_target_is_feasible_and_no_nearer_one_is_on_the_way(spread: float) -> None:
    moved = copy_at(TASK, TASK.position * 1.35)
    rows, start = np.empty((16, 6)), np.append(TASK.position - moved.position, 0.2)
    done, x = nearest_displacement(
        moved, 2, start, spread, 3e-5, FAR_FROM_ALL, math.inf, 1e-4, rows
    )
    assert done
    length = float(np.linalg.norm(x[:3]))
    assert length < float(np.linalg.norm(start[:3]))
    there = copy_at(moved, moved.position + x[:3])
    assert trace(there, x[3], 2, TASK.retreats, rows) >= 0.0
    # Nine tenths of the way, near that angle, nothing is.
    short = copy_at(moved, moved.position + 0.9 * x[:3])
    angles = x[3] + np.linspace(-0.3, 0.3, 13)
    assert max(trace(short, angle, 2, TASK.retreats, rows) for angle in angles) < 0.0
    assert not nearest_displacement(
        moved, 2, start, spread, 3e-5, FAR_FROM_ALL, 0.5 * length, 1e-4, rows
    )[0]


def test_of_all_branches_the_shortest_is_found() -> None:
    moved = copy_at(TASK, TASK.position * 1.35)
    found, branch, x = nearest_of_all(moved, 0.0, math.inf)
    assert found
    rows = np.empty((16, 6))
    there = copy_at(moved, moved.position + x[:3])
    assert trace(there, x[3], branch, TASK.retreats, rows) >= 0.0
    length = float(np.linalg.norm(x[:3]))
    start = np.append(TASK.position - moved.position, 0.2)
    _, alone = nearest_displacement(moved, 2, start, 0.0, 3e-5, FAR_FROM_ALL, math.inf, 1e-4, rows)
    assert length <= float(np.linalg.norm(alone[:3])) * 1.01
    assert not nearest_of_all(moved, 0.0, 0.5 * length)[0]


class Told:
    """Rounds of a search whose minima, traces and margins are told."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, **told: list[Any]) -> None:
        self.told = {name: list(values) for name, values in told.items()}
        self.watched: list[Any] = []
        interpret(
            monkeypatch, module, minimise=self._minimise, broken_row=self._next("broken"),
            fastest_row=self._next("fastest"), rows_displacement_margin=self._next("margins"),
            trace=lambda *_: self.told["traces"].pop(0),
        )  # fmt: skip

    def _next(self, name: str) -> Any:
        return lambda *_: self.told[name].pop(0)

    def _minimise(self, task: Any, origin: Any, x: Any, turn: Any, branch: int, watched: Any,
                  *_: Any) -> float:  # fmt: skip
        self.watched.append(
            (watched.rows[: watched.rows_count].tolist(),
             watched.jumps[: watched.jumps_count].tolist(), watched.spread, watched.bent)
        )  # fmt: skip
        return float(self.told["missing"].pop(0)) if self.told.get("missing") else 0.0

    def run(self, spread: float = 0.0, best: float = math.inf) -> tuple[bool, np.ndarray]:
        x = np.array([0.03, 0.0, 0.04, 0.2])
        done, found = interpreted(nearest_displacement)(
            TASK, 2, x, spread, 3e-5, FAR_FROM_ALL, best, 1e-4, np.empty((16, 6))
        )
        assert found is not x
        return bool(done), found


def test_rows_that_break_are_watched_from_then_on(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch, traces=[-1.0, -1.0, 0.0], broken=[7, 3])
    assert told.run()[0]
    assert [one[0] for one in told.watched] == [[15, 0], [15, 0, 7], [15, 0, 7, 3]]
    again = Told(monkeypatch, traces=[-1.0, -1.0], broken=[7, 7])
    assert not again.run()[0]
    assert len(again.watched) == 2


def test_rates_that_break_are_watched_after_a_step_away_from_singular_postures(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told = Told(monkeypatch, traces=[-1.0, -1.0, 0.0], broken=[-1, -1], fastest=[4, 9])
    assert told.run()[0]
    assert [one[1] for one in told.watched] == [[], [], [4], [4, 9]]
    assert [one[3] > 0.0 for one in told.watched] == [False, True, False, False]


def test_where_something_is_missing_or_it_is_too_long_it_is_left(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert not Told(monkeypatch, missing=[4e-5], traces=[0.0]).run()[0]
    assert Told(monkeypatch, missing=[2e-5], traces=[0.0]).run()[0]
    assert not Told(monkeypatch, traces=[0.0]).run(best=0.05)[0]
    assert Told(monkeypatch, traces=[0.0]).run(best=0.051)[0]


def test_a_margin_that_is_short_widens_what_has_to_be_borne(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    margins = [(0.001, 5, 0), (0.0018, 15, 0), (0.002, 5, 0)]
    told = Told(monkeypatch, traces=[0.0] * 3, margins=margins)
    assert told.run(spread=0.002)[0]
    assert [one[0] for one in told.watched] == [[15, 0], [15, 0, 5], [15, 0, 5]]
    wide = [0.002, 0.002 + 1.1 * 0.001 + 3e-5]
    wide.append(wide[-1] + 1.1 * 0.0002 + 3e-5)
    assert [one[2] for one in told.watched] == pytest.approx(wide)
    never = Told(monkeypatch, traces=[0.0] * 7, margins=[(0.001, 5, 0)] * 7)
    assert not never.run(spread=0.002)[0]
    assert len(never.watched) == 7
