"""Cells in the order of what effort is at least in them; the cheapest without all arcs."""

import math
from typing import Any

import numpy as np
import pytest

from solver.approach.arcs.arcs import sample_angles_of, task_arcs
from solver.approach.arcs.cells import CellState
from solver.approach.arcs.effort_bound import effort_at_least, write_reference
from solver.approach.arcs.roots import arc_scratch
from solver.approach.arcs.search import open_up
from solver.approach.optimum import cheapest as module
from solver.approach.optimum.at_level import cheapest_at_level, raise_margins
from solver.approach.optimum.batch_search import (
    NO_BRANCH,
    optimise,
    path_work,
    paths_of_many,
    write_path,
)
from solver.approach.optimum.cheapest import (
    at_cusp,
    cheapest,
    cheapest_scratch,
    list_open_cells,
    take_cheapest,
)
from solver.approach.optimum.on_arcs import best_on_arcs, least_on_arcs
from solver.approach.task.constraints import BESIDE, JUMP, REACH
from solver.approach.task.task import ApproachTask
from solver.approach.uncertainty.levels import margin_levels
from solver.approach.uncertainty.robust_parts import robust_work
from solver.approach.uncertainty.robustness import approach_margin
from tests.solver.interpreted import interpreted
from tests.solver.methods.synthetic import small_task

CELLS = 72
STEP = 2 * math.pi / CELLS
TASK = small_task(2)
ROWS = len(TASK.retreats_m)


def opened(task: ApproachTask) -> Any:
    scratch = arc_scratch(len(task.retreats_m))
    open_up(task.packed(1), scratch)
    return scratch


@pytest.mark.parametrize("code", [REACH, BESIDE, JUMP, 0, 5, -1])
def test_joints_have_a_cusp_at_the_edge_of_reach_alone(code: int) -> None:
    assert interpreted(at_cusp)(code) == (code in (REACH, BESIDE))


def test_the_cheapest_cell_is_taken_and_put_last() -> None:
    cells = np.arange(15).reshape(5, 3)
    bounds = np.array([4.0, 2.0, 5.0, 1.0, 0.5])
    assert take_cheapest(cells, bounds, 4, 9.0)
    assert bounds.tolist() == [4.0, 2.0, 5.0, 1.0, 0.5]
    assert cells[3].tolist() == [9, 10, 11]
    assert take_cheapest(cells, bounds, 3, 9.0)
    # Its bound goes with it.
    assert bounds.tolist() == [4.0, 5.0, 2.0, 1.0, 0.5]
    assert cells[:3].tolist() == [[0, 1, 2], [6, 7, 8], [3, 4, 5]]
    assert not take_cheapest(cells, bounds, 2, 4.0)
    assert bounds[:2].tolist() == [4.0, 5.0]
    assert take_cheapest(cells, bounds, 2, 4.1)
    assert cells[:2].tolist() == [[6, 7, 8], [0, 1, 2]]
    assert bounds.tolist() == [5.0, 4.0, 2.0, 1.0, 0.5]
    assert not take_cheapest(cells, bounds, 0, 9.0)


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_open_cells_are_listed_with_a_bound_of_their_effort(norm: str) -> None:
    """Below the effort of every feasible angle in the cell, and often not by much."""
    task = small_task(2, norm=norm, joint_weights=(1, 2, 1, 1, 3, 1))
    scratch, most = opened(task), 2 * 4 * CELLS
    cells, bounds = np.zeros((most, 3), dtype=np.int64), np.empty(most)
    scratch.reference[:] = np.nan
    count = list_open_cells(task.packed(1), scratch, cells, bounds)
    expected = np.argwhere(scratch.open_cells)[:, [0, 1, 2]]
    assert cells[:count].tolist() == expected.tolist()
    assert count == scratch.open_cells.sum()
    # The reference is written as well, for those who split the cells.
    reference = np.empty((6, 2))
    write_reference(task.packed(1), reference)
    assert scratch.reference.tolist() == reference.tolist()
    tight = []
    for (arm, wrist, k), bound in zip(cells[:count], bounds[:count], strict=True):
        angles = -math.pi + STEP * (k + np.array([0.01, 0.3, 0.5, 0.7, 0.99]))
        margins, efforts = sample_angles_of(task, 1, angles)
        # Node k of the turn is the one before the cell.
        turns = scratch.thinning[arm]
        assert bound == effort_at_least(
            task.packed(1), reference, wrist, turns, k, turns, k + 1, turns, k + 2, turns, k + 3
        )
        own = efforts[2 * arm + wrist][margins[2 * arm + wrist] >= 0.0]
        assert np.all(own >= bound - 1e-9)
        tight += [bound / cost for cost in own]
    assert len(tight) > 10
    assert np.median(tight) > 0.5


