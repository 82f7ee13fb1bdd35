"""Ends of a cell that are pulled in, of constraints that are told."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solver.approach.arcs import roots
from solver.approach.arcs.roots import (
    pull_in,
    tighten,
)
from solver.approach.arcs.turns import (
    CONSTRAINTS,
)
from solver.approach.task.constraints import JUMP, REACH
from tests.solver.interpreted import interpreted
from tests.solver.methods.synthetic import small_task

TASK = small_task(2).packed(1)


class Inwards:
    """An end at 0 of a cell up to 1: every constraint is met from an angle of its own on."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, mirrored: bool) -> None:
        self.from_on: dict[tuple[int, int], float] = {}
        self.stretched, self.met_before = False, True
        self.flip = -1.0 if mirrored else 1.0
        for name in ("worst_constraint", "row_margin", "root", "stretched"):
            monkeypatch.setattr(roots, name, getattr(self, f"_{name}"))
        monkeypatch.setattr(roots, "row_room", self._row_room)
        monkeypatch.setattr(roots, "turns_along_path", self._turns)
        monkeypatch.setattr(roots, "path_margins", lambda *_: None)
        self.at: dict[int, float] = {}
        self.looked: list[float] = []
        work, margins = SimpleNamespace(), np.zeros(CONSTRAINTS)
        self.scratch = SimpleNamespace(work=work, work_margins=margins)

    def margin(self, i: int, row: int, angle: float) -> float:
        return self.flip * angle - self.from_on.get((i, row), -1.0)

    def _turns(self, task: object, angle: float, arm: int, turns: object) -> None:
        assert arm == 2
        self.looked.append(angle)
        self.at[id(turns)] = angle

    def _worst_constraint(self, task: object, turns: object, wrist: int, first: int, last: int,
                          margins: object) -> tuple[int, int, float]:  # fmt: skip
        angle = self.at[id(turns)]
        own = [(self.margin(i, row, angle), i, row) for i, row in self.from_on if first <= i < last]
        worst = min(own, default=(0.0, -1, 0))
        return (worst[1], worst[2], worst[0]) if worst[0] < 0.0 else (-1, 0, 0.0)

    def _row_margin(self, task: object, turns: object, row: int, wrist: int, i: int) -> float:
        return self.margin(i, row, self.at[id(turns)])

    def _row_room(self, g: object, turns: object, row: int) -> float:
        return self.margin(JUMP, row, self.at[id(turns)])

    def _root(self, task: object, scratch: object, arm: int, wrist: int, i: int, row: int,
              broken: float, f_broken: float, met: float, f_met: float) -> float:  # fmt: skip
        assert (arm, wrist) == (2, 1)
        assert f_broken == self.margin(i, row, broken)
        assert f_met >= 0.0
        assert met == self.flip
        return self.flip * self.from_on[i, row]

    def _stretched(self, task: object, turns: object) -> bool:
        return self.stretched

    def run(self, last: int = CONSTRAINTS) -> tuple[float, int, bool]:
        start, end = SimpleNamespace(), SimpleNamespace()
        self.at[id(start)], self.at[id(end)] = 0.0, self.flip
        ends = [np.zeros(CONSTRAINTS), np.zeros(CONSTRAINTS)]
        for margins, angle in zip(ends, (0.0, self.flip), strict=True):
            margins[JUMP] = self.margin(JUMP, 0, angle)
        angle, by, clean = interpreted(pull_in)(
            TASK, self.scratch, 2, 1, 0, last, 0.0, self.flip, start, end, *ends
        )
        return self.flip * angle, by, clean


