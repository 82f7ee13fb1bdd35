"""The grid that searches start from, by its formulas and by postures that it stands for."""

import math

import numpy as np
import pytest

from solver.approach.refusal.displacement_constraints import copy_at
from solver.approach.refusal.displacement_seeds import outside, seeds, tilts, waists
from solver.approach.refusal.tolerances import SEED_BINS, SEED_TILTS, SEED_WAISTS
from solver.approach.task.feasibility import posture, tool_axes
from tests.solver.methods.synthetic import small_task

TASK = small_task(2).for_kernels(1)
FAR = TASK._replace(position=TASK.position * np.array([1.3, 1.3, 1.1]))


def test_joint_one_is_spread_over_its_limits_or_less_than_a_turn() -> None:
    offset = TASK.geometry.offsets[0]
    turns = np.linspace(TASK.lower[0], TASK.upper[0], SEED_WAISTS) + offset
    table = waists(TASK)
    assert table == pytest.approx(np.column_stack((np.cos(turns), np.sin(turns))))
    wide = TASK._replace(lower=np.full(6, -9.0), upper=np.full(6, 9.0))
    whole = -9.0 + offset + 2 * math.pi * np.arange(SEED_WAISTS) / SEED_WAISTS
    assert waists(wide) == pytest.approx(np.column_stack((np.cos(whole), np.sin(whole))))


def test_the_forearm_is_tilted_over_the_sums_that_limits_leave() -> None:
    g, table = TASK.geometry, tilts(TASK)
    low2, high2 = TASK.lower[1] + g.offsets[1], TASK.upper[1] + g.offsets[1]
    low3, high3 = TASK.lower[2] + g.offsets[2], TASK.upper[2] + g.offsets[2]
    width = (high2 + high3 - low2 - low3) / SEED_TILTS
    for j, row in enumerate(table):
        total = low2 + low3 + width * (j + 0.5)
        assert row[:2] == pytest.approx([math.cos(total), math.sin(total)])
        end = g.l3 * np.array([math.cos(total + g.beta), math.sin(total + g.beta)])
        assert row[2:4] == pytest.approx(end)
        least, most = max(low2, total - high3), min(high2, total - low3)
        ends = [math.cos(least), math.sin(least), math.cos(most), math.sin(most)]
        assert row[4:8] == pytest.approx(ends)
        assert row[8] == (1.0 if most - least <= math.pi else 0.0)
    assert len(table) == SEED_TILTS


def test_how_far_joints_are_outside_is_added_up() -> None:
    q = (TASK.lower + TASK.upper) / 2
    assert outside(TASK, q, 0) == 0.0
    q[1], q[3], q[5] = TASK.upper[1] + 0.1, TASK.lower[3] - 0.2, TASK.upper[5] + 0.3
    assert outside(TASK, q, 0) == pytest.approx(0.6)
    assert outside(TASK, q, 3) == pytest.approx(0.5)
    assert outside(TASK, q, 4) == pytest.approx(0.3)


@pytest.mark.parametrize("task", [TASK, FAR], ids=["near", "far"])
def test_starts_are_postures_on_their_branch_and_cost_what_they_say(task) -> None:  # type: ignore[no-untyped-def]
    needed, starts = np.empty((8, SEED_BINS)), np.full((8, SEED_BINS, 4), np.nan)
    seeds(task, needed, starts)
    assert np.isfinite(needed).any()
    least = np.inf
    for branch, part in np.argwhere(np.isfinite(needed)):
        start, axes, q = starts[branch, part], np.empty((3, 3)), np.empty(6)
        tool_axes(task, start[3], axes)
        there = copy_at(task, task.position + start[:3])
        assert posture(there, axes, 0.0, int(branch), q) >= -1e-9
        assert np.minimum(q - task.lower, task.upper - q)[:3].min() >= -1e-9
        assert math.floor((start[3] + math.pi) / (2 * math.pi) * SEED_BINS + 1e-9) == part
        cost = float(np.linalg.norm(start[:3])) + 0.2 * outside(task, q, 3)
        behind = posture(there, axes, task.retreats[0], int(branch), np.empty(6))
        assert needed[branch, part] == pytest.approx(cost + max(0.0, -behind), abs=1e-6)
        least = min(least, needed[branch, part])
    # What needs far more than another is left out.
    kept = needed[np.isfinite(needed)]
    assert kept.min() == least
    assert len(kept) >= 5


def test_a_feasible_target_needs_little_somewhere() -> None:
    needed, starts = np.empty((8, SEED_BINS)), np.empty((8, SEED_BINS, 4))
    seeds(TASK, needed, starts)
    near = needed.min()
    seeds(FAR, needed, starts)
    assert near < 0.05
    assert needed.min() > near