@pytest.mark.parametrize("norm", ["l1", "l2"])
@pytest.mark.parametrize("index", [0, 3])
def test_the_cheapest_is_the_least_over_all_arcs(norm: str, index: int) -> None:
    task = small_task(index, norm=norm)
    best = least_on_arcs(task, task_arcs(task))
    assert best is not None
    scratch = cheapest_scratch(ROWS)
    angle, branch, effort, work = cheapest(task.packed(1), scratch, math.inf)
    assert effort == pytest.approx(best.effort, rel=1e-9)
    assert (branch, work > 0) == (best.arc.branch, True)
    assert math.cos(angle - best.angle_rad) == pytest.approx(1.0, abs=1e-9)
    # Nothing is below what is known already.
    again = cheapest(task.packed(1), scratch, effort)
    assert (again[1], again[2]) == (-1, effort)
    assert math.isnan(again[0])


class Listed:
    """Cells whose bounds, states and least efforts are told: each holds one piece, or none."""

    def __init__(
        self, monkeypatch: pytest.MonkeyPatch, *rows: tuple[float, CellState, float]
    ) -> None:
        self.rows = rows
        self.looked: list[tuple[int, float]] = []
        self.refined: list[tuple[int, float]] = []
        self.judged: list[int] = []
        names = ("open_up", "list_open_cells", "cell_state", "cell_pieces", "least_effort")
        for name in names:
            monkeypatch.setattr(module, name, getattr(self, f"_{name}"))
        monkeypatch.setattr(module, "take_cheapest", interpreted(take_cheapest))
        monkeypatch.setattr(module, "at_cusp", interpreted(at_cusp))

    def _open_up(self, task: object, arcs: object) -> None:
        self.opened = arcs

    def _list_open_cells(self, task: object, arcs: object, cells: np.ndarray,
                         bounds: np.ndarray) -> int:  # fmt: skip
        assert arcs is self.opened
        for n, (bound, _, _) in enumerate(self.rows):
            cells[n], bounds[n] = (n % 4, n % 2, n), bound
        return len(self.rows)

    def _cell_state(self, task: object, arcs: object, arm: int, wrist: int, k: int) -> CellState:
        assert (arcs is self.opened, arm, wrist) == (True, k % 4, k % 2)
        self.judged.append(int(k))
        return self.rows[k][1]

    def _cell_pieces(self, task: object, arcs: object, arm: int, wrist: int, k: int,
                     state: CellState, pieces: np.ndarray, start: int, count: int,
                     best: float) -> int:  # fmt: skip
        assert (arm, wrist, state) == (k % 4, k % 2, self.rows[k][1])
        assert (start, count) == (0, 0)
        self.looked.append((int(k), float(best)))
        pieces[0] = 2 * arm + wrist, k, k + 0.5, REACH, 3
        return int(self.rows[k][2] < math.inf)

    def _least_effort(self, task: object, samples: object, cell: object, own: int, low: float,
                      high: float, low_cusp: bool, high_cusp: bool,
                      best: float) -> tuple[float, float, int]:  # fmt: skip
        k = int(low)
        assert (own, high) == (2 * (k % 4) + k % 2, k + 0.5)
        assert (low_cusp, high_cusp) == (True, False)
        self.refined.append((k, float(best)))
        return low + 0.25, self.rows[k][2], 10

    def run(self, best: float) -> tuple[float, int, float, int]:
        angle, branch, effort, work = interpreted(cheapest)(TASK, cheapest_scratch(ROWS), best)
        return float(angle), int(branch), float(effort), int(work)


