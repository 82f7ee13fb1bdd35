"""Between rows, on measures that are told: where nothing is looked at, and where it is least."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from solver.approach.cut_in import broken_between_rows as module
from solver.approach.cut_in.broken_between_rows import (
    _Behind,
    _dips_beside,
    _lowest,
    _stays_above,
    broken_between,
)
from solver.approach.cut_in.cut_in import rate_room
from solver.approach.cut_in.line_behind import LineBehind
from solver.methods.candidates import at_angle
from tests.solver.methods.synthetic import small_task

TASK = small_task(2)
THINNING = TASK.thinning_joints(0.2, 1, 2)
LINE = LineBehind(TASK.robot, TASK.tool, THINNING, 2)
COARSE = np.asarray(TASK.retreats_m)
CANDIDATE = at_angle(TASK, 0.2, 1, 2, THINNING)
Curve = Callable[[np.ndarray], np.ndarray]


def test_what_is_measured_behind_a_posture() -> None:
    behind, rows = _Behind(TASK, LINE), LINE.rows(COARSE)
    assert behind.reach(COARSE, rows) == pytest.approx(LINE.reach(COARSE))
    assert behind.inside(COARSE, rows) == pytest.approx(TASK.inside(rows).min(axis=1))
    room = rate_room(TASK.robot, TASK.tool, 2, rows)
    assert behind.room(COARSE, rows) == pytest.approx(room)


def test_a_measure_stays_above_zero_that_changes_by_less() -> None:
    assert _stays_above(np.full(4, np.inf))
    assert _stays_above(np.array([0.5, 0.4, 0.5]))
    assert not _stays_above(np.array([0.5, 0.1, 0.5]))
    assert not _stays_above(np.array([0.5, 0.5, -0.1]))
    # By the changes to both sides together; at an end there is one.
    assert not _stays_above(np.array([0.4, 0.2, 0.3, 0.4]))
    assert _stays_above(np.array([0.2, 0.1, 0.19]) + 0.1)
    assert not _stays_above(np.array([0.1, 0.2, 0.2]))
    assert _stays_above(np.array([0.11, 0.2, 0.3]))


@pytest.mark.parametrize("at", [0.0, 0.0123, 0.0399, 0.04])
def test_a_least_is_closed_in_on(at: float) -> None:
    def curve(retreats: np.ndarray, rows: Any = None) -> np.ndarray:
        # Rows as they are followed: falling to the target, where the posture is known.
        assert np.all(np.diff(retreats) < 0.0)
        assert retreats[-1] == 0.0
        assert rows is None or rows[-1] == pytest.approx(THINNING)
        return np.asarray(np.abs(retreats - at) - 0.25)

    dense = np.linspace(0.04, 0.0, 121)
    retreat, value = _lowest(_Behind(TASK, LINE), dense, curve(dense), curve)
    assert retreat == pytest.approx(at, abs=1e-8)
    assert value == pytest.approx(-0.25, abs=1e-8)


def told(monkeypatch: pytest.MonkeyPatch, /, suspicious: Any = True, **curves: Any) -> list[str]:
    """Measures by their names; those that are not told are far from broken."""
    asked: list[str] = []

    def measured(name: str) -> Any:
        def measure(self: Any, retreats: np.ndarray, rows: np.ndarray) -> np.ndarray:
            asked.append(name)
            return curves[name](retreats) if name in curves else np.ones(len(retreats))

        return measure

    for name in ("reach", "inside", "room"):
        monkeypatch.setattr(_Behind, name, measured(name))
    monkeypatch.setattr(module, "_suspicious", lambda *_: suspicious)
    return asked


def dip(at: float, depth: float) -> Curve:
    return lambda x: np.abs(x - at) * 30 - depth


@pytest.mark.parametrize("name", ["reach", "inside", "room"])
def test_where_a_measure_is_below_zero_its_least_is_told(
    monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    told(monkeypatch, **{name: dip(0.0123, 1e-3)})
    found = broken_between(TASK, CANDIDATE)
    assert found == pytest.approx(0.0123, abs=1e-7)
    told(monkeypatch, **{name: dip(0.0123, -1e-3)})
    assert broken_between(TASK, CANDIDATE) is None


def test_reach_comes_before_limits_before_rates(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = told(monkeypatch, inside=dip(0.01, 0.1), room=dip(0.03, 0.2))
    assert broken_between(TASK, CANDIDATE) == pytest.approx(0.01, abs=1e-7)
    assert "room" not in asked
    told(monkeypatch, reach=dip(0.02, 0.1), inside=dip(0.01, 0.1))
    assert broken_between(TASK, CANDIDATE) == pytest.approx(0.02, abs=1e-7)


def test_even_rows_that_are_not_suspicious_are_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    told(monkeypatch, suspicious=False, inside=dip(0.01, 0.1))
    assert broken_between(TASK, CANDIDATE) is None
    uneven = TASK.with_retreat(0.0111)
    assert broken_between(uneven, CANDIDATE) == pytest.approx(0.01, abs=1e-7)


@pytest.mark.parametrize(("slope", "dips"), [(50.0, True), (-50.0, True), (0.0, False)])
def test_a_room_that_is_used_up_and_falls_on_beside_its_row(
    monkeypatch: pytest.MonkeyPatch, slope: float, dips: bool
) -> None:
    """Whichever way it falls; where all rows have room nothing is looked at."""
    k = 6
    told(monkeypatch, room=lambda x: (x - COARSE[k]) * slope)
    room = np.where(np.arange(len(COARSE)) == k, 0.0, 1.0)
    assert _dips_beside(_Behind(TASK, LINE), COARSE, room) == dips
    assert not _dips_beside(_Behind(TASK, LINE), COARSE, np.ones(len(COARSE)))
