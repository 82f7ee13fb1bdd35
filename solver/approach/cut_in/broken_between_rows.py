"""Where a cut-in breaks a limit between the rows that it was planned with."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solver.approach.cut_in.between_rows import may_fall_below_zero_between, may_leave_between
from solver.approach.cut_in.cut_in import rate_room
from solver.approach.cut_in.line_behind import LineBehind
from solver.approach.cut_in.tolerances import (
    BESIDE_ROW_M,
    EVEN_ROWS_M,
    EXCHANGE_ZOOMS,
    NEAR_RATE_ROOM,
    RATE_ROOM_EXCESS,
)
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.approach.tolerances import EXCHANGE_DENSITY
from solver.robots.model import Array
from solver.tolerances import LIMIT_EXCESS_RAD, REACH_ROUNDING_M

Measure = Callable[[Array, Array], Array]
"""Of postures, shape (n, joints), at retreats, shape (n,): how far each is from broken, (n,)."""


def broken_between(task: ApproachTask, candidate: Candidate) -> float | None:
    """The retreat between two rows at which a cut-in is furthest from feasible, if it is one [m].

    There the wrist centre is out of reach, or a joint is beyond its limits, which are those of the
    task, less the margin asked for, or else one turns faster than JOINT_RATE_RAD_M.
    """
    line = LineBehind(task.robot, task.tool, candidate.thinning_joints, candidate.branch)
    behind = _Behind(task, line)
    coarse = np.asarray(task.retreats_m)
    spacing = np.diff(coarse)
    if np.all(np.abs(spacing - spacing[0]) <= EVEN_ROWS_M) and not _suspicious(behind, coarse):
        return None
    shares = np.arange(EXCHANGE_DENSITY)[:, None] / EXCHANGE_DENSITY
    dense = np.append((coarse[:-1] + shares * np.diff(coarse)).T.ravel(), 0.0)
    rows = behind.line.rows(dense)
    for measure, allowed in (
        (behind.reach, REACH_ROUNDING_M),
        (behind.inside, LIMIT_EXCESS_RAD / 2),
        (behind.room, RATE_ROOM_EXCESS),
    ):
        values = measure(dense, rows)
        if _stays_above(values):
            continue
        retreat, value = _lowest(behind, dense, values, measure)
        if value < -allowed:
            return retreat
    return None


@dataclass(frozen=True)
class _Behind:
    """What is looked at between rows of a cut-in, at retreats of shape (n,) and postures there."""

    task: ApproachTask
    line: LineBehind

    def reach(self, retreats: Array, _: Array) -> Array:
        """How far the wrist centre is inside the reach [m]."""
        return self.line.reach(retreats)

    def inside(self, _: Array, rows: Array) -> Array:
        """How far the joint that is nearest to a limit is inside it [rad or m]."""
        return np.asarray(self.task.inside(rows).min(axis=1))

    def room(self, _: Array, rows: Array) -> Array:
        """What joints are short of the highest rate, see `rate_room`."""
        return rate_room(self.line.robot, self.line.tool, self.line.branch, rows)


def _suspicious(behind: _Behind, coarse: Array) -> bool:
    """Whether rows that are even give a reason to look between them."""
    task, rows = behind.task, behind.line.rows(coarse)
    room = behind.room(coarse, rows)
    return (
        may_leave_between(rows, task.lower, task.upper)
        or may_fall_below_zero_between(behind.reach(coarse, rows))
        or may_fall_below_zero_between(room)
        or _dips_beside(behind, coarse, room)
    )


def _dips_beside(behind: _Behind, coarse: Array, room: Array) -> bool:
    """Whether the room of a rate that a row all but uses up goes on falling beside that row.

    A dip that begins in a row may be too narrow for a parabola through three of them.
    """
    near = coarse[room < NEAR_RATE_ROOM]
    if not len(near):
        return False
    beside = np.clip(np.concatenate((near + BESIDE_ROW_M, near - BESIDE_ROW_M)), 0.0, coarse[0])
    own = np.tile(room[room < NEAR_RATE_ROOM], 2)
    down = np.argsort(-beside)
    retreats = np.append(beside[down], 0.0)
    found = behind.room(retreats, behind.line.rows(retreats))[:-1]
    return bool(np.any(found < own[down] - RATE_ROOM_EXCESS))


def _stays_above(values: Array) -> bool:
    """Whether a measure is above zero by more than it changes to both sides, all along."""
    if values.min() == np.inf:
        return True
    change = np.abs(np.diff(values, prepend=values[0], append=values[-1]))
    return bool(np.all(values > change[:-1] + change[1:]))


def _lowest(behind: _Behind, dense: Array, values: Array, measure: Measure) -> tuple[float, float]:
    """The retreat at which a measure is least, and its value, closed in on from dense rows."""
    k = int(values.argmin())
    best, least = float(dense[k]), float(values[k])
    around = dense[max(k - 1, 0)], dense[min(k + 1, len(dense) - 1)]
    coarse = dense[::EXCHANGE_DENSITY]
    for _ in range(EXCHANGE_ZOOMS):
        finer = np.linspace(*around, 2 * EXCHANGE_DENSITY + 1)
        # Joints are on the turn that the rows before the target decide.
        retreats = np.unique(np.concatenate((coarse, finer)))[::-1]
        found = measure(retreats, behind.line.rows(retreats))
        k = int(found.argmin())
        if found[k] < least:
            best, least = float(retreats[k]), float(found[k])
        around = retreats[max(k - 1, 0)], retreats[min(k + 1, len(retreats) - 1)]
    return best, least
