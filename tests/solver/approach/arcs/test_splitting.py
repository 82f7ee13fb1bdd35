"""Pieces of cells: kept, joined, and split out of cells whose states are told."""

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solver.approach.arcs import splitting
from solver.approach.arcs.cells import CellState
from solver.approach.arcs.roots import CELL_SLOTS, WHOLE_CUT_IN, arc_scratch
from solver.approach.arcs.splitting import (
    ARC_COLUMNS,
    MOST_ARCS,
    append_arc,
    append_sliver,
    forget_cells,
    know_cell,
    push,
    settle,
)
from solver.approach.arcs.turns import CONSTRAINTS, TURN_ROWS, turns_along_path
from solver.approach.task.constraints import JUMP, REACH
from tests.solver.interpreted import interpreted
from tests.solver.methods.synthetic import small_task

TASK = small_task(2).packed(1)
ROWS = len(TASK.retreats)
Piece = tuple[float, float, int, int]


def test_a_piece_that_goes_on_where_the_last_one_ends_lengthens_it() -> None:
    arcs = np.full((MOST_ARCS, ARC_COLUMNS), np.nan)
    assert append_arc(arcs, 0, 0, 2, 1, 0.1, 0.2, 3.0, 4.0) == 1
    assert arcs[0].tolist() == [5.0, 0.1, 0.2, 3.0, 4.0]
    assert append_arc(arcs, 0, 1, 2, 1, 0.2, 0.3, 5.0, 6.0) == 1
    assert arcs[0].tolist() == [5.0, 0.1, 0.3, 3.0, 6.0]
    assert append_arc(arcs, 0, 1, 2, 1, 0.31, 0.4, 7.0, 2.0) == 2
    assert arcs[1].tolist() == [5.0, 0.31, 0.4, 7.0, 2.0]
    # One of another branch is another arc, wherever it begins.
    assert append_arc(arcs, 2, 2, 3, 0, 0.4, 0.5, 1.0, 2.0) == 3
    assert arcs[2].tolist() == [6.0, 0.4, 0.5, 1.0, 2.0]
    assert np.isnan(arcs[3:]).all()


def test_a_cell_is_pushed_with_what_ends_it() -> None:
    stack = np.zeros((3, 4))
    push(stack, 1, 0.1, 0.2, 3.0, 4.0)
    assert stack.tolist() == [[0.0] * 4, [0.1, 0.2, 3.0, 4.0], [0.0] * 4]


def test_cut_ins_are_kept_and_the_one_not_asked_for_longest_makes_way() -> None:
    scratch = arc_scratch(ROWS)
    forget_cells(scratch)
    assert np.isinf(scratch.cell_angles).all()
    angles = [0.125 * k for k in range(CELL_SLOTS)]
    for k, angle in enumerate(angles):
        scratch.cell_ages[:] += 1
        scratch.cell_known_margins[:] = True
        assert know_cell(TASK, scratch, 1, angle, 0.0) == k
        assert scratch.cell_known_margins.sum() == CELL_SLOTS - 1
    turns = np.empty((TURN_ROWS, 24))
    for k, angle in enumerate(angles):
        turns_along_path(TASK, angle, 1, turns)
        assert scratch.cell_paths[k, :14] == pytest.approx(turns[:14])
    scratch.cell_ages[:] += 1
    # Known again, exactly or nearly.
    assert know_cell(TASK, scratch, 1, 0.375, 0.0) == 3
    assert scratch.cell_ages[3] == 0
    assert know_cell(TASK, scratch, 1, 0.375 + 1e-13, 1e-12) == 3
    oldest = int(np.argmax(scratch.cell_ages))
    assert know_cell(TASK, scratch, 1, 0.375 + 1e-13, 0.0) == oldest
    assert scratch.cell_angles[oldest] == 0.375 + 1e-13
    forget_cells(scratch)
    assert not scratch.cell_ages.any()