def test_cells_that_have_to_be_split_are_put_off_to_the_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Others first, each kind in the order of its bounds, down to what may be below the best."""
    none, extreme, edge = math.inf, CellState.EXTREME, CellState.EDGE
    listed = Listed(
        monkeypatch,
        (3.0, edge, 2.9), (1.0, extreme, 4.0), (4.0, CellState.CROSSED, 4.5),
        (2.0, CellState.FULL, 5.0), (6.0, CellState.FULL, 6.1), (2.5, CellState.DEAD, none),
        (4.4, extreme, 4.4), (2.2, edge, 3.1), (4.6, extreme, 0.0), (3.05, extreme, 3.05),
    )  # fmt: skip
    assert listed.run(10.0) == (0.25, 0, 2.9, 50)
    # Until 4.5 is known everything below; then what was put off, until it is 3.1, then 2.9.
    assert listed.looked == [(3, 10.0), (5, 5.0), (2, 5.0), (1, 4.5), (7, 4.0), (0, 3.1)]
    assert listed.refined == [(3, 10.0), (2, 5.0), (1, 4.5), (7, 4.0), (0, 3.1)]
    assert listed.judged == [1, 3, 7, 5, 0, 9, 2, 6, 1, 7, 0]


def test_where_all_cells_have_to_be_split_they_are_taken_in_their_order(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    listed = Listed(
        monkeypatch,
        (2.0, CellState.EXTREME, 2.5), (1.0, CellState.EDGE, math.inf), (3.0, CellState.EDGE, 3.0),
    )  # fmt: skip
    assert listed.run(math.inf) == (0.25, 0, 2.5, 10)
    assert listed.looked == [(1, math.inf), (0, math.inf)]
    # Nothing below what is known: none is looked at.
    listed.looked.clear()
    angle, branch, effort, work = listed.run(1.0)
    assert math.isnan(angle)
    assert (branch, effort, work) == (-1, 1.0, 0)
    assert listed.looked == []


@pytest.mark.parametrize("wished", [0.002, 0.006])
def test_at_a_level_the_cheapest_that_bears_it(wished: float) -> None:
    task = small_task(2, position_margin_m=wished)
    packed, scratch, work = task.packed(1), cheapest_scratch(ROWS), robust_work(ROWS)
    angle, branch, effort = cheapest_at_level(packed, scratch, work, wished, math.inf)
    best = best_on_arcs(task)
    assert best is not None
    plain = best_on_arcs(small_task(2))
    assert plain is not None
    if branch < 0:
        assert approach_margin(task, best.angle_rad, 1, best.arc.branch) < wished
        return
    assert approach_margin(task, angle, 1, branch) >= wished - 1e-7
    assert effort == pytest.approx(best.effort, rel=1e-6)
    assert effort >= plain.effort - 1e-12
    none = cheapest_at_level(packed, scratch, work, wished, effort * (1 - 1e-9))
    assert none[1] == -1


def raised(task: ApproachTask, known: tuple[float, int, int, float]) -> tuple[Any, ...]:
    levels = margin_levels(task.options, task.target)
    angles, sides, branches, efforts = (np.array([one]) for one in known)
    margins, moved = np.empty(1), np.empty(1, dtype=np.bool_)
    raise_margins(
        task.numbers_by_side[:, None], *task.packed(1)[1:], np.array([levels]),
        angles, sides, branches, efforts, margins, moved,
    )  # fmt: skip
    return angles[0], sides[0], branches[0], efforts[0], margins[0], bool(moved[0])


@pytest.mark.parametrize("wished", [1e-6, 0.004])
def test_an_optimum_that_bears_less_than_it_might_is_replaced(wished: float) -> None:
    plain = small_task(2, symmetric_tool=True)
    task = small_task(2, symmetric_tool=True, position_margin_m=wished)
    best, wanted = best_on_arcs(plain), best_on_arcs(task)
    assert best is not None
    assert wanted is not None
    known = best.angle_rad, best.arc.tool_side, best.arc.branch, best.effort
    margin = approach_margin(task, *known[:3])
    angle, side, branch, effort, borne, moved = raised(task, known)
    assert moved == (margin < wished)
    assert effort == pytest.approx(wanted.effort, rel=1e-6)
    assert (side, branch) == (wanted.arc.tool_side, wanted.arc.branch)
    assert borne == pytest.approx(approach_margin(task, angle, side, branch), rel=1e-9)
    if not moved:
        assert (angle, effort) == (best.angle_rad, best.effort)


def test_what_cannot_bear_what_is_needed_has_no_branch() -> None:
    from dataclasses import replace

    task = small_task(2)
    uncertain = replace(task, target=replace(task.target, position_std_m=0.2))
    best = best_on_arcs(task)
    assert best is not None
    found = raised(uncertain, (best.angle_rad, 1, best.arc.branch, best.effort))
    assert found[2] == -1
    assert not found[5]
    untouched = raised(uncertain, (0.1, 1, -1, math.inf))
    assert (untouched[2], untouched[5]) == (-1, False)
    assert math.isnan(untouched[4])


@pytest.mark.parametrize("sent", [np.array([0.04, 0.0]), np.linspace(0.04, 0.0, 5)])
def test_paths_are_those_of_the_closed_form(sent: np.ndarray) -> None:
    best = best_on_arcs(TASK)
    assert best is not None
    branch, path = best.arc.branch, np.full((len(sent), 6), np.nan)
    suspicious = write_path(
        TASK.packed(1), best.angle_rad, branch, sent, path_work(ROWS, len(sent)), path
    )
    expected = TASK.postures(best.angle_rad, 1, branch, sent)
    assert path == pytest.approx(expected, abs=1e-9)
    assert not suspicious
    numbers, joints = TASK.packed(1).numbers[None], np.full((1, len(sent), 6), np.nan)
    flags = np.ones(1, dtype=np.bool_)
    paths_of_many(
        numbers, np.array([branch]), np.array([best.angle_rad]), *TASK.packed(1)[1:], sent,
        joints, flags,
    )  # fmt: skip
    assert joints[0].tolist() == path.tolist()
    assert not flags[0]


def test_optima_of_targets_with_and_without_an_approach() -> None:
    near, far = small_task(2, symmetric_tool=True), TASK.numbers_by_side
    from solver.approach.task.packed import COLUMNS

    away = near.numbers_by_side.copy()
    away[:, COLUMNS["position"] : COLUMNS["position"] + 3] *= 9.0
    numbers = np.stack((away, near.numbers_by_side), axis=1)
    n, sent = 2, np.array([0.04, 0.0])
    angles, efforts, paths = np.empty(n), np.empty(n), np.empty((n, 2, 6))
    sides, branches, refined = (np.empty(n, dtype=np.int64) for _ in range(3))
    suspicious = np.ones(n, dtype=np.bool_)
    optimise(
        numbers, *near.packed(1)[1:], sent, angles, sides, branches, efforts, paths, suspicious,
        refined,
    )  # fmt: skip
    best = best_on_arcs(near)
    assert best is not None
    assert NO_BRANCH == -1
    assert (branches[0], efforts[0], bool(suspicious[0])) == (NO_BRANCH, math.inf, False)
    assert np.isnan(paths[0]).all()
    assert math.isnan(angles[0])
    assert (branches[1], sides[1]) == (best.arc.branch, best.arc.tool_side)
    assert efforts[1] == pytest.approx(best.effort, rel=1e-9)
    assert refined[1] > 0
    expected = near.postures(float(angles[1]), int(sides[1]), int(branches[1]), sent)
    assert paths[1] == pytest.approx(expected, abs=1e-9)
    assert far.shape == (1, numbers.shape[2])
    assert module.CheapestScratch._fields[0] == "arcs"
