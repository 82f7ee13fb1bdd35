"""Where the relaxed programme starts: the closed form at the corners of the relaxations.

With its strike and swing fixed, a relaxed task is an unrelaxed one that the closed form solves: a
tool centre point s beyond the target is the tool shorter by s at the target, and a fixed swing is
another branch direction. So the best of every corner is a feasible start, and often the basin of
the best answer. Where no corner has an approach, the angles that come closest to one are starts.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from solver.approach.arcs.arcs import sample_task
from solver.approach.cut_in.cut_in import retreat_rows
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.relaxation import placement, rotation
from solver.approach.task.task import ApproachTask
from solver.kinematics.forward import forward_kinematics
from solver.methods.nlp.instance import Start
from solver.methods.nlp.tolerances import RELAXED_SAMPLES, RELAXED_SWINGS
from solver.problem.retreats import even_retreats
from solver.robots.model import Array
from solver.tolerances import NEAR_FEASIBLE_RAD


@dataclass(frozen=True)
class Corner:
    """A feasible posture of a relaxed task, from the closed form at a fixed strike and swing."""

    tool_side: int
    branch: int
    thinning: Array
    effort: float


def corner_tasks(task: ApproachTask) -> tuple[ApproachTask, ...]:
    """The task without relaxations, and with each of them at its ends: unrelaxed tasks all."""
    options = task.options
    strikes = (0.0, options.strike_zone_m) if options.strikes else (0.0,)
    swings = [np.zeros(3)]
    if options.tilts:
        turns = np.arange(RELAXED_SWINGS) * (2 * math.pi / RELAXED_SWINGS)
        swings += [
            options.tilt_tolerance_rad
            * (math.cos(turn) * task.frame.outward + math.sin(turn) * task.frame.sideways)
            for turn in turns
        ]
    return tuple(_fixed(task, strike, swing) for strike in strikes for swing in swings)


def _fixed(task: ApproachTask, strike: float, swing: Array) -> ApproachTask:
    leaning = task.target
    if swing.any():
        direction = tuple(float(value) for value in rotation(swing) @ task.frame.branch)
        leaning = replace(task.target, branch_direction=direction)
    tool = task.tool
    if strike > 0:
        tool = replace(tool, length_m=tool.length_m - strike)
    return replace(task, target=leaning, tool=tool)


def corners(task: ApproachTask) -> list[Corner]:
    """The best of every corner that has an approach, the cheapest first."""
    found = []
    for fixed in corner_tasks(task):
        best = best_on_arcs(fixed)
        if best is not None:
            side, branch = best.arc.tool_side, best.arc.branch
            thinning = np.asarray(fixed.thinning_joints(best.angle_rad, side, branch))
            found.append(Corner(side, branch, thinning, best.effort))
    return sorted(found, key=lambda corner: corner.effort)


def start_at(task: ApproachTask, tool_side: int, branch: int | None, thinning: Array) -> Start:
    """A start from a thinning posture, its standby straight behind it on its branch."""
    ends = even_retreats(task.options, 2)
    rows = retreat_rows(task.robot, task.tool, tuple(thinning), branch, ends)
    return _start(task, tool_side, rows[::-1])


def nearest_starts(task: ApproachTask, count: int) -> list[Start]:
    """Starts from the approach angles that come closest to feasible, the closest first.

    One for each corner, tool side and branch at most, and none that is far from feasible.
    """
    peaks: list[tuple[float, int, int, int, float]] = []
    tasks = corner_tasks(task)
    for k, fixed in enumerate(tasks):
        for side in fixed.tool_sides:
            angles, margins, _ = sample_task(fixed, side, RELAXED_SAMPLES)
            for branch, best in enumerate(margins.argmax(axis=1)):
                margin = float(margins[branch, best])
                if margin > -NEAR_FEASIBLE_RAD:
                    peaks.append((-margin, k, side, branch, float(angles[best])))
    ends = even_retreats(task.options, 2)
    starts = []
    for _, k, side, branch, angle in sorted(peaks)[:count]:
        rows = tasks[k].postures(angle, side, branch, ends)
        starts.append(_start(task, side, rows[::-1]))
    return starts


def _start(task: ApproachTask, tool_side: int, postures: Array) -> Start:
    pose = forward_kinematics(task.robot, task.tool, postures[0])
    seen = placement(task.frame, np.asarray(task.target.position_m), tool_side, pose)
    angle = seen.approach_angle_rad
    return Start(
        tool_side,
        angle,
        angle - math.pi,
        angle + math.pi,
        postures,
        even_retreats(task.options, 2)[::-1],
        seen.strike_m,
        seen.swing_rad,
    )