def test_eight_cut_ins_and_sixty_four_arcs_are_room_enough() -> None:
    """A cell takes four, of which its halves use three."""
    assert (CELL_SLOTS, MOST_ARCS, ARC_COLUMNS) == (8, 64, 5)


Rule = Callable[[float, float], tuple[CellState, int, int]]


class Settled:
    """A cell from 0 to 1 of which the state of every part is told."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, rule: Rule) -> None:
        self.rule, self.seen = rule, list[tuple[float, float]]()
        self.margins: dict[float, np.ndarray] = {}
        self.tight: Callable[..., Any] = lambda a, b: (True, a, b, JUMP, JUMP)
        self.first: list[tuple[int, int]] = []
        self.extreme: Callable[..., tuple[float, float]] = lambda a, b, sign: ((a + b) / 2, -1.0)
        self.signs: list[float] = []
        self.extreme_of: list[tuple[int, int]] = []
        self.least: Callable[[float, float], float] | None = None
        self.asked_least: list[tuple[float, float]] = []
        self.slivers: list[tuple[float, float]] = []
        self.known: list[tuple[float, float]] = []
        self.arcs = np.zeros((MOST_ARCS, ARC_COLUMNS))
        self.scratch = arc_scratch(ROWS)
        for name in ("know_cell", "path_margins", "path_state", "tighten", "extreme_margin",
                     "row_margin", "append_sliver", "effort_at_least"):  # fmt: skip
            monkeypatch.setattr(splitting, name, getattr(self, f"_{name}"))
        for name in ("push", "append_arc", "forget_cells"):
            monkeypatch.setattr(splitting, name, interpreted(getattr(splitting, name)))

    def _know_cell(self, task: object, scratch: Any, arm: int, angle: float, apart: float) -> int:
        assert arm == 2
        self.known.append((angle, apart))
        slot = len(self.known) % CELL_SLOTS
        scratch.cell_angles[slot] = angle
        scratch.cell_known_margins[slot] = False
        return slot

    def _path_margins(self, task: object, path: object, wrist: int, margins: np.ndarray) -> None:
        margins[:] = 1.0
        angle = self.angle_of(self.scratch.cell_margins, margins)
        margins[:] = self.margins.get(round(angle, 9), margins)

    def angle_of(self, kept: np.ndarray, one: np.ndarray) -> float:
        slot = next(k for k in range(CELL_SLOTS) if np.shares_memory(kept[k], one))
        return float(self.scratch.cell_angles[slot])

    def _effort_at_least(self, task: object, reference: np.ndarray, wrist: int,
                         *around: Any) -> float:  # fmt: skip
        assert self.least is not None
        assert reference is self.scratch.reference
        assert wrist == 1
        # The last column is the thinning posture's, however many rows there are.
        assert set(around[1::2]) == {self.scratch.cell_paths.shape[2] - 1}
        outer, a, b, beyond = (self.angle_of(self.scratch.cell_paths, one) for one in around[::2])
        assert (outer, beyond) == pytest.approx((a - (b - a), b + (b - a)))
        self.asked_least.append((round(a, 9), round(b, 9)))
        return self.least(a, b)

    def _path_state(self, task: object, wrist: int, width: float, *others: object) -> Any:
        (a, exact), (b, _), (outer, near), (beyond, _) = self.known[-4:]
        assert (exact, near) == (0.0, 1e-12)
        assert (outer, beyond) == pytest.approx((a - width, b + width))
        assert width == pytest.approx(b - a)
        self.seen.append((round(a, 9), round(b, 9)))
        return self.rule(a, b)

    def _tighten(self, task: object, scratch: object, arm: int, wrist: int, first: int, end: int,
                 a: float, b: float, *_: object) -> Any:  # fmt: skip
        self.first.append((first, end))
        return self.tight(a, b)

    def _extreme_margin(self, task: object, scratch: object, arm: int, wrist: int, i: int,
                        row: int, a: float, b: float, sign: float,
                        bracket: float) -> Any:  # fmt: skip
        assert bracket == 1e-7
        self.signs.append(sign)
        self.extreme_of.append((i, row))
        return self.extreme(a, b, sign)

    def _row_margin(self, task: object, path: object, row: int, wrist: int, i: int) -> float:
        return self.at_left

    def _append_sliver(self, task: object, scratch: object, arm: int, wrist: int, low: float,
                       high: float, arcs: object, start: int, count: int) -> int:  # fmt: skip
        self.slivers.append((low, high))
        return count

    at_left = -1.0

    def pieces(self, best: float = math.inf) -> list[Piece]:
        count = interpreted(settle)(
            TASK, self.scratch, 2, 1, 0.0, 1.0, 11, 12, self.arcs, 0, 0, best
        )
        assert all(self.arcs[:count, 0] == 5)
        return [(round(a, 9), round(b, 9), int(c), int(d)) for _, a, b, c, d in self.arcs[:count]]


def parts(*edges: float) -> Rule:
    """Full where an odd number of edges lies below, dead where an even one does, else halved."""

    def rule(a: float, b: float) -> tuple[CellState, int, int]:
        if any(a + 1e-9 < edge < b - 1e-9 for edge in edges):
            return CellState.EXTREME, -1, 0
        full = sum(edge < (a + b) / 2 for edge in edges) % 2 == 1
        return (CellState.FULL if full else CellState.DEAD), -1, 0

    return rule


def test_halves_are_looked_at_in_their_order_and_joined(monkeypatch: pytest.MonkeyPatch) -> None:
    settled = Settled(monkeypatch, parts(0.25, 0.625))
    assert settled.pieces() == [(0.25, 0.625, JUMP, JUMP)]
    assert settled.seen == [
        (0, 1), (0, 0.5), (0, 0.25), (0.25, 0.5), (0.5, 1), (0.5, 0.75), (0.5, 0.625),
        (0.625, 0.75), (0.75, 1),
    ]  # fmt: skip


def test_ends_of_the_cell_keep_what_ends_them(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Settled(monkeypatch, parts(-1.0)).pieces() == [(0.0, 1.0, 11, 12)]
    pieces = Settled(monkeypatch, parts(-1.0, 0.25, 0.5)).pieces()
    assert pieces == [(0.0, 0.25, 11, JUMP), (0.5, 1.0, JUMP, 12)]


def test_parts_that_cost_at_least_the_best_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each part is asked for, before its margins are; none where nothing is known to be better."""
    settled = Settled(monkeypatch, parts(0.25, 0.625))
    assert settled.pieces(math.inf) == [(0.25, 0.625, JUMP, JUMP)]
    assert settled.asked_least == []
    everything = list(settled.seen)
    settled.least = lambda a, b: a
    settled.seen.clear()
    assert settled.pieces(0.5) == [(0.25, 0.5, JUMP, JUMP)]
    assert settled.asked_least == [(0, 1), (0, 0.5), (0, 0.25), (0.25, 0.5), (0.5, 1)]
    assert settled.seen == everything[:4]
    # Just below the best is looked at.
    settled.seen.clear()
    assert settled.pieces(0.5 + 1e-9) == [(0.25, 0.625, JUMP, JUMP)]
    assert settled.seen == everything[:7]
    # What is left out in between ends the piece before it.
    settled.least = lambda a, b: 1.0 if (a, b) == (0.25, 0.5) else 0.0
    settled.rule = parts(-1.0, 0.25, 0.25)
    assert settled.pieces(1.0) == [(0.0, 0.25, 11, JUMP), (0.5, 1.0, JUMP, 12)]
    settled.least = lambda a, b: 1.0
    settled.seen.clear()
    assert settled.pieces(1.0) == []
    assert settled.seen == []


