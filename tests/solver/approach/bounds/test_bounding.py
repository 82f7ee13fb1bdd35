"""Bounds on the effort of cells, by hand and against postures inside them."""

import math
from typing import Any

import numpy as np
import pytest

from solver.approach.arcs.arcs import task_arcs
from solver.approach.bounds.bounding import (
    cell_bound,
    examine,
    excluded,
    follow_cut_in,
    least_effort_in_cell,
    nearest_turn,
    prove,
    travel,
    turns_inside,
    worst_row,
)
from solver.approach.bounds.enclosure import enclosure, half_length
from solver.approach.optimum.on_arcs import ArcOptimum, best_on_arcs
from solver.approach.task.feasibility import evaluate, trace
from tests.solver.methods.synthetic import small_task

SMALL = small_task(2, standoff_m=0.01)
TASK = SMALL.for_kernels(1)
ROWS = len(TASK.retreats)
TURN = 2 * math.pi
BRANCH = 2
_FOUND = best_on_arcs(SMALL)
assert _FOUND is not None
BEST: ArcOptimum = _FOUND


def with_limits(low: float, high: float, reference: float = 0.0, squared: bool = False) -> Any:
    return TASK._replace(
        lower=np.full(6, low), upper=np.full(6, high), reference=np.full(6, reference),
        weights=np.array([1.0, 2.0, 0.5, 1.0, 3.0, 1.0]), squared=squared,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("low", "high", "turns"),
    [
        (0.1, 0.2, (0, 0)),
        (2.1, 2.2, (0, -1)),
        (2.1 - TURN, 2.2 - TURN, (1, 0)),
        (0.1 + TURN, 0.2 + TURN, (-1, -1)),
        (1.9, 2.2, (0, 0)),
        (-2.2, -1.9, (0, 0)),
        (-9.0, 9.0, (0, 0)),
        (2.0 + 1e-10, 2.0 + 2e-10, (0, 0)),
    ],
)
def test_turns_on_which_an_interval_meets_the_limits(
    low: float, high: float, turns: tuple[int, int]
) -> None:
    """Those that the verifier accepts, a hair wider."""
    assert turns_inside(with_limits(-2.0, 2.0), 3, low, high) == turns


def test_several_turns_may_be_inside() -> None:
    task = with_limits(-10.0, 10.0)
    assert turns_inside(task, 0, 0.0, 0.1) == (-1, 1)
    assert turns_inside(task, 0, 3.0, 3.1) == (-2, 1)
    assert turns_inside(task, 0, -3.1, -3.0) == (-1, 2)


@pytest.mark.parametrize(
    ("low", "high", "turn", "least", "most"),
    [
        (0.5, 0.7, 0, 0.2, 0.4),
        (-0.5, -0.4, 0, 0.7, 0.8),
        (0.1, 0.5, 0, 0.0, 0.2),
        (0.5 - TURN, 0.7 - TURN, 1, 0.2, 0.4),
        (5.0, 6.0, 0, 4.7, 5.7),
        (-6.0, -5.0, 0, 5.3, 6.3),
    ],
)
def test_travel_of_an_interval_from_the_reference(
    low: float, high: float, turn: int, least: float, most: float
) -> None:
    found = travel(with_limits(-4.0, 4.0, 0.3), 2, low, high, turn)
    assert found == (pytest.approx(least, abs=1e-9), pytest.approx(most, abs=1e-9))
    # A limit that is nearer to the interval than the reference is: no travel is shorter.
    beyond = travel(with_limits(1.0, 4.0, 0.3), 2, 0.4, 1.5, 0)
    assert beyond[0] == pytest.approx(0.7, abs=1e-5)
    before = travel(with_limits(-4.0, -1.0, 0.3), 2, -1.5, 0.2, 0)
    assert before[0] == pytest.approx(1.3, abs=1e-5)


def test_the_turn_of_least_travel_and_whether_it_is_so_everywhere() -> None:
    task = with_limits(-10.0, 10.0, 0.3)
    turn, least, certain = nearest_turn(task, 1, 0.5, 0.7, -1, 1)
    assert (turn, certain) == (0, True)
    assert least == pytest.approx(0.2, abs=1e-9)
    turn, least, certain = nearest_turn(task, 1, 0.5 + TURN, 0.7 + TURN, -2, 0)
    assert (turn, certain) == (-1, True)
    # Half a turn away the other turn may be nearer.
    turn, least, certain = nearest_turn(task, 1, 3.3, 3.6, -1, 0)
    assert (turn, certain) == (-1, False)
    assert least == pytest.approx(0.3 - (3.6 - TURN), abs=1e-9)
    assert nearest_turn(task, 1, 3.3, 3.6, 0, 0)[2]
    assert nearest_turn(task, 1, 3.3, 3.6, 1, 0)[1] == math.inf


