"""Cells in the order of what effort is at least in them; the cheapest without all arcs."""

import math
from typing import Any

import numpy as np
import pytest

from solver.approach.arcs.arcs import sample_angles_of, task_arcs
from solver.approach.arcs.roots import arc_scratch
from solver.approach.arcs.search import open_up
from solver.approach.arcs.turns import TURN_ROWS
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
    angle_of_cosine,
    at_cusp,
    cheapest,
    cheapest_scratch,
    effort_at_least,
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


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.5, 1.5, 3.0, math.pi])
def test_an_angle_from_its_cosine(angle: float) -> None:
    tolerance = 1e-7 if angle in (1e-9, math.pi) else 1e-12
    found = interpreted(angle_of_cosine)(math.cos(angle))
    assert found == pytest.approx(angle, abs=tolerance)
    assert interpreted(angle_of_cosine)(1.0 + 1e-16) == 0.0


def test_the_cheapest_cell_is_taken_and_put_last() -> None:
    cells = np.arange(15).reshape(5, 3)
    bounds = np.array([4.0, 2.0, 5.0, 1.0, 0.5])
    assert take_cheapest(cells, bounds, 4, 9.0)
    assert bounds.tolist() == [4.0, 2.0, 5.0, 1.0, 0.5]
    assert cells[3].tolist() == [9, 10, 11]
    assert take_cheapest(cells, bounds, 3, 9.0)
    assert bounds[:2].tolist() == [4.0, 5.0]
    assert cells[:3].tolist() == [[0, 1, 2], [6, 7, 8], [3, 4, 5]]
    assert not take_cheapest(cells, bounds, 2, 4.0)
    assert take_cheapest(cells, bounds, 2, 4.1)
    assert cells[:2].tolist() == [[6, 7, 8], [0, 1, 2]]
    assert not take_cheapest(cells, bounds, 0, 9.0)


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_open_cells_are_listed_with_a_bound_of_their_effort(norm: str) -> None:
    """Below the effort of every feasible angle in the cell, and often not by much."""
    task = small_task(2, norm=norm, joint_weights=(1, 2, 1, 1, 3, 1))
    scratch, most = opened(task), 2 * 4 * CELLS
    cells, bounds = np.zeros((most, 3), dtype=np.int64), np.empty(most)
    reference = np.empty((6, 2))
    count = list_open_cells(
        task.packed(1), scratch.open_cells, scratch.thinning, reference, cells, bounds
    )
    expected = np.argwhere(scratch.open_cells)[:, [0, 1, 2]]
    assert cells[:count].tolist() == expected.tolist()
    assert count == scratch.open_cells.sum()
    # Of the tabletop's, whose joints have no offsets but where the robot's file says.
    assert np.hypot(reference[:, 0], reference[:, 1]) == pytest.approx(np.ones(6))
    tight = []
    for (arm, wrist, k), bound in zip(cells[:count], bounds[:count], strict=True):
        angles = -math.pi + STEP * (k + np.array([0.01, 0.3, 0.5, 0.7, 0.99]))
        margins, efforts = sample_angles_of(task, 1, angles)
        own = efforts[2 * arm + wrist][margins[2 * arm + wrist] >= 0.0]
        assert np.all(own >= bound - 1e-9)
        tight += [bound / cost for cost in own]
    assert len(tight) > 10
    assert np.median(tight) > 0.5


def still(turns: np.ndarray, i: int, *angles: float) -> None:
    turns[2 * i], turns[2 * i + 1] = np.cos(angles), np.sin(angles)


@pytest.mark.parametrize("squared", [False, True])
def test_a_bound_by_hand(squared: bool) -> None:
    """One joint turns, the others are where the reference is."""
    task = small_task(2, norm="l2" if squared else "l1", joint_weights=(1, 1, 1, 1, 1, 5))
    turns, reference = np.ones((TURN_ROWS, 8)), np.tile([1.0, 0.0], (6, 1))
    for i in range(6):
        still(turns, i, *[0.0] * 8)

    def bound(*angles: float, wrist: int = 0) -> float:
        still(turns, 5, 0.0, 0.0, *angles, 0.0, 0.0)
        return float(effort_at_least(task.packed(1), turns, reference, wrist, 2))

    def cost(travel: float) -> float:
        return 5 * (travel**2 if squared else travel)

    # Half of what it turns, in the cell or beside it, is taken from the nearer end.
    assert bound(0.9, 1.0, 1.1, 1.2) == pytest.approx(cost(1.0 - 0.05))
    assert bound(0.6, 1.0, 1.1, 1.2) == pytest.approx(cost(1.0 - 0.2))
    assert bound(0.9, 1.0, 1.1, 1.5) == pytest.approx(cost(1.0 - 0.2))
    assert bound(0.9, 1.2, 1.0, 1.1) == pytest.approx(cost(1.0 - 0.15))
    assert bound(0.0, 0.05, 0.2, 0.2) == 0.0
    # The other wrist has its joints 4 and 6 half a turn further: here all of them.
    other = bound(0.9, 1.0, 1.1, 1.2, wrist=1)
    assert other == pytest.approx(cost(math.pi - 1.1 - 0.05) + bound_of_half_turn(squared))
    # A joint that swings says nothing; nor may it at the edge of reach by half alone.
    assert bound(0.9, 1.0, 1.9, 2.0) == 0.0
    turns[6 + REACH, 3:] = -1.0
    turns[6 + REACH, 3] = 1.0
    assert bound(0.9, 1.0, 1.1, 1.2) == pytest.approx(cost(1.0 - 0.1))


def bound_of_half_turn(squared: bool) -> float:
    """Joint 4, with a weight of one, half a turn from where the reference is."""
    return math.pi**2 if squared else math.pi


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