def crossed(state: CellState = CellState.CROSSED) -> Rule:
    return lambda a, b: (state, -1, 0)


def test_a_crossed_cell_is_tightened(monkeypatch: pytest.MonkeyPatch) -> None:
    settled = Settled(monkeypatch, crossed())
    settled.tight = lambda a, b: (True, 0.2, 0.7, 3, 4)
    assert settled.pieces() == [(0.2, 0.7, 3, 4)]
    assert settled.first == [(0, CONSTRAINTS)]
    settled.tight = lambda a, b: (True, a, 0.7, 3, 4)
    assert settled.pieces() == [(0.0, 0.7, 11, 4)]
    settled.tight = lambda a, b: (True, 0.2, b, 3, 4)
    assert settled.pieces() == [(0.2, 1.0, 3, 12)]
    for low, high in ((0.7, 0.7), (0.8, 0.7)):
        settled.tight = lambda a, b, low=low, high=high: (True, low, high, 3, 4)
        assert settled.pieces() == []


def test_one_that_does_not_behave_is_halved(monkeypatch: pytest.MonkeyPatch) -> None:
    settled = Settled(monkeypatch, crossed())
    settled.tight = lambda a, b: (b - a < 0.6, a, b, 3, 4)
    assert settled.pieces() == [(0.0, 1.0, 11, 12)]
    assert settled.seen == [(0, 1), (0, 0.5), (0.5, 1)]