@pytest.mark.parametrize("squared", [False, True])
def test_a_bound_is_a_line_under_the_effort(squared: bool) -> None:
    """Joints that turn with the angle, of which some pass their reference."""
    task = with_limits(-3.0, 3.0, 0.0, squared)
    rates = np.array([0.5, -0.4, 0.3, 2.0, -1.0, 0.1])
    at_middle = np.array([1.0, 1.5, -2.0, 0.001, 0.5, -0.5])
    half = 0.01
    q = np.stack((at_middle - np.abs(rates) * half, at_middle + np.abs(rates) * half), axis=1)
    slopes, middle = np.stack((rates, rates), axis=1), np.stack((at_middle, at_middle), axis=1)
    bound = least_effort_in_cell(task, half, np.zeros((6, 2), dtype=np.int64), q, slopes, middle)

    def effort(x: np.ndarray) -> np.ndarray:
        joints = at_middle[:, None] + rates[:, None] * x
        return np.asarray(task.weights @ (joints**2 if squared else np.abs(joints)))

    least = effort(np.linspace(-half, half, 2001)).min()
    assert bound <= least
    assert bound >= least - (3e-3 if squared else 0.02)
    plain = sum(
        w * (v**2 if squared else v)
        for w, v in zip(task.weights, np.maximum(np.abs(q).min(axis=1), 0.0), strict=True)
    )
    assert bound >= plain - 1e-2


def test_a_joint_of_which_nothing_is_known_counts_with_its_least_travel() -> None:
    task = with_limits(1.0, 3.0)
    q = np.tile([1.5, 1.6], (6, 1))
    q[4] = -1e3, 1e3
    slopes, middle = np.zeros((6, 2)), np.tile([1.55, 1.55], (6, 1))
    turns = np.zeros((6, 2), dtype=np.int64)
    bound = least_effort_in_cell(task, 0.1, turns, q, slopes, middle)
    known = task.weights.sum() - task.weights[4]
    assert bound == pytest.approx(1.55 * known + 1.0 * task.weights[4], abs=1e-4)


def cell(low: float, high: float, branch: int = BRANCH) -> tuple[float, np.ndarray, np.ndarray]:
    turns, work = np.zeros((6, 2), dtype=np.int64), np.empty((4, 6, 2))
    return cell_bound(TASK, low, high, branch, turns, work), turns, work


@pytest.mark.parametrize("width", [1e-4, 0.01, 0.1])
def test_the_bound_of_a_cell_is_below_all_its_efforts(width: float) -> None:
    near = 0
    for branch in range(8):
        for low in np.arange(-3.0, 3.0, 0.31):
            bound, turns, work = cell(low, low + width, branch)
            if bound < math.inf:
                expected = [turns_inside(TASK, i, *work[0, i]) for i in range(6)]
                assert turns.tolist() == [list(one) for one in expected]
            for share in (0.05, 0.5, 0.95):
                margin, effort = evaluate(TASK, low + share * width, branch, np.empty((ROWS, 6)))
                if margin >= 0.0:
                    assert bound <= effort
                    near += bound > 0.8 * effort
    assert near > 5


def test_what_is_excluded_is_out_of_reach_or_limits() -> None:
    q = np.stack((TASK.lower + 0.1, TASK.lower + 0.2), axis=1)
    q[:, 0], q[:, 1] = BESTS[0] - 1e-6, BESTS[0] + 1e-6
    assert not excluded(TASK, q, 0.1)
    assert excluded(TASK, q, -0.1)
    for i in range(6):
        beyond = q.copy()
        beyond[i] = TASK.upper[i] + 0.1, TASK.upper[i] + 0.2
        assert excluded(TASK, beyond, 0.1) == (TASK.upper[i] + 0.2 - TURN < TASK.lower[i])


BESTS = [np.asarray(SMALL.thinning_joints(BEST.angle_rad, 1, BEST.arc.branch))]


