"""The reference kernels put to targets: the sweep, and the ladder graph with straight cut-ins.

The ladder is that of Descartes in Tesseract: evenly spaced angles, every branch, every edge between
neighbours. Ours is compiled and knows only this arm, so it is faster than theirs.
"""

import math
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.kernels import BRANCHES, SweepTask, cheapest_chain, ladder_nodes, sweep
from bench.targets import TargetSet
from solver import Problem
from solver.problem.retreats import even_retreats, looked_at_retreats
from solver.tolerances import JOINT_RATE_RAD_M

Array = NDArray[np.float64]

BETWEEN = 8
"""Postures between two rows of the cut-in at which the sweep looks as well."""


@dataclass(frozen=True)
class SweepAnswer:
    """Least efforts of n targets, infinity where nothing holds, shape (n,) each."""

    at_rows: Array
    between_rows: Array


@dataclass(frozen=True)
class Ladder:
    """Nodes of a ladder graph: postures, shape (nodes, 6) each [rad], and where layers begin."""

    thinning: Array
    standby: Array
    layers: NDArray[np.int64]

    @property
    def reached(self) -> NDArray[np.bool_]:
        """Which targets have a node, shape (targets,)."""
        return np.asarray(np.diff(self.layers) > 0)


def sweep_task(problem: Problem, angles: int) -> SweepTask:
    """What the kernels need of a problem, for angles -pi + 2 pi k / n.

    Raises:
        ValueError: the arm or the options are none that the reference kernels know.
    """
    robot, options = problem.robot, problem.options
    j1, j2, j3, j4, j5, j6 = robot.joints
    half = math.pi / 2
    twists = [round(joint.alpha_rad / half, 12) for joint in robot.joints]
    plain = twists == [1, 0, 1, -1, 1, 0] and j2.d_m == j3.d_m == j3.a_m == j4.a_m == j5.a_m == 0.0
    offsets = [round(joint.offset_rad / half, 12) for joint in robot.joints]
    if not plain or offsets != [0, 0, 1, 0, 0, 0] or max(abs(robot.lower)) > math.pi:
        raise ValueError(f"{robot.name}: the reference kernels know T's arm only")
    if options.norm != "l1" or options.symmetric_tool:
        raise ValueError("the reference kernels know the l1 norm and a tool with one side only")
    phi = -math.pi + 2 * math.pi * np.arange(angles) / angles
    rows = looked_at_retreats(options)
    fine = even_retreats(options, (len(rows) - 1) * (BETWEEN + 1) + 1)
    lower, upper = robot.limits_within(options.limit_margin_rad)
    return SweepTask(
        arm=(j1.a_m, j2.a_m, j1.d_m, j4.d_m, j6.d_m + problem.mounted_tool.length_m),
        lower=lower,
        upper=upper,
        weights=np.asarray(problem.joint_weights),
        cosines=np.cos(phi),
        sines=np.sin(phi),
        retreats=rows,
        between=np.delete(fine, np.s_[:: BETWEEN + 1]),
        rate=JOINT_RATE_RAD_M,
    )


def sweep_targets(problem: Problem, targets: TargetSet, angles: int) -> SweepAnswer:
    """The least effort of every target over all angles and branches, from the start posture."""
    task, frames, start = sweep_task(problem, angles), targets.frames, np.asarray(problem.start)
    best, between = np.empty(len(targets)), np.empty(len(targets))

    def part(first: int) -> None:
        # Each takes every n-th target, so that the cores are done together.
        own, own_between = np.empty(len(frames[first::cores])), np.empty(len(frames[first::cores]))
        sweep(task, np.ascontiguousarray(frames[first::cores]), start, own, own_between)
        best[first::cores], between[first::cores] = own, own_between

    cores = len(os.sched_getaffinity(0))
    with ThreadPoolExecutor(cores) as pool:
        list(pool.map(part, range(cores)))
    return SweepAnswer(best, between)


def build_ladder(problem: Problem, targets: TargetSet, angles: int) -> Ladder:
    """The nodes of a batch: every angle and branch with a straight, feasible cut-in."""
    most = len(targets) * angles * BRANCHES
    return Ladder(*ladder_nodes(sweep_task(problem, angles), targets.frames, most))


def ladder_effort(problem: Problem, ladder: Ladder) -> float:
    """Least total effort through the layers that have nodes, in their order."""
    total, _ = cheapest_chain(
        np.asarray(problem.joint_weights),
        ladder.thinning,
        ladder.standby,
        np.unique(ladder.layers),
        np.asarray(problem.start),
    )
    return float(total)
