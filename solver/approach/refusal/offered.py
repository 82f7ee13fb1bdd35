"""Kernel: whether a displaced target holds at the approach that it is offered with."""

# mypy: allow-untyped-defs, allow-incomplete-defs, allow-untyped-calls, allow-untyped-decorators

import math

import numpy as np

from solver.approach.arcs.roots import arc_scratch
from solver.approach.arcs.search import cell_pieces, cell_state
from solver.approach.arcs.splitting import ARC_COLUMNS, MOST_ARCS
from solver.approach.cut_in.between_rows import may_fall_below_zero_between, may_leave_between
from solver.approach.refusal.displacement_constraints import copy_at
from solver.approach.task.feasibility import posture, tool_axes, trace
from solver.approach.task.packed import COLUMNS, PackedTask
from solver.approach.tolerances import ARC_CELLS
from solver.compiled import NONE_YET, kernel
from solver.kinematics.spherical_wrist import wrap
from solver.kinematics.straight_rates import rows_rate_room

_POSITION = COLUMNS["position"]


@kernel
def on_an_arc(packed, branch, angle):
    """Whether an angle in [-pi, pi) is on a feasible arc of a branch; searches its cell alone."""
    scratch, arcs = arc_scratch(len(packed.retreats)), np.empty((MOST_ARCS, ARC_COLUMNS))
    scratch.known_paths[:] = False
    scratch.known_margins[:] = False
    k = int((angle + math.pi) / (2 * math.pi) * ARC_CELLS) % ARC_CELLS
    arm, wrist = branch // 2, branch % 2
    state = cell_state(packed, scratch, arm, wrist, k)
    pieces = cell_pieces(packed, scratch, arm, wrist, k, state, arcs, NONE_YET, NONE_YET, math.inf)
    found = False
    for i in range(pieces):
        found = found or arcs[i, 1] <= angle <= arcs[i, 2]
    return found


@kernel
def offer_holds(task, packed, branch, x):
    """Whether an arc of the displaced target has the angle, and whether it may fail between rows.

    Angles count from the same direction before and after.

    Args:
        task: the task.
        packed: the same, as arcs are found.
        branch: inverse kinematics branch.
        x: displacement [m] and angle, shape (4,).

    Returns:
        Whether the angle lies in an arc of the branch, and whether the cut-in needs a closer look
        between its rows, which are evenly spaced.
    """
    numbers, position = packed.numbers.copy(), task.position.copy()
    for i in range(3):
        position[i] += x[i]
        numbers[_POSITION + i] += x[i]
    rows = len(task.retreats)
    moved = PackedTask(numbers, packed.retreats, packed.cos_steps)
    inside = on_an_arc(moved, branch, wrap(x[3]))
    path, reaches, rooms = np.empty((rows, 6)), np.empty(rows), np.empty(rows)
    there, axes, q = copy_at(task, position), np.empty((3, 3)), np.empty(6)
    trace(there, x[3], branch, task.retreats, path)
    tool_axes(task, x[3], axes)
    for n in range(rows):
        reaches[n] = posture(there, axes, task.retreats[n], branch, q)
    rows_rate_room(task.geometry, path, rooms)
    return inside, (
        may_leave_between(path, task.lower, task.upper)
        or may_fall_below_zero_between(reaches)
        or may_fall_below_zero_between(rooms)
    )
