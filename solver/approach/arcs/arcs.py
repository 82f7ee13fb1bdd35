"""Feasible arcs of the approach angle, and effort along them, for methods and pictures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from solver.approach.arcs.many import arcs_of_many
from solver.approach.arcs.tolerances import ARC_SAMPLES
from solver.approach.task.constraints import Constraint
from solver.approach.task.feasibility import sample
from solver.approach.task.task import ApproachTask, approach_task
from solver.approach.uncertainty.robustness import robust_arcs
from solver.kinematics.spherical_wrist import BRANCHES
from solver.problem.problem import Problem
from solver.problem.solution import Arc
from solver.problem.targets import Target
from solver.robots.model import Array, Robot


@dataclass(frozen=True)
class Survey:
    """Effort against approach angle.

    Attributes:
        angles_rad: shape (n,), evenly spaced over one turn from -pi.
        efforts: shape (curves, n); NaN where infeasible.
        curves: tool side and branch of each row of `efforts`.
        arcs: the feasible arcs.
    """

    angles_rad: Array
    efforts: Array
    curves: tuple[tuple[int, int], ...]
    arcs: tuple[Arc, ...]


def sample_angles(n: int) -> Array:
    """Approach angles over one turn, phi_k = -pi + 2 pi k / n, shape (n,) [rad]."""
    return np.asarray(-np.pi + 2 * np.pi * np.arange(n) / n)


def sample_task(task: ApproachTask, tool_side: int, n: int) -> tuple[Array, Array, Array]:
    """Angles, shape (n,), and margins and efforts of all branches there, shape (8, n)."""
    angles = sample_angles(n)
    return angles, *sample_angles_of(task, tool_side, angles)


def sample_angles_of(task: ApproachTask, tool_side: int, angles: Array) -> tuple[Array, Array]:
    """Margins and efforts of all branches at angles of shape (n,), shape (8, n)."""
    margins, efforts = np.empty((BRANCHES, len(angles))), np.empty((BRANCHES, len(angles)))
    sample(task.for_kernels(tool_side), angles, margins, efforts)
    return margins, efforts


def task_arcs(task: ApproachTask) -> tuple[Arc, ...]:
    """Feasible arcs of every branch and tool side that bear the target's uncertainty."""
    sides, names = task.tool_sides, limit_names(task.robot)
    packed = [task.packed(side) for side in sides]
    numbers = np.stack([one.numbers for one in packed])[:, None]
    found = arcs_of_many(numbers, packed[0].retreats, packed[0].cos_steps).tolist()
    arcs = [named_arc(sides[int(side)], arc, names) for _, side, *arc in found]
    return robust_arcs(task, arcs)


_LIMITS: Final[Mapping[Constraint, str]] = {
    Constraint.REACH: "reach",
    Constraint.BESIDE: "reach",
    Constraint.JUMP: "wrist_jump",
}


def limit_names(robot: Robot) -> tuple[str, ...]:
    """Names of the constraints that end arcs, in the order of the kernels."""
    return (*robot.joint_names, *(_LIMITS[one] for one in sorted(_LIMITS)))


def named_arc(tool_side: int, arc: Sequence[float], names: Sequence[str]) -> Arc:
    """An arc from the kernels' columns: branch, ends [rad] and what ends it."""
    branch, low, high, *codes = arc
    ends = (None if code == Constraint.NONE else names[int(code)] for code in codes)
    return Arc(tool_side, int(branch), low, high, *ends)


def survey_target(problem: Problem, target: Target, reference: Sequence[float]) -> Survey:
    """Effort against approach angle for a target, counted from a reference posture [rad]."""
    task = approach_task(problem, target, reference)
    rows, curves = [], []
    for side in task.tool_sides:
        angles, margins, efforts = sample_task(task, side, ARC_SAMPLES)
        rows.append(np.where(margins >= 0, efforts, np.nan))
        curves += [(side, branch) for branch in range(BRANCHES)]
    return Survey(angles, np.concatenate(rows), tuple(curves), task_arcs(task))
