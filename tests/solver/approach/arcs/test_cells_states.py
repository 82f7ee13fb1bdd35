"""The state of a cell from margins that are told: each rule by itself."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solver.approach.arcs import cells
from solver.approach.arcs.cells import CellState, path_state
from solver.approach.task.constraints import BESIDE, JUMP, REACH
from solver.approach.task.packed import COS_HALF, NUMBERS
from tests.solver.interpreted import interpreted

ROWS, NODES = 3, 4
OUTER, LEFT, RIGHT, BEYOND = range(NODES)
Answer = tuple[CellState, int, int]
NOTHING = (-1, 0)


class Cell:
    """Margins by node, constraint and row, the jump's by node, and what joints do in between."""

    def __init__(self) -> None:
        self.margins = np.ones((NODES, JUMP, ROWS))
        self.jumps = np.ones(NODES)
        self.edges: set[int] = set()
        self.swings: set[tuple[int, int]] = set()
        self.behind: set[tuple[int, int]] = set()
        self.cosine, self.width = 1.0, 0.1
        self.reaches = np.ones(NODES)
        self.numbers = np.zeros(NUMBERS)

    def set(self, i: int, row: int, *values: float) -> "Cell":
        self.margins[:, i, row] = values
        return self

    def state(self, monkeypatch: pytest.MonkeyPatch) -> Answer:
        def row_margin(task: object, node: int, n: int, wrist: int, i: int) -> Any:
            assert wrist == 1
            return self.margins[node, i, n]

        def enters(left: int, m: int, right: int, n: int) -> bool:
            assert (left, right, m) == (LEFT, RIGHT, n)
            return n in self.edges

        def swung(left: int, m: int, right: int, n: int, i: int) -> bool:
            assert (left, right, m) == (LEFT, RIGHT, n)
            return (i, n) in self.swings

        def behind(task: object, left: int, m: int, right: int, n: int, wrist: int, i: int) -> bool:
            assert (left, right, m, wrist) == (LEFT, RIGHT, n, 1)
            return (i, n) in self.behind

        def cosine(left: int, right: int, rows: int) -> float:
            assert (left, right, rows) == (LEFT, RIGHT, ROWS)
            return self.cosine

        stand_ins: dict[str, Any] = {
            "row_margin": row_margin,
            "enters_reach": enters,
            "swung": swung,
            "passes_behind": behind,
            "turn_cosine": cosine,
            "jump_margin": lambda task, node, wrist: self.jumps[node],
            "least_reach": lambda node, rows: self.reaches[node],
            "peak_above": interpreted(cells.peak_above),
        }
        for name, stand_in in stand_ins.items():
            monkeypatch.setattr(cells, name, stand_in)
        task = SimpleNamespace(retreats=np.zeros(ROWS), numbers=self.numbers)
        ends = [np.append(self.margins[k].min(axis=1), self.jumps[k]) for k in (LEFT, RIGHT)]
        state, i, row = interpreted(path_state)(
            task, 1, self.width, OUTER, LEFT, RIGHT, BEYOND, *ends
        )
        return CellState(state), i, row


@pytest.fixture
def cell() -> Cell:
    return Cell()


@pytest.mark.parametrize("i", [0, 5, REACH, BESIDE])
@pytest.mark.parametrize("row", range(ROWS))
class TestOneConstraint:
    """Joint, or reach, in one row."""

    def test_broken_at_both_ends_without_a_peak_is_dead(
        self, cell: Cell, monkeypatch: pytest.MonkeyPatch, i: int, row: int
    ) -> None:
        cell.set(i, row, -1.2, -1.0, -0.9, -1.3)
        assert cell.state(monkeypatch) == (CellState.DEAD, *NOTHING)

    def test_broken_at_both_ends_with_a_peak_is_an_extreme(
        self, cell: Cell, monkeypatch: pytest.MonkeyPatch, i: int, row: int
    ) -> None:
        cell.set(i, row, -0.6, -0.1, -0.1, -0.6)
        assert cell.state(monkeypatch) == (CellState.EXTREME, i, row)

    def test_broken_at_one_end_is_crossed(
        self, cell: Cell, monkeypatch: pytest.MonkeyPatch, i: int, row: int
    ) -> None:
        for values in ((-0.2, -0.1, 0.1, 0.2), (0.2, 0.1, -0.1, -0.2)):
            cell.set(i, row, *values)
            assert cell.state(monkeypatch) == (CellState.CROSSED, *NOTHING)

    def test_met_at_both_ends_with_a_valley_is_an_extreme(
        self, cell: Cell, monkeypatch: pytest.MonkeyPatch, i: int, row: int
    ) -> None:
        cell.set(i, row, 0.4, 0.05, 0.05, 0.4)
        assert cell.state(monkeypatch) == (CellState.EXTREME, i, row)
        cell.set(i, row, 0.09, 0.05, 0.05, 0.09)
        assert cell.state(monkeypatch) == (CellState.FULL, *NOTHING)
        # Far inside at both ends nothing turns back so soon.
        cell.set(i, row, 0.7, 0.1, 0.1, 0.7)
        assert cell.state(monkeypatch) == (CellState.FULL, *NOTHING)