def test_the_row_furthest_from_holding() -> None:
    rows = np.empty((ROWS, 6))
    trace(TASK, BEST.angle_rad, BEST.arc.branch, TASK.retreats, rows)
    bent = rows.copy()
    bent[3, 1], bent[5, 2] = TASK.upper[1] + 0.2, TASK.upper[2] + 0.4
    assert worst_row(TASK, BEST.angle_rad, BEST.arc.branch, bent) == (5, True)
    bent[5, 2] = rows[5, 2]
    assert worst_row(TASK, BEST.angle_rad, BEST.arc.branch, bent) == (3, True)
    # With another turn inside the limits it is not so on every turn.
    wide = TASK._replace(lower=TASK.lower - 0.0, upper=TASK.upper.copy())
    wide.lower[1] = TASK.upper[1] + 0.2 - TURN - 0.1
    assert worst_row(wide, BEST.angle_rad, BEST.arc.branch, bent)[0] == 3


@pytest.mark.parametrize("off", [-1.0, -0.5, -0.1, 0.0, 0.1, 0.5])
def test_a_cell_with_a_feasible_approach_is_never_closed(off: float) -> None:
    angle = BEST.angle_rad + off
    margin, effort = evaluate(TASK, angle, BRANCH, np.empty((ROWS, 6)))
    for width in (1e-6, 1e-3, 0.05):
        low, high = angle - width / 3, angle + 2 * width / 3
        rows, work = np.empty((ROWS, 6)), np.empty((4, 6, 2))
        bound, known = examine(TASK, low, high, BRANCH, math.inf, 1e-7, rows, work)
        bound_alone, turns, work = cell(low, high)
        if margin >= 0.0:
            assert bound <= effort
            assert not follow_cut_in(TASK, low, high, BRANCH, turns, work)
        elif width == 1e-6 and margin < -0.01:
            assert bound == math.inf
        inside = evaluate(TASK, (low + high) / 2, BRANCH, np.empty((ROWS, 6)))
        assert known == (inside[1] if inside[0] >= 0.0 and bound_alone < math.inf else math.inf)
        # One that cannot be below what is known is not looked at.
        kept = examine(TASK, low, high, BRANCH, 1e-3, 1e-7, rows, work)
        assert kept == (bound_alone, 1e-3)


def test_a_cell_whose_middle_is_not_feasible_is_kept_where_a_part_of_it_is() -> None:
    """Across the ends of its arcs; and beyond them cells are closed."""
    kept = 0
    for arc in task_arcs(SMALL):
        for end, inwards in ((arc.lower_rad, 1.0), (arc.upper_rad, -1.0)):
            for width in (1e-5, 1e-3):
                inside, outside = end + 0.2 * inwards * width, end - 0.8 * inwards * width
                rows, work = np.empty((ROWS, 6)), np.empty((4, 6, 2))
                low, high = min(inside, outside), max(inside, outside)
                margin, _ = evaluate(TASK, (low + high) / 2, arc.branch, rows)
                _, effort = evaluate(TASK, inside, arc.branch, rows)
                bound, known = examine(TASK, low, high, arc.branch, math.inf, 1e-7, rows, work)
                assert bound <= effort
                kept += margin < 0.0 and known == math.inf
                far = end - 3.0 * inwards * width
                away = examine(
                    TASK, far - width, far + width, arc.branch, math.inf, 1e-7, rows, work
                )
                assert away[1] == math.inf or away[1] >= BEST.effort - 1e-9
    assert kept >= 4


def test_a_proof_ends_at_the_least_effort() -> None:
    gap = 1e-3
    bound, known, cells, done = prove(TASK, BEST.effort, gap, 100_000)
    assert done
    assert known == pytest.approx(BEST.effort, rel=1e-6)
    assert known * (1 - 2 * gap) <= bound <= known
    assert cells > 8 * 16
    # Whatever it is told, and with a budget that ends before.
    early = prove(TASK, math.inf, gap, 150)
    assert early[2] >= 150
    assert early[0] <= BEST.effort * (1 + 1e-9) <= early[1] * (1 + 1e-6)
    assert early[3] == (early[0] >= early[1] * (1 - gap))


def test_out_of_reach_nothing_is_feasible() -> None:
    far = TASK._replace(position=4 * TASK.position)
    assert prove(far, math.inf, 1e-3, 1000) == (math.inf, math.inf, 8 * 16, True)


def test_half_the_length_of_a_cell_is_rounded_up() -> None:
    assert half_length(0.1, 0.5) >= 0.2
    assert half_length(0.1, 0.5) == pytest.approx(0.2)
    q, slopes, middle = (np.empty((6, 2)) for _ in range(3))
    enclosure(TASK, 0.1, 0.12, 0.0, BRANCH, q, slopes, middle)
    assert np.all(q[:, 0] <= middle[:, 0])
    assert np.all(middle[:, 1] <= q[:, 1])
    assert np.all(np.diff(middle) < 1e-9)
