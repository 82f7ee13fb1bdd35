"""Feasible arcs of the approach angle, and effort along them, for methods and pictures."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.approach.arc_search import WHOLE_TURN, arcs_of
from solver.approach.feasibility import sample
from solver.approach.robustness import robust_arcs
from solver.approach.task import ApproachTask, approach_task
from solver.kinematics.spherical_wrist import BRANCHES
from solver.problem import Problem, Target
from solver.robots.model import Array
from solver.tolerances import ARC_SAMPLES


@dataclass(frozen=True)
class Arc:
    """Approach angles, lower to upper [rad], at which one branch is feasible in the whole cut-in.

    Attributes:
        tool_side: 1 or -1.
        branch: 0 to 7.
        lower_rad: in [-pi, pi].
        upper_rad: beyond pi where the arc crosses the half turn.
        lower_limit: what ends the arc there: a joint's name, "reach", "wrist_jump", or the
            target's "uncertainty"; None where the arc is the whole turn.
        upper_limit: the same at the upper end.
    """

    tool_side: int
    branch: int
    lower_rad: float
    upper_rad: float
    lower_limit: str | None = None
    upper_limit: str | None = None


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
    limits = (*task.robot.joint_names, "reach", "reach", "wrist_jump")
    arcs: list[Arc] = []
    for side in task.tool_sides:
        for branch, low, high, by_low, by_high in arcs_of(task.packed(side)):
            ends = (None if code == WHOLE_TURN else limits[int(code)] for code in (by_low, by_high))
            arcs.append(Arc(side, int(branch), float(low), float(high), *ends))
    return robust_arcs(task, arcs)


def feasible_arcs(problem: Problem) -> dict[str, tuple[Arc, ...]]:
    """The feasible arcs of every target of a problem by its id, empty where it has none.

    They are those of the task without a strike zone and a tilt tolerance, at `path_points` rows.

    Raises:
        UnsupportedKinematics: the robot has no closed form.
    """
    tasks = (approach_task(problem, target, problem.start) for target in problem.targets)
    return {task.target.id: task_arcs(task) for task in tasks}


def survey_target(problem: Problem, target: Target, reference: Sequence[float]) -> Survey:
    """Effort against approach angle for a target, counted from a reference posture [rad]."""
    task = approach_task(problem, target, reference)
    rows, curves = [], []
    for side in task.tool_sides:
        angles, margins, efforts = sample_task(task, side, ARC_SAMPLES)
        rows.append(np.where(margins >= 0, efforts, np.nan))
        curves += [(side, branch) for branch in range(BRANCHES)]
    return Survey(angles, np.concatenate(rows), tuple(curves), task_arcs(task))
