"""Uncertain targets: how far one may move, and the approaches that bear it.

A target with a standard deviation is planned so that its posture, with its orientation and branch
kept, stays feasible when the target is `UNCERTAINTY_DEVIATIONS` standard deviations away in any
direction, at every row of the cut-in. To first order that takes the deviation times the length of
the joint's gradient (its row of the inverse Jacobian) from each limit, and the deviation from the
reach; what is used is the exact distance to the nearest limit.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from solver.approach.task.feasibility import retreat_from_many
from solver.approach.task.task import ApproachTask
from solver.approach.tolerances import UNCERTAINTY_DEVIATIONS
from solver.approach.uncertainty.displacement import rows_displacement_margins
from solver.approach.uncertainty.robust_parts import margin_of_approach, parts_of_arcs
from solver.kinematics.families.registry import family_of
from solver.kinematics.forward import many_poses
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.problem.options import Options
from solver.problem.retreats import looked_at_retreats
from solver.problem.solution import Arc
from solver.problem.targets import Target
from solver.robots.model import Array, Robot, Tool
from solver.robots.rigid import inverse


def needed_margin(target: Target) -> float:
    """How far a target has to be free to move, 0 when its position is known exactly [m]."""
    return UNCERTAINTY_DEVIATIONS * (target.position_std_m or 0.0)


def robust_arcs(task: ApproachTask, arcs: Sequence[Arc]) -> tuple[Arc, ...]:
    """The parts of feasible arcs that bear the target's uncertainty; all where it has none."""
    needed = needed_margin(task.target)
    return tuple(arcs) if needed == 0.0 else arcs_bearing(task, arcs, needed)


def arcs_bearing(task: ApproachTask, arcs: Sequence[Arc], margin: float) -> tuple[Arc, ...]:
    """The parts of feasible arcs that bear a displacement of the target [m]."""
    parts: Array = parts_of_arcs(margin, *task.packed_arcs(arcs))
    return tuple(_part(arcs[int(place)], low, high) for place, low, high in parts.tolist())


def _part(arc: Arc, low: float, high: float) -> Arc:
    return replace(
        arc,
        lower_rad=low,
        upper_rad=high,
        lower_limit=arc.lower_limit if low == arc.lower_rad else "uncertainty",
        upper_limit=arc.upper_limit if high == arc.upper_rad else "uncertainty",
    )


def approach_margin(task: ApproachTask, angle: float, tool_side: int, branch: int) -> float:
    """How far the target of a feasible approach may move [m]."""
    return float(margin_of_approach(task.packed(tool_side), angle, branch))


def bears_uncertainty(task: ApproachTask, angle: float, tool_side: int, branch: int) -> bool:
    """Whether an approach stays feasible however uncertain its target is."""
    needed = needed_margin(task.target)
    return needed == 0.0 or approach_margin(task, angle, tool_side, branch) >= needed


def path_displacement_margin(
    robot: Robot, tool: Tool, options: Options, branch: int, thinning: Sequence[float] | Array
) -> float:
    """How far a target may move until its cut-in meets a limit somewhere [m].

    The tool moves with the target, its orientation and branch kept; the limits are the robot's less
    `limit_margin_rad`, the reach, and the straight wrist, which no branch passes without a jump.

    Args:
        robot: an arm with a spherical wrist, on a rail that stands still or not.
        tool: its tool.
        options: of the problem.
        branch: inverse kinematics branch.
        thinning: the posture at the target, shape (joints,) [rad or m].
    """
    posture = np.asarray(thinning, dtype=np.float64)
    standing = family_of(robot, tool).standing(robot, posture)
    assert standing is not None, "it has branches"
    robot, posture = standing.arm, posture[standing.first :]
    return float(displacement_margins(robot, tool, options, np.array([branch]), posture[None])[0])


def displacement_margins(
    robot: Robot, tool: Tool, options: Options, branches: NDArray[np.int64], thinning: Array
) -> Array:
    """`path_displacement_margin` of n approaches of an arm that is not on a rail, shape (n,) [m].

    Args:
        robot: an arm with a spherical wrist.
        tool: its tool.
        options: of the problem.
        branches: inverse kinematics branches, shape (n,).
        thinning: postures at the targets, shape (n, 6) [rad].
    """
    geometry, retreats = wrist_geometry(robot, tool), looked_at_retreats(options)
    poses = np.ascontiguousarray(inverse(robot.mount) @ many_poses(robot, tool, thinning))
    paths, margins = np.empty((len(thinning), len(retreats), 6)), np.empty(len(thinning))
    paths[:, -1] = thinning
    retreat_from_many(geometry, poses, branches, retreats, paths)
    limits = robot.limits_within(options.limit_margin_rad)
    rows_displacement_margins(geometry, *limits, poses, retreats, branches, paths, margins)
    return margins
