"""Arcs of a whole turn: from cells whose pieces are told, and of a task against a sweep."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from solver.approach.arcs import search
from solver.approach.arcs.arcs import sample_angles_of, task_arcs
from solver.approach.arcs.cells import ARC_NODES, CellState
from solver.approach.arcs.effort_bound import write_reference
from solver.approach.arcs.many import arcs_of_many
from solver.approach.arcs.roots import arc_scratch
from solver.approach.arcs.search import (
    cell_pieces,
    cell_state,
    close_turn,
    find_arcs,
    know_margins,
    know_path,
    open_up,
    turns_at_nodes,
)
from solver.approach.arcs.splitting import ARC_COLUMNS, MOST_ARCS, append_arc
from solver.approach.arcs.turns import CONSTRAINTS, TURN_ROWS, path_margins, turns_along_path
from solver.approach.task.constraints import JUMP, REACH, WHOLE_TURN
from solver.approach.task.task import ApproachTask
from tests.solver.interpreted import interpreted
from tests.solver.methods.synthetic import small_task

CELLS = 72
STEP = 2 * math.pi / CELLS
SMALL = small_task(2)
TASK = SMALL.packed(1)
ROWS = len(TASK.retreats)


def arcs_of(task: ApproachTask) -> np.ndarray:
    arcs = np.full((MOST_ARCS, ARC_COLUMNS), np.nan)
    return arcs[: find_arcs(task.packed(1), arc_scratch(len(task.retreats_m)), arcs)]


@pytest.mark.parametrize("index", [0, 3])
def test_arcs_of_a_task_are_the_feasible_angles_of_a_sweep(index: int) -> None:
    task = small_task(index)
    angles = -np.pi + 2 * np.pi * (np.arange(180) + 0.5) / 180
    margins, _ = sample_angles_of(task, 1, angles)
    arcs = arcs_of(task)
    assert len(arcs) > 0
    for branch in range(8):
        claimed = np.zeros(len(angles), dtype=np.bool_)
        for _, low, high, *_ in arcs[arcs[:, 0] == branch]:
            claimed |= np.remainder(angles - low, 2 * np.pi) <= high - low
        assert np.array_equal(claimed, margins[branch] >= 0.0)
    for branch, low, high, by_low, by_high in arcs:
        beside = np.array([low - 1e-6, low + 1e-9, high - 1e-9, high + 1e-6])
        ends, _ = sample_angles_of(task, 1, beside)
        assert (ends[int(branch)] >= -1e-9).tolist() == [False, True, True, False]
        assert {by_low, by_high} <= {0, 1, 2, 3, 4, 5, REACH, REACH + 1, JUMP}


def test_many_targets_are_found_one_by_one() -> None:
    tasks = [small_task(k, symmetric_tool=True) for k in (0, 2)]
    numbers = np.stack([one.numbers_by_side for one in tasks], axis=1)
    table = arcs_of_many(numbers, TASK.retreats, TASK.cos_steps)
    expected = []
    for k, task in enumerate(tasks):
        for place, side in enumerate((1, -1)):
            arcs = np.empty((MOST_ARCS, ARC_COLUMNS))
            count = find_arcs(task.packed(side), arc_scratch(ROWS), arcs)
            expected += [[k, place, *arc] for arc in arcs[:count].tolist()]
    assert table.tolist() == expected
    assert {row[1] for row in expected} == {0, 1}


def test_a_table_of_arcs_grows(monkeypatch: pytest.MonkeyPatch) -> None:
    from solver.approach.arcs import many

    def found(task: object, scratch: object, arcs: np.ndarray) -> int:
        arcs[:60] = np.arange(60)[:, None]
        return 60

    monkeypatch.setattr(many, "find_arcs", found)
    monkeypatch.setattr(many, "arc_scratch", lambda rows: None)
    table = interpreted(arcs_of_many)(np.zeros((2, 9, 3)), TASK.retreats, TASK.cos_steps)
    assert table.shape == (2 * 9 * 60, 2 + ARC_COLUMNS)
    assert table[:, 0].tolist() == np.repeat(np.arange(9), 120).tolist()
    assert table[:, 1].tolist() == np.tile(np.repeat([0, 1], 60), 9).tolist()
    assert table[:, 2].tolist() == np.tile(np.arange(60), 18).tolist()


def arcs_from(*rows: tuple[float, ...]) -> np.ndarray:
    arcs = np.full((MOST_ARCS, ARC_COLUMNS), np.nan)
    for k, row in enumerate(rows):
        arcs[k] = row
    return arcs


def test_arcs_at_both_sides_of_the_half_turn_are_one() -> None:
    other = (3.0, -math.pi, math.pi, 1.0, 2.0)
    arcs = arcs_from(
        other, (5.0, -math.pi, -3.0, 1.0, 2.0), (5.0, 0.0, 0.5, 3.0, 4.0),
        (5.0, 2.5, math.pi, 0.0, 6.0),
    )  # fmt: skip
    assert close_turn(arcs, 1, 4) == 3
    assert arcs[:3].tolist() == [
        list(other), [5.0, 0.0, 0.5, 3.0, 4.0], [5.0, 2.5, -3.0 + 2 * math.pi, 0.0, 2.0],
    ]  # fmt: skip


@pytest.mark.parametrize(
    "rows",
    [
        [(5.0, -math.pi, -3.0, 1.0, 2.0), (5.0, 2.5, 3.1, 0.0, 6.0)],
        [(5.0, -3.1, -3.0, 1.0, 2.0), (5.0, 2.5, math.pi, 0.0, 6.0)],
        [(5.0, -3.1, math.pi, 1.0, 2.0)],
        [],
    ],
)
def test_arcs_that_do_not_meet_there_stay(rows: list[tuple[float, ...]]) -> None:
    arcs = arcs_from(*rows)
    assert close_turn(arcs, 0, len(rows)) == len(rows)
    assert arcs[: len(rows)].tolist() == [list(row) for row in rows]


def test_a_whole_turn_is_ended_by_nothing() -> None:
    arcs = arcs_from((2.0, -math.pi, math.pi, 1.0, 2.0))
    assert close_turn(arcs, 0, 1) == 1
    assert arcs[0].tolist() == [2.0, -math.pi, math.pi, WHOLE_TURN, WHOLE_TURN]


def test_nodes_are_ends_of_cells_and_one_beyond_at_each_side() -> None:
    turns, one = np.empty((TURN_ROWS, ARC_NODES)), np.empty((TURN_ROWS, 24))
    turns_at_nodes(TASK, TASK.retreats[2], 1, turns)
    for n in (0, 1, 30, CELLS, CELLS + 1, CELLS + 2):
        turns_along_path(TASK, -math.pi + STEP * (n - 1), 1, one)
        assert turns[:14, n] == pytest.approx(one[:14, 2], abs=1e-12)


def test_what_is_known_of_a_node_is_not_computed_again() -> None:
    paths, known = np.zeros((CELLS, TURN_ROWS, 24)), np.zeros(CELLS, dtype=np.bool_)
    margins, known_margins = np.zeros((CELLS, CONSTRAINTS)), np.zeros(CELLS, dtype=np.bool_)
    know_path(TASK, 1, 7, paths, known)
    one, least = np.empty((TURN_ROWS, 24)), np.empty(CONSTRAINTS)
    turns_along_path(TASK, -math.pi + STEP * 7, 1, one)
    assert paths[7, :14] == pytest.approx(one[:14])
    assert np.flatnonzero(known).tolist() == [7]
    know_margins(TASK, 1, 7, paths, margins, known_margins)
    path_margins(TASK, one, 1, least)
    assert margins[7] == pytest.approx(least)
    assert np.flatnonzero(known_margins).tolist() == [7]
    paths[7], margins[7] = 5.0, 5.0
    know_path(TASK, 1, 7, paths, known)
    know_margins(TASK, 1, 7, paths, margins, known_margins)
    assert np.all(paths[7] == 5.0)
    assert np.all(margins[7] == 5.0)


def test_a_new_task_forgets_the_one_before_and_closes_what_cannot_hold() -> None:
    scratch = arc_scratch(ROWS)
    scratch.known_paths[:], scratch.known_margins[:] = True, True
    scratch.open_cells[:] = False
    open_up(TASK, scratch)
    assert not scratch.known_paths.any()
    assert not scratch.known_margins.any()
    share = scratch.open_cells.mean()
    assert 0.0 < share < 0.5
    for branch, low, high, *_ in arcs_of(SMALL):
        for angle in np.linspace(low + 1e-9, high - 1e-9, 9):
            k = math.floor((np.remainder(angle + math.pi, 2 * math.pi)) / STEP)
            assert scratch.open_cells[int(branch) // 2, int(branch) % 2, k]
    # What the standby posture closes is closed too.
    near = TASK._replace(retreats=np.array([1e-9, 0.0]), cos_steps=TASK.cos_steps[:1])
    other = arc_scratch(2)
    open_up(near, other)
    assert other.open_cells.sum() > scratch.open_cells.sum()


def test_a_target_out_of_reach_has_no_open_cell() -> None:
    far = SMALL.packed(1).numbers.copy()
    from solver.approach.task.packed import COLUMNS

    far[COLUMNS["position"] : COLUMNS["position"] + 3] *= 9.0
    scratch = arc_scratch(ROWS)
    open_up(TASK._replace(numbers=far), scratch)
    assert not scratch.open_cells.any()


class Pieces:
    """One cell whose state, and what it is tightened and split to, are told."""

    def __init__(
        self, monkeypatch: pytest.MonkeyPatch, state: CellState, tight: Any = None
    ) -> None:
        self.asked: list[tuple[Any, ...]] = []
        self.nodes: list[int] = []
        self.state = state
        monkeypatch.setattr(search, "know_path", lambda task, arm, k, *_: self.nodes.append(k))
        monkeypatch.setattr(
            search, "know_margins", lambda task, wrist, k, *_: self.nodes.append(-k)
        )
        monkeypatch.setattr(search, "append_arc", interpreted(append_arc))

        def path_state(task: object, wrist: int, width: float, *given: int) -> Any:
            assert width == STEP
            self.given = given
            return state, -1, 0

        def tighten(task: object, scratch: object, *given: Any) -> Any:
            self.asked.append(("tighten", *given))
            return tight

        def settle(task: object, scratch: object, *given: Any) -> int:
            self.asked.append(("settle", *given[:6], given[-1]))
            return 99

        monkeypatch.setattr(search, "path_state", path_state)
        monkeypatch.setattr(search, "tighten", tighten)
        monkeypatch.setattr(search, "settle", settle)

        paths = [[f"{arm}p{n}" for n in range(CELLS)] for arm in range(4)]
        margins = np.arange(4 * 2 * CELLS).reshape(4, 2, CELLS)
        self.scratch = SimpleNamespace(
            paths=paths, known_paths=[None] * 4, margins=margins, known_margins=margins
        )

    def judged(self, k: int) -> CellState:
        return CellState(interpreted(cell_state)(TASK, self.scratch, 2, 1, k))

    def run(self, k: int, best: float = math.inf) -> tuple[int, list[float]]:
        """Of a cell that was judged before: no node is asked for again."""
        known = list(self.nodes)
        arcs = np.zeros((MOST_ARCS, ARC_COLUMNS))
        count = interpreted(cell_pieces)(TASK, self.scratch, 2, 1, k, self.state, arcs, 0, 0, best)
        assert self.nodes == known
        return count, arcs[0].tolist()


@pytest.mark.parametrize("k", [0, 10, CELLS - 2, CELLS - 1])
def test_a_cell_is_judged_by_its_ends_and_the_nodes_beside_them(
    monkeypatch: pytest.MonkeyPatch, k: int
) -> None:
    pieces = Pieces(monkeypatch, CellState.FULL)
    assert pieces.judged(k) == CellState.FULL
    low, high = -math.pi + STEP * k, -math.pi + STEP * (k + 1)
    assert pieces.run(k) == (1, [5.0, pytest.approx(low), pytest.approx(high), JUMP, JUMP])
    outer, left, right, beyond = ((k + off) % CELLS for off in (-1, 0, 1, 2))
    assert pieces.nodes == [outer, left, right, beyond, -left, -right]
    names = tuple(f"2p{n}" for n in (outer, left, right, beyond))
    assert pieces.given == (*names, (2 * 2 + 1) * CELLS + left, (2 * 2 + 1) * CELLS + right)
    for state in CellState:
        assert Pieces(monkeypatch, state).judged(k) == state


def test_dead_cells_hold_nothing_and_others_are_split(monkeypatch: pytest.MonkeyPatch) -> None:
    dead = Pieces(monkeypatch, CellState.DEAD)
    assert dead.run(9)[0] == 0
    assert dead.asked == []
    split = Pieces(monkeypatch, CellState.EXTREME)
    assert split.run(9)[0] == 99
    ends = pytest.approx(-math.pi + STEP * 9), pytest.approx(-math.pi + STEP * 10)
    assert split.asked == [("settle", 2, 1, *ends, JUMP, JUMP, math.inf)]
    split.asked.clear()
    assert split.run(9, 3.5)[0] == 99
    assert split.asked == [("settle", 2, 1, *ends, JUMP, JUMP, 3.5)]


@pytest.mark.parametrize("state", [CellState.CROSSED, CellState.EDGE])
def test_crossed_cells_are_tightened(monkeypatch: pytest.MonkeyPatch, state: CellState) -> None:
    """Kept if that behaves, but where only the reach was looked at; split if it does not."""
    is_edge = state == CellState.EDGE
    pieces = Pieces(monkeypatch, state, (True, 0.2, 0.3, 3, 4))
    count, arc = pieces.run(9, 3.5)
    tightened = pieces.asked[0]
    low, high = -math.pi + STEP * 9, -math.pi + STEP * 10
    assert tightened[:5] == ("tighten", 2, 1, *((REACH, JUMP) if is_edge else (0, CONSTRAINTS)))
    assert tightened[5:9] == (pytest.approx(low), pytest.approx(high), "2p9", "2p10")
    if is_edge:
        assert count == 99
        assert pieces.asked[1] == ("settle", 2, 1, 0.2, 0.3, 3, 4, 3.5)
    else:
        assert (count, arc) == (1, [5.0, 0.2, 0.3, 3.0, 4.0])
    # Margins of the branch's own, at both ends of the cell; of the last cell too.
    own = (2 * 2 + 1) * CELLS
    assert tightened[9:] == (own + 9, own + 10)
    pieces.run(CELLS - 1)
    tightened = next(one for one in reversed(pieces.asked) if one[0] == "tighten")
    assert tightened[7:] == (f"2p{CELLS - 1}", "2p0", own + CELLS - 1, own)
    for low, high in ((0.3, 0.3), (0.4, 0.3)):
        assert Pieces(monkeypatch, state, (True, low, high, 3, 4)).run(9)[0] == 0
    unclean = Pieces(monkeypatch, state, (False, 0.3, 0.2, 3, 4))
    assert unclean.run(9, 3.5)[0] == 99
    assert unclean.asked[1][0] == "settle"
    assert unclean.asked[1][3] == pytest.approx(-math.pi + STEP * 9)
    assert unclean.asked[1][7] == 3.5


def test_all_open_cells_of_all_branches_are_looked_at(monkeypatch: pytest.MonkeyPatch) -> None:
    scratch = SimpleNamespace(open_cells=np.zeros((4, 2, CELLS), dtype=np.bool_))
    looked: list[tuple[int, ...]] = []
    states = {(0, 71): CellState.FULL, (3, 0): CellState.DEAD, (7, 4): CellState.EDGE}

    def opened(task: object, given: Any) -> None:
        given.open_cells[0, 0, 71] = given.open_cells[1, 1, 0] = given.open_cells[3, 1, [4, 9]] = (
            True
        )

    def judged(task: object, given: object, arm: int, wrist: int, k: int) -> CellState:
        assert given is scratch
        return states.get((2 * arm + wrist, k), CellState.EXTREME)

    def pieces(task: object, given: object, arm: int, wrist: int, k: int, state: CellState,
               arcs: object, start: int, count: int, best: float) -> int:  # fmt: skip
        assert state == judged(task, given, arm, wrist, k)
        # All arcs are wanted, whatever they cost.
        assert best == math.inf
        looked.append((arm, wrist, k, start, count))
        return count + 2

    closed: list[tuple[int, int]] = []
    monkeypatch.setattr(search, "open_up", opened)
    monkeypatch.setattr(search, "cell_state", judged)
    monkeypatch.setattr(search, "cell_pieces", pieces)

    def close(arcs: object, start: int, count: int) -> int:
        closed.append((start, count))
        return count

    monkeypatch.setattr(search, "close_turn", close)
    assert interpreted(find_arcs)(TASK, scratch, np.zeros((MOST_ARCS, 5))) == 8
    assert looked == [(0, 0, 71, 0, 0), (1, 1, 0, 2, 2), (3, 1, 4, 4, 4), (3, 1, 9, 4, 6)]
    assert closed == [(0, 2), (2, 2), (2, 2), (2, 4), (4, 4), (4, 4), (4, 4), (4, 8)]


@pytest.mark.parametrize("share", [1.001, 1.2])
@pytest.mark.parametrize("index", [0, 2])
def test_only_what_costs_at_least_the_best_is_left_out(index: int, share: float) -> None:
    """Every angle of less effort stays in the pieces; without a best no reference is looked at."""
    task = small_task(index)
    packed, scratch = task.packed(1), arc_scratch(len(task.retreats_m))
    scratch.reference[:] = np.nan
    open_up(packed, scratch)

    def pieces_of(best: float) -> dict[tuple[int, int], np.ndarray]:
        found = {}
        for arm, wrist, k in np.argwhere(scratch.open_cells):
            arcs = np.full((MOST_ARCS, ARC_COLUMNS), np.nan)
            state = cell_state(packed, scratch, arm, wrist, k)
            count = cell_pieces(packed, scratch, arm, wrist, k, state, arcs, 0, 0, best)
            found[int(2 * arm + wrist), int(k)] = arcs[:count]
        return found

    every = pieces_of(math.inf)
    write_reference(packed, scratch.reference)
    angles = {
        cell: np.concatenate([np.linspace(low, high, 9) for _, low, high, *_ in pieces])
        for cell, pieces in every.items()
        if len(pieces) > 0
    }
    efforts = {cell: sample_angles_of(task, 1, one)[1][cell[0]] for cell, one in angles.items()}
    best = share * min(one.min() for one in efforts.values())
    kept, left_out, cheaper = pieces_of(best), 0, 0
    for cell, own in angles.items():
        for _, low, high, *_ in kept[cell]:
            assert any(a <= low and high <= b for _, a, b, *_ in every[cell])
        inside = np.zeros(len(own), dtype=np.bool_)
        for _, low, high, *_ in kept[cell]:
            inside |= (low <= own) & (own <= high)
        assert inside[efforts[cell] < best].all()
        cheaper += int(np.count_nonzero(efforts[cell] < best))
        left_out += int(np.count_nonzero(~inside))
    assert cheaper > 0
    assert left_out > 0


def test_task_arcs_are_named_after_what_ends_them() -> None:
    names = (*SMALL.robot.joint_names, "reach", "reach", "wrist_jump")
    for arc, row in zip(task_arcs(SMALL), arcs_of(SMALL), strict=True):
        assert (arc.tool_side, arc.branch) == (1, row[0])
        assert (arc.lower_rad, arc.upper_rad) == (row[1], row[2])
        assert (arc.lower_limit, arc.upper_limit) == (names[int(row[3])], names[int(row[4])])
