"""Points of the relaxations: a strike and a swing, and the best that the closed form does there.

With both fixed a relaxed task is an unrelaxed one. A tool centre point s beyond the target is the
tool shorter by s at the target, and a fixed swing turns the whole approach circle, so the points of
a zone are a batch of targets.
"""

from dataclasses import dataclass, replace

import numpy as np

from solver.approach.optimum.at_level import raise_margins
from solver.approach.optimum.batch_search import NO_BRANCH, optimise, paths_of_many
from solver.approach.task.packed import jump_cosines
from solver.approach.task.relaxation import Placement, rotation, shortened
from solver.approach.task.task import ApproachTask
from solver.approach.uncertainty.levels import level_borne, margin_levels
from solver.methods.relaxed.descent import descend, write_points
from solver.methods.relaxed.zones import zone_of
from solver.problem.retreats import even_retreats
from solver.robots.model import Array


@dataclass(frozen=True)
class Point:
    """An approach at a point of the relaxations.

    Attributes:
        placement: approach angle of the relaxed task (not wrapped), strike and swing.
        tool_side: 1 or -1.
        branch: 0 to 7.
        effort: of its thinning posture.
        level_m: the largest level of the task's margins that it bears [m].
        postures: thinning and standby, shape (2, 6) [rad].
    """

    placement: Placement
    tool_side: int
    branch: int
    effort: float
    level_m: float
    postures: Array

    @property
    def rank(self) -> tuple[float, float]:
        """What makes one point better than another: it bears more, then it is cheaper."""
        return -self.level_m, self.effort


def optima_at(task: ApproachTask, strikes_m: Array, swings_rad: Array) -> list[Point]:
    """The approach of least effort at each of n points that has one, in their order.

    Of approaches that bear the largest level of the task's margins that some approach there bears.

    Args:
        task: of an arm with a closed form.
        strikes_m: how far the tool centre point is beyond the target, shape (n,) [m].
        swings_rad: rotation vectors, normal to the branch, shape (n, 3) [rad].
    """
    n, ends = len(strikes_m), even_retreats(task.options, 2)
    angles, efforts, rows = np.empty(n), np.empty(n), np.empty((n, 2, 6))
    sides, branches = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int64)
    numbers = task.numbers_by_side
    fixed = np.empty((len(numbers), n, numbers.shape[1]))
    frame, retreats = task.frame, np.asarray(task.retreats_m)
    write_points(numbers, strikes_m, swings_rad @ frame.outward, swings_rad @ frame.sideways, fixed)
    steps, suspicious = jump_cosines(retreats), np.empty(n, dtype=np.bool_)
    optimise(
        fixed, retreats, steps, ends,
        angles, sides, branches, efforts, rows, suspicious, np.empty(n, dtype=np.int64),
    )  # fmt: skip
    levels, margins = margin_levels(task.options, task.target), np.zeros(n)
    if levels != (0.0,):
        moved = np.empty(n, dtype=np.bool_)
        raise_margins(
            fixed, retreats, steps, np.tile(levels, (n, 1)),
            angles, sides, branches, efforts, margins, moved,
        )  # fmt: skip
        which = np.flatnonzero(moved)
        own, again = fixed[(1 - sides[which]) // 2, which], np.empty((len(which), 2, 6))
        paths_of_many(
            own, branches[which], angles[which], retreats, steps, ends, again, suspicious[which]
        )
        rows[which] = again
    return [
        Point(
            Placement(float(angles[k]), float(strikes_m[k]), swings_rad[k]),
            int(sides[k]),
            int(branches[k]),
            float(efforts[k]),
            level_borne(levels, float(margins[k])) or 0.0,
            rows[k, ::-1],
        )
        for k in np.flatnonzero(branches != NO_BRANCH).tolist()
    ]


def optimum_at(task: ApproachTask, strike_m: float, swing_rad: Array) -> list[Point]:
    """`optima_at` one point, which is brought into the task's zone."""
    strike = min(max(strike_m, 0.0), task.options.strike_zone_m)
    swing = shortened(swing_rad, task.options.tilt_tolerance_rad)
    return optima_at(task, np.array([strike]), swing[None])


def descended(task: ApproachTask, near: Placement, looks: int) -> list[Point]:
    """The optimum where a descent among the points of a task's zone ends, after so many looks."""
    frame, zone = task.frame, zone_of(task.options)
    swing, lengths = near.swing_rad, zone[[0, 1, 1]]
    parts = np.array([near.strike_m, swing @ frame.outward, swing @ frame.sideways])
    shares = np.divide(parts, lengths, out=np.zeros(3), where=lengths > 0)
    retreats = np.asarray(task.retreats_m)
    ended = descend(task.numbers_by_side, retreats, jump_cosines(retreats), zone, shares, looks)
    strike, along, across = (lengths * ended).tolist()
    return optimum_at(task, strike, along * frame.outward + across * frame.sideways)


def fixed_task(task: ApproachTask, strike_m: float, swing_rad: Array) -> ApproachTask:
    """The unrelaxed task at a point; its approach angles count from a direction of its own."""
    target, tool = task.target, task.tool
    if np.any(swing_rad):
        leaning = rotation(swing_rad) @ task.frame.branch
        target = replace(target, branch_direction=tuple(float(value) for value in leaning))
    if strike_m > 0:
        tool = replace(tool, length_m=tool.length_m - strike_m)
    return replace(task, target=target, tool=tool)


def angle_in(fixed: ApproachTask, task: ApproachTask, seen: Placement) -> float:
    """The approach angle of a fixed task at which its tool stands as placed in the relaxed one."""
    z = rotation(seen.swing_rad) @ task.frame.direction(seen.approach_angle_rad)
    return float(np.arctan2(z @ fixed.frame.sideways, z @ fixed.frame.outward))