def test_a_margin_of_nothing_is_met(cell: Cell, monkeypatch: pytest.MonkeyPatch) -> None:
    cell.set(2, 1, 0.0, 0.0, 0.0, 0.0)
    assert cell.state(monkeypatch) == (CellState.FULL, *NOTHING)
    cell.set(2, 1, -0.1, 0.0, -0.1, -0.2)
    assert cell.state(monkeypatch) == (CellState.CROSSED, *NOTHING)
    cell.set(2, 1, -0.2, -0.1, -0.0001, 0.0)
    assert cell.state(monkeypatch)[0] == CellState.DEAD


def test_rows_that_are_broken_at_different_ends_are_crossed(
    cell: Cell, monkeypatch: pytest.MonkeyPatch
) -> None:
    cell.set(3, 0, -0.3, -0.1, 0.1, 0.3).set(3, 2, 0.3, 0.1, -0.1, -0.3)
    assert cell.state(monkeypatch) == (CellState.CROSSED, *NOTHING)
    # What is crossed does not hide what may have an extreme.
    cell.set(4, 1, -0.6, -0.1, -0.1, -0.6)
    assert cell.state(monkeypatch) == (CellState.EXTREME, 4, 1)


def test_where_a_joint_has_a_cusp_or_swings_slopes_say_nothing(
    cell: Cell, monkeypatch: pytest.MonkeyPatch
) -> None:
    cell.set(3, 1, -1.0, -1.0, -1.0, -1.0)
    cell.swings = {(3, 1)}
    assert cell.state(monkeypatch) == (CellState.EXTREME, 3, 1)
    cell.swings = {(3, 0), (2, 1)}
    assert cell.state(monkeypatch)[0] == CellState.DEAD
    cell.edges, cell.swings = {1}, set()
    assert cell.state(monkeypatch) == (CellState.EXTREME, 3, 1)
    # Its own reach has slopes.
    cell.set(3, 1, 1, 1, 1, 1).set(REACH, 1, -1.0, -1.0, -1.0, -1.0)
    cell.swings = {(REACH, 1)}
    assert cell.state(monkeypatch)[0] == CellState.DEAD


@pytest.mark.parametrize("i", [REACH, BESIDE])
def test_where_the_reach_is_entered_is_an_edge(
    cell: Cell, monkeypatch: pytest.MonkeyPatch, i: int
) -> None:
    for values in ((-0.2, -0.1, 0.1, 0.2), (0.2, 0.1, -0.1, -0.2)):
        cell.set(i, 2, *values)
        cell.edges = {2}
        assert cell.state(monkeypatch) == (CellState.EDGE, *NOTHING)
    cell.edges = set()
    assert cell.state(monkeypatch) == (CellState.CROSSED, *NOTHING)
    # Where both ends are inside nothing is entered.
    cell.set(i, 2, 0.2, 0.1, 0.1, 0.2)
    cell.edges = {2}
    assert cell.state(monkeypatch) == (CellState.FULL, *NOTHING)


def test_a_cell_in_which_a_joint_turns_far_is_halved(
    cell: Cell, monkeypatch: pytest.MonkeyPatch
) -> None:
    cell.cosine = 0.69
    assert cell.state(monkeypatch) == (CellState.EXTREME, *NOTHING)
    cell.set(2, 1, -0.6, -0.1, -0.1, -0.6)
    assert cell.state(monkeypatch) == (CellState.EXTREME, *NOTHING)
    cell.cosine = 0.7
    assert cell.state(monkeypatch) == (CellState.EXTREME, 2, 1)


def test_a_joint_that_all_but_turns_round_may_pass_behind(
    cell: Cell, monkeypatch: pytest.MonkeyPatch
) -> None:
    """However far inside it is at both ends."""
    cell.behind = {(3, 2)}
    cell.numbers[COS_HALF + 3] = -0.6
    assert cell.state(monkeypatch) == (CellState.FULL, *NOTHING)
    cell.numbers[COS_HALF + 3] = -0.61
    assert cell.state(monkeypatch) == (CellState.EXTREME, 3, 2)
    # Near its limits as well, and without a valley that slopes would tell of.
    cell.set(3, 0, 0.05, 0.05, 0.05, 0.05)
    assert cell.state(monkeypatch) == (CellState.EXTREME, 3, 2)
    cell.behind = set()
    assert cell.state(monkeypatch) == (CellState.FULL, *NOTHING)
    # One whose cosine is told for another place is none of these.
    cell.numbers[:] = 0.0
    cell.numbers[COS_HALF + REACH] = -2.0
    cell.behind = {(REACH, 0)}
    assert cell.state(monkeypatch) == (CellState.FULL, *NOTHING)