@pytest.fixture(params=[False, True], ids=["upwards", "downwards"])
def inwards(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Inwards:
    return Inwards(monkeypatch, request.param)


def test_an_end_that_holds_stays(inwards: Inwards) -> None:
    inwards.stretched = True
    assert inwards.run() == (0.0, JUMP, True)
    assert inwards.looked == []


def test_an_end_is_pulled_to_where_the_last_constraint_is_met(inwards: Inwards) -> None:
    inwards.from_on = {(3, 1): 0.2, (4, 0): 0.5, (REACH, 2): 0.3}
    assert inwards.run() == (0.5, 4, True)
    assert [abs(angle) for angle in inwards.looked] == [0.5]
    inwards.looked.clear()
    # Constraints after the last that is asked for are not looked at.
    inwards.from_on = {(3, 1): 0.2, (REACH, 2): 0.3}
    assert inwards.run(last=REACH) == (0.2, 3, True)


@pytest.mark.parametrize(("is_stretched", "by"), [(False, JUMP), (True, REACH)])
def test_a_rate_ends_an_arc_at_the_reach_where_the_elbow_is_stretched(
    inwards: Inwards, is_stretched: bool, by: int
) -> None:
    inwards.from_on, inwards.stretched = {(JUMP, 0): 0.4}, is_stretched
    assert inwards.run() == (0.4, by, True)
    inwards.from_on = {(2, 0): 0.4}
    assert inwards.run() == (0.4, 2, True)


@pytest.mark.parametrize("i", [3, JUMP])
def test_what_is_broken_at_both_ends_leaves_nothing(inwards: Inwards, i: int) -> None:
    inwards.from_on = {(i, 0): 1.5}
    assert inwards.run() == (1.0, i, True)
    inwards.from_on = {(i, 0): 1.0}
    assert inwards.run() == (1.0, i, True)


def test_what_was_met_at_this_end_and_is_broken_inside_does_not_behave(
    inwards: Inwards, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After the first is met another one is broken that was met at both ends."""
    inwards.from_on = {(3, 1): 0.2}
    plain = inwards._worst_constraint

    def worst(task: object, turns: object, *rest: Any) -> tuple[int, int, float]:
        found = plain(task, turns, *rest)
        return (5, 0, -0.1) if found[0] < 0 else found

    monkeypatch.setattr(roots, "worst_constraint", worst)
    assert inwards.run() == (1.0, 5, False)


def test_a_root_that_does_not_move_is_stepped_over(
    inwards: Inwards, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the width of an arc's end; and in the end it is given up."""
    inwards.from_on = {(3, 1): 0.2}
    monkeypatch.setattr(roots, "root", lambda *given: given[6])
    assert inwards.run() == (1.0, 3, False)
    assert len(inwards.looked) == 8 * CONSTRAINTS
    assert [abs(angle) for angle in inwards.looked[:3]] == pytest.approx([1e-15, 2e-15, 3e-15])


def ends(
    monkeypatch: pytest.MonkeyPatch, low: tuple[float, int, bool], high: tuple[float, int, bool]
) -> tuple[Any, list[tuple[Any, ...]]]:
    asked: list[tuple[Any, ...]] = []

    def pull(*given: Any) -> tuple[float, int, bool]:
        asked.append(given[2:])
        return low if len(asked) == 1 else high

    monkeypatch.setattr(roots, "pull_in", pull)
    found = interpreted(tighten)(TASK, "scratch", 2, 1, 0, 8, 0.1, 0.9, "lp", "rp", "lm", "rm")
    return found, asked


def test_both_ends_of_a_cell_are_pulled_in(monkeypatch: pytest.MonkeyPatch) -> None:
    found, asked = ends(monkeypatch, (0.3, 4, True), (0.6, 5, True))
    assert found == (True, 0.3, 0.6, 4, 5)
    assert asked == [
        (2, 1, 0, 8, 0.1, 0.9, "lp", "rp", "lm", "rm"),
        (2, 1, 0, 8, 0.9, 0.1, "rp", "lp", "rm", "lm"),
    ]
    assert ends(monkeypatch, (0.3, 4, True), (0.6, 5, False))[0] == (False, 0.3, 0.6, 4, 5)


def test_a_cell_that_does_not_behave_or_holds_nothing_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found, asked = ends(monkeypatch, (0.3, 4, False), (0.6, 5, True))
    assert found == (False, 0.1, 0.9, JUMP, JUMP)
    assert len(asked) == 1
    for end in (0.9, 1.0):
        found, asked = ends(monkeypatch, (end, 4, True), (0.6, 5, True))
        assert found == (True, 0.9, 0.1, JUMP, JUMP)
        assert len(asked) == 1
