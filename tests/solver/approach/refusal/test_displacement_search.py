"""Rows that break, and the displacement that makes a target feasible."""

import math

import numpy as np
import pytest

from solver.approach.refusal.displacement_constraints import copy_at
from solver.approach.refusal.displacement_search import (
    broken_row,
    fastest_row,
    nearest_displacement,
    nearest_of_all,
)
from solver.approach.task.feasibility import trace
from solver.kinematics.straight_rates import between_rate_room, posture_rate_room
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