def test_a_valley_is_told_of_a_joint_that_turns_round_as_well(
    cell: Cell, monkeypatch: pytest.MonkeyPatch
) -> None:
    cell.numbers[COS_HALF + 3] = -0.9
    cell.set(3, 1, 0.4, 0.05, 0.05, 0.4)
    assert cell.state(monkeypatch) == (CellState.EXTREME, 3, 1)


def jumping(*jumps: float) -> Cell:
    cell = Cell()
    cell.jumps[:] = jumps
    return cell


@pytest.mark.parametrize(
    ("jumps", "cosine", "state"),
    [
        ((-1.2, -1.0, -0.9, -1.3), 1.0, CellState.DEAD),
        ((-0.6, -0.1, -0.1, -0.6), 1.0, CellState.EXTREME),
        # To the square of how far a joint turns slopes tell nothing.
        ((-0.1, -0.1, -0.1, -0.1), 0.96, CellState.DEAD),
        ((-0.1, -0.1, -0.1, -0.1), 0.94, CellState.EXTREME),
        ((-0.2, -0.1, 0.1, 0.2), 1.0, CellState.CROSSED),
        ((0.2, 0.1, -0.1, -0.2), 1.0, CellState.CROSSED),
        ((-0.2, 0.0, -0.1, -0.2), 1.0, CellState.CROSSED),
        ((0.05, 0.05, 0.05, 0.05), 0.98, CellState.FULL),
        ((0.05, 0.05, 0.05, 0.05), 0.97, CellState.EXTREME),
        # With room enough at both ends nothing is exceeded between them.
        ((0.9, 0.1, 0.1, 0.9), 0.8, CellState.FULL),
        ((0.9, 0.09, 0.2, 0.9), 0.8, CellState.EXTREME),
        ((0.9, 0.2, 0.09, 0.9), 0.8, CellState.EXTREME),
    ],
)
def test_a_joint_s_rate_decides_as_a_margin_does(
    monkeypatch: pytest.MonkeyPatch, jumps: tuple[float, ...], cosine: float, state: CellState
) -> None:
    cell = jumping(*jumps)
    cell.cosine = cosine
    assert cell.state(monkeypatch) == (state, *NOTHING)


def test_in_a_narrow_cell_a_valley_of_the_rate_is_looked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    cell = jumping(0.4, 0.05, 0.05, 0.4)
    cell.width = 3e-4
    assert cell.state(monkeypatch) == (CellState.EXTREME, JUMP, -1)
    cell.width = 3.1e-4
    assert cell.state(monkeypatch) == (CellState.EXTREME, *NOTHING)
    cell.jumps[:] = 0.09, 0.05, 0.05, 0.09
    assert cell.state(monkeypatch) == (CellState.FULL, *NOTHING)
    cell.jumps[:] = 0.1, 0.05, 0.05, 0.1
    assert cell.state(monkeypatch) == (CellState.FULL, *NOTHING)


@pytest.mark.parametrize("node", [OUTER, BEYOND])
def test_beside_the_edge_of_reach_slopes_of_the_rate_are_believed_in_narrow_cells_alone(
    monkeypatch: pytest.MonkeyPatch, node: int
) -> None:
    cell = jumping(-1.2, -1.0, -0.9, -1.3)
    cell.reaches[node] = -0.1
    assert cell.state(monkeypatch) == (CellState.EXTREME, *NOTHING)
    cell.width = 3e-4
    assert cell.state(monkeypatch) == (CellState.DEAD, *NOTHING)
    cell.width, cell.reaches[node] = 0.1, 0.0
    assert cell.state(monkeypatch) == (CellState.DEAD, *NOTHING)


def test_a_rate_that_is_crossed_does_not_hide_an_extreme(monkeypatch: pytest.MonkeyPatch) -> None:
    cell = jumping(-0.2, -0.1, 0.1, 0.2).set(2, 1, 0.4, 0.05, 0.05, 0.4)
    assert cell.state(monkeypatch) == (CellState.EXTREME, 2, 1)
    assert math.isclose(cell.margins[LEFT, 2, 1], 0.05)
