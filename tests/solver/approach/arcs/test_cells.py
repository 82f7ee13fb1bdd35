"""Cells of approach angles: what is closed holds nothing, and what is full holds nothing else."""

import math

import numpy as np
import pytest

from solver import Options, Problem, Robot
from solver.approach.arcs.cells import (
    ARC_NODES,
    CellState,
    any_cell_reached,
    close_cells,
    enters_reach,
    least_reach,
    lower_highest,
    path_state,
    peak_above,
    swung,
)
from solver.approach.arcs.search import turns_at_nodes
from solver.approach.arcs.turns import (
    CONSTRAINTS,
    ROW_CONSTRAINTS,
    TURN_ROWS,
    path_columns,
    path_margins,
    row_constraints,
    turns_along_path,
    turns_at_angles,
)
from solver.approach.task.constraints import BESIDE, REACH
from solver.approach.task.task import ApproachTask, approach_task
from solver.approach.tolerances import ARC_CELLS
from tests.solver.approach.targets import near_straight_wrists, near_the_edge_of_reach
from tests.solver.interpreted import interpreted
from tests.solver.methods.synthetic import ROBOT, small_task

STEP = 2 * math.pi / ARC_CELLS


def test_twelfths_of_thirty_degrees_are_cells() -> None:
    """Five degrees each; a node beyond each side of the turn."""
    assert ARC_CELLS == 72
    assert ARC_NODES == 75
    names = ["DEAD", "FULL", "CROSSED", "EXTREME", "EDGE"]
    assert {state.name: int(state) for state in CellState} == dict(
        zip(names, range(5), strict=True)
    )


@pytest.mark.parametrize("top", [-0.9, 0.0, 0.2, 0.5, 0.8, 1.0, 1.7])
@pytest.mark.parametrize("height", [-1.0, 2.0])
def test_a_peak_is_below_where_the_lines_beside_it_meet(top: float, height: float) -> None:
    """Of a parabola, whose values at -1, 0, 1 and 2 are known."""
    before, left, right, after = (height - (x - top) ** 2 for x in (-1, 0, 1, 2))
    peak = interpreted(peak_above)(before, left, right, after)
    assert peak >= max(left, right)
    if 0.0 < top < 1.0:
        assert peak >= height
        rise, fall = left - before, right - after
        met = (right - left + fall) / (rise + fall)
        assert peak == pytest.approx(left + rise * met)
    if top < -0.5 or top > 1.5:
        assert peak == max(left, right)


def test_lines_that_meet_outside_the_cell_say_nothing() -> None:
    peak = interpreted(peak_above)
    assert peak(-9.0, 1.0, 2.0, 1.9) == pytest.approx(2.1, abs=0.2)
    assert peak(0.9, 1.0, 9.0, 0.0) == pytest.approx(1.1)
    assert peak(2.0, 1.0, 3.0, 2.0) == 3.0
    assert peak(0.0, 3.0, 1.0, 4.0) == 3.0


def turns_at(task: ApproachTask, angle: float, arm: int) -> np.ndarray:
    turns = np.empty((TURN_ROWS, int(interpreted(path_columns)(len(task.retreats_m)))))
    turns_along_path(task.packed(1), angle, arm, turns)
    return turns


def margins_of(task: ApproachTask, turns: np.ndarray, wrist: int) -> np.ndarray:
    margins = np.empty(CONSTRAINTS)
    path_margins(task.packed(1), turns, wrist, margins)
    return margins


def test_reach_is_entered_where_a_reach_margin_changes_its_sign() -> None:
    left, right = np.ones((TURN_ROWS, 3)), np.ones((TURN_ROWS, 3))
    assert not enters_reach(left, 1, right, 2)
    for row in (6 + REACH, 6 + BESIDE):
        right[row, 2] = -0.1
        assert enters_reach(left, 1, right, 2)
        assert not enters_reach(left, 1, right, 1)
        left[row, 1] = -0.2
        assert not enters_reach(left, 1, right, 2)
        left[row, 1], right[row, 2] = 0.0, 0.0
        assert not enters_reach(left, 1, right, 2)
    left[6 + REACH], left[6 + BESIDE] = (0.3, 0.2, -1.0), (0.1, 0.5, -2.0)
    assert least_reach(left, 2) == 0.1
    assert least_reach(left, 1) == 0.1
    assert least_reach(left, 3) == -2.0
    left[6 + REACH, 1] = 0.05
    assert least_reach(left, 2) == 0.05


@pytest.mark.parametrize(
    ("turn", "expected"), [(0.5, False), (0.79, False), (0.8, True), (2.0, True)]
)
def test_a_joint_swings_that_turns_by_eight_tenths(turn: float, expected: bool) -> None:
    left, right = np.zeros((TURN_ROWS, 2)), np.zeros((TURN_ROWS, 2))
    left[6, 1], left[7, 1] = math.cos(0.3), math.sin(0.3)
    right[6, 0], right[7, 0] = math.cos(0.3 + turn), math.sin(0.3 + turn)
    assert swung(left, 1, right, 0, 3) == expected


def test_a_turn_without_reach_is_told() -> None:
    """The reach of a cell counts with what it may have between its nodes."""
    values, highest = np.full((ROW_CONSTRAINTS, ARC_NODES), -1.0), np.empty((3, ARC_CELLS))
    assert not any_cell_reached(values, highest)
    values[0] = 1.0
    assert not any_cell_reached(values, highest)
    values[1, 30] = 0.5
    assert any_cell_reached(values, highest)
    assert np.flatnonzero(highest[0] >= 0.0).tolist() == [28, 29]
    # A peak between two nodes, from the slopes beside them.
    values[1, 30] = -1.0
    values[1, 40:44] = -0.9, -0.1, -0.1, -0.9
    assert any_cell_reached(values, highest)
    assert np.flatnonzero(highest[0] >= 0.0).tolist() == [40]
    assert highest[0, 40] == pytest.approx(0.3)


