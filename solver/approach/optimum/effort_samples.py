"""Kernels: joint values and effort at many approach angles of one branch."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math
from typing import NamedTuple

import numpy as np

from solver.approach.arcs.turns import (
    TURN_ROWS,
    joints_of_turns,
    path_columns,
    turns_along_path,
    turns_at_angles,
)
from solver.approach.optimum.tolerances import EFFORT_CELL_RAD
from solver.approach.task.feasibility import choose_packed_turns
from solver.approach.task.packed import LOWER, REFERENCE, SQUARED, UPPER, WEIGHTS
from solver.compiled import kernel
from solver.kinematics.spherical_wrist import wrap
from solver.problem.effort import joint_cost
from solver.robots.model import Array

MOST_SAMPLES = 8 * math.ceil((2 * math.pi / EFFORT_CELL_RAD + 1) / 8)


class EffortScratch(NamedTuple):
    """Working memory of the kernels: an arc's samples, and those of one cell."""

    angles: Array
    turns: Array
    joints: Array
    efforts: Array
    path_turns: Array
    path_joints: Array
    path: Array


@kernel
def effort_scratch(rows):
    """Working memory for arcs of up to one turn and cut-ins of that many rows."""
    n = MOST_SAMPLES
    return EffortScratch(
        np.empty(n), np.empty((TURN_ROWS, n)), np.empty((6, n)), np.empty(n),
        np.empty((TURN_ROWS, path_columns(rows))), np.empty((6, rows)), np.empty((rows, 6)),
    )  # fmt: skip


@kernel
def choose_turns_of_samples(task, scratch, branch, count):
    """Moves joints of more than one turn to the turn that `choose_turns` takes for their cut-in."""
    widest, rows = 0.0, len(task.retreats)
    for i in range(6):
        widest = max(widest, task.numbers[UPPER + i] - task.numbers[LOWER + i])
    if widest <= 2 * math.pi:
        return
    for n in range(count):
        turns_along_path(task, scratch.angles[n], branch // 2, scratch.path_turns)
        path_joints(task, scratch.path_turns, branch % 2, scratch.path_joints, scratch.path)
        for i in range(6):
            scratch.joints[i, n] = scratch.path[rows - 1, i]


@kernel
def path_joints(task, turns, wrist, joints, rows):
    """Writes a cut-in to rows, shape (len(retreats), 6), without turns between rows.

    `turns` are those along it; `joints` is working memory, shape (6, len(retreats)).
    """
    count = len(task.retreats)
    joints_of_turns(task, turns, count, wrist, joints)
    for i in range(6):
        rows[count - 1, i] = joints[i, count - 1]
        for n in range(count - 2, -1, -1):
            rows[n, i] = rows[n + 1, i] + wrap(joints[i, n] - rows[n + 1, i])
    choose_packed_turns(task.numbers, rows)


@kernel
def sample_effort(task, scratch, branch, count):
    """Fills turns, joints and efforts of the first `count` angles of scratch."""
    turns_at_angles(task, scratch.angles, count, 0.0, branch // 2, scratch.turns)
    # A multiple of the vector loop's width; what is beyond count is nobody's.
    joints_of_turns(task, scratch.turns, 8 * ((count + 7) // 8), branch % 2, scratch.joints)
    choose_turns_of_samples(task, scratch, branch, count)
    squared = task.numbers[SQUARED] > 0.0
    for n in range(count):
        scratch.efforts[n] = 0.0
    for i in range(6):
        reference, weight = task.numbers[REFERENCE + i], task.numbers[WEIGHTS + i]
        for n in range(count):
            scratch.efforts[n] += weight * joint_cost(scratch.joints[i, n] - reference, squared)


@kernel
def spread(scratch, low, high, count):
    """Sets the first `count` angles of scratch evenly from low to high, both included."""
    step = (high - low) / (count - 1)
    for n in range(count):
        scratch.angles[n] = low + n * step
    scratch.angles[count - 1] = high