def test_where_the_reach_is_entered_only_reaches_are_tightened_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What is left is looked at again, with the ends that it has now."""

    def rule(a: float, b: float) -> tuple[CellState, int, int]:
        return (CellState.EDGE if a < 0.2 else CellState.FULL), -1, 0

    settled = Settled(monkeypatch, rule)
    settled.tight = lambda a, b: (True, 0.25, b, REACH, 3)
    assert settled.pieces() == [(0.25, 1.0, REACH, 12)]
    assert settled.first == [(REACH, JUMP)]
    assert settled.seen == [(0, 1), (0.25, 1)]
    settled = Settled(monkeypatch, rule)
    settled.tight = lambda a, b: (True, b, a, REACH, 3)
    assert settled.pieces() == []
    # Where nothing is taken away it is halved.
    settled = Settled(
        monkeypatch, lambda a, b: (CellState.EDGE if b - a > 0.3 else CellState.FULL, -1, 0)
    )
    assert settled.pieces() == [(0.0, 1.0, 11, 12)]
    assert len(settled.seen) == 7


@pytest.mark.parametrize(("at_left", "sign"), [(-0.1, 1.0), (0.0, -1.0), (0.2, -1.0)])
@pytest.mark.parametrize(("i", "row"), [(3, 1), (JUMP, -1)])
def test_a_cell_is_split_at_its_extreme(
    monkeypatch: pytest.MonkeyPatch, i: int, row: int, at_left: float, sign: float
) -> None:
    def rule(a: float, b: float) -> tuple[CellState, int, int]:
        return (CellState.EXTREME, i, row) if b - a > 0.9 else (CellState.FULL, -1, 0)

    settled = Settled(monkeypatch, rule)
    settled.at_left = at_left
    settled.margins[0.0] = np.full(CONSTRAINTS, 9.0)
    settled.margins[0.0][JUMP] = at_left
    settled.extreme = lambda a, b, sign: (0.3, 0.5)
    assert settled.pieces() == [(0.0, 1.0, 11, 12)]
    assert settled.seen == [(0, 1), (0, 0.3), (0.3, 1)]
    assert settled.signs == [sign]
    assert settled.extreme_of == [(i, row)]
    # A largest value below zero leaves nothing; a smallest one above says nothing.
    settled.seen.clear()
    settled.extreme = lambda a, b, sign: (0.3, -0.5)
    assert bool(settled.pieces()) == (sign < 0.0)
    for where in (0.5e-7, 1.0 - 0.5e-7):
        settled.seen.clear()
        settled.extreme = lambda a, b, sign, where=where: (where, 0.5)
        settled.pieces()
        assert settled.seen[1] == (0, 0.5)


@pytest.mark.parametrize(
    ("left", "right", "asked"), [(-1, -1, True), (-1, 1, False), (1, -1, False)]
)
def test_the_narrowest_cells_are_given_up_but_for_slivers_between_rates(
    monkeypatch: pytest.MonkeyPatch, left: float, right: float, asked: bool
) -> None:
    """Where joints are too fast at both ends there may be something between them."""
    settled = Settled(
        monkeypatch, lambda a, b: (CellState.EXTREME if a == 0 else CellState.DEAD, -1, 0)
    )
    width = 2.0**-20
    for angle, value in ((0.0, left), (width, right)):
        settled.margins[round(angle, 9)] = np.full(CONSTRAINTS, value)
    assert settled.pieces() == []
    assert settled.seen[20] == (0, round(width, 9))
    assert len(settled.seen) == 41
    assert settled.slivers == ([(0.0, width)] if asked else [])


def sliver(
    monkeypatch: pytest.MonkeyPatch, room: Callable[[float], float], others: float = 1.0
) -> Any:
    """Of rates that are slow enough around 0.4 alone; the others' least margin there."""
    arcs = np.zeros((MOST_ARCS, ARC_COLUMNS))
    scratch = SimpleNamespace(work=None, work_margins=np.full(CONSTRAINTS, others))

    def extreme(task: object, scratch: object, arm: int, wrist: int, i: int, row: int, low: float,
                high: float, sign: float, bracket: float) -> tuple[float, float]:  # fmt: skip
        assert (arm, wrist, i, row) == (2, 1, JUMP, WHOLE_CUT_IN)
        assert (low, high, sign, bracket) == (0.0, 1.0, 1.0, 1e-9)
        return 0.4, room(0.4)

    def single(task: object, scratch: object, angle: float, *given: int) -> float:
        assert given == (WHOLE_CUT_IN, 2, 1, JUMP)
        return room(angle)

    monkeypatch.setattr(splitting, "extreme_margin", extreme)
    monkeypatch.setattr(splitting, "turns_along_path", lambda *_: None)
    monkeypatch.setattr(splitting, "path_margins", lambda *_: None)
    monkeypatch.setattr(splitting, "single_margin", single)
    monkeypatch.setattr(splitting, "append_arc", interpreted(append_arc))

    def root(task: object, scratch: object, arm: int, wrist: int, i: int, row: int, end: float,
             beyond: float, where: float, value: float) -> float:  # fmt: skip
        assert (arm, wrist, i, row) == (2, 1, JUMP, WHOLE_CUT_IN)
        assert (beyond, where, value) == (room(end), 0.4, room(0.4))
        return 0.4 + (0.01 if end > 0.4 else -0.01)

    monkeypatch.setattr(splitting, "root", root)
    count = interpreted(append_sliver)(TASK, scratch, 2, 1, 0.0, 1.0, arcs, 0, 0)
    return [(float(a), float(b), int(c), int(d)) for _, a, b, c, d in arcs[:count]]


def test_a_sliver_is_what_is_slow_enough_between_two_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    assert sliver(monkeypatch, lambda x: 0.1 - abs(x - 0.4)) == [
        (pytest.approx(0.39), pytest.approx(0.41), JUMP, JUMP)
    ]
    assert sliver(monkeypatch, lambda x: -1.0 if x > 0.9 else 0.0) == [
        (0.0, pytest.approx(0.41), JUMP, JUMP)
    ]
    assert sliver(monkeypatch, lambda x: -1.0 if x < 0.1 else 1.0) == [
        (pytest.approx(0.39), 1.0, JUMP, JUMP)
    ]


def test_no_sliver_where_it_is_too_fast_everywhere_or_something_else_breaks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert sliver(monkeypatch, lambda x: -0.01) == []
    assert sliver(monkeypatch, lambda x: 0.1, others=-1e-9) == []
    assert len(sliver(monkeypatch, lambda x: 0.0, others=0.0)) == 1