def test_what_is_highest_is_lowered_only_where_a_margin_is_smooth() -> None:
    turns, margins = np.ones((TURN_ROWS, ARC_NODES)), np.full(ARC_NODES, -1.0)
    turns[4], turns[5] = 1.0, 0.0

    def lowered(i: int) -> np.ndarray:
        highest = np.full(ARC_CELLS, 0.5)
        lower_highest(turns, margins, i, highest)
        return highest

    assert lowered(2).tolist() == [-1.0] * ARC_CELLS
    # Where it is not below zero at both ends it says nothing.
    margins[20] = 0.1
    assert np.flatnonzero(lowered(2) == 0.0).tolist() == [18, 19]
    margins[20] = -1.0
    # A joint that swings, and the edge of reach, where it has a cusp.
    turns[4, 50], turns[5, 50] = 0.0, 1.0
    assert np.flatnonzero(lowered(2) == 0.0).tolist() == [48, 49]
    assert lowered(-1).tolist() == [-1.0] * ARC_CELLS
    for row in (6 + REACH, 6 + BESIDE):
        turns[4, 50], turns[5, 50], turns[6 + REACH], turns[6 + BESIDE] = 1.0, 0.0, 1.0, 1.0
        turns[row, 60:] = -1.0
        assert np.flatnonzero(lowered(2) == 0.0).tolist() == [58]
        assert lowered(-1).tolist() == [-1.0] * ARC_CELLS


def hard_task(made, robot: Robot, k: int) -> ApproachTask:  # type: ignore[no-untyped-def]
    problem = Problem(robot, made(robot, k + 1), options=Options(position_margin_m=0.0))
    return approach_task(problem, problem.targets[k], problem.start)


TASKS = {
    "data set": small_task(3),
    "straight wrist": hard_task(near_straight_wrists, ROBOT, 1),
    "edge of reach": hard_task(near_the_edge_of_reach, ROBOT, 1),
}


@pytest.mark.parametrize("name", TASKS)
def test_states_are_what_a_sweep_of_the_cell_says(name: str) -> None:
    """No angle is feasible in a dead cell, all are in a full one."""
    task, states = TASKS[name], set()
    packed = task.packed(1)
    for arm in range(4):
        nodes = [turns_at(task, -math.pi + STEP * k, arm) for k in range(ARC_CELLS)]
        for wrist in range(2):
            ends = [margins_of(task, turns, wrist) for turns in nodes]
            for k in range(0, ARC_CELLS, 2):
                around = [(k + off) % ARC_CELLS for off in (-1, 0, 1, 2)]
                outer, left, right, beyond = (nodes[n] for n in around)
                low, high = ends[around[1]], ends[around[2]]
                if max(low.max(), high.max()) < -0.5 or low[REACH] < -0.1 > high[REACH]:
                    continue
                state, i, row = path_state(
                    packed, wrist, STEP, outer, left, right, beyond, low, high
                )
                states.add(CellState(state))
                assert state in set(CellState)
                if state != CellState.EXTREME:
                    assert (i, row) == (-1, 0)
                inside = [
                    margins_of(
                        task, turns_at(task, -math.pi + STEP * (k + share), arm), wrist
                    ).min()
                    for share in (0.1, 0.5, 0.9)
                ]
                both = min(low.min(), high.min())
                if state == CellState.DEAD:
                    assert max(inside) < 1e-9
                elif state == CellState.FULL:
                    assert min(both, *inside) >= -1e-9
                elif state == CellState.CROSSED:
                    assert both < 0.0
    assert CellState.DEAD in states
    assert name != "data set" or {CellState.FULL, CellState.CROSSED} <= states
    assert name == "data set" or states & {CellState.EXTREME, CellState.EDGE}


@pytest.mark.parametrize("name", TASKS)
@pytest.mark.parametrize("retreat", [0.0, 0.04])
def test_a_cell_is_closed_only_where_nothing_is_feasible_in_it(name: str, retreat: float) -> None:
    task = TASKS[name]
    packed = task.packed(1)
    values, highest = np.empty((ROW_CONSTRAINTS, ARC_NODES)), np.empty((3, ARC_CELLS))
    closed = open_ones = 0
    for arm in range(4):
        turns = np.empty((TURN_ROWS, ARC_NODES))
        turns_at_nodes(packed, retreat, arm, turns)
        open_cells = np.ones((2, ARC_CELLS), dtype=np.bool_)
        open_cells[0, 5] = False
        stay = close_cells(packed, turns, values, highest, open_cells)
        assert stay == open_cells.sum()
        assert not open_cells[0, 5]
        closed += (~open_cells).sum()
        open_ones += open_cells.sum()
        shares = np.concatenate([(np.arange(ARC_CELLS) + share) for share in (0.01, 0.5, 0.99)])
        angles = -math.pi + STEP * shares
        fine = np.empty((TURN_ROWS, len(angles)))
        turns_at_angles(packed, angles, len(angles), retreat, arm, fine)
        rows = np.empty((ROW_CONSTRAINTS, len(angles)))
        row_constraints(packed, fine, len(angles), rows)
        for wrist in range(2):
            own = [0, 1, 2, 3, 4, *range(5 + 3 * wrist, 8 + 3 * wrist)]
            feasible = rows[own].min(axis=0) >= 0.0
            for k in (np.flatnonzero(feasible) % ARC_CELLS).tolist():
                assert open_cells[wrist, k] or (wrist == 0 and k == 5)
    assert closed > open_ones > 0
