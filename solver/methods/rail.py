"""An arm on a rail: with the slide at a fixed position it is the arm alone, mounted elsewhere."""

from dataclasses import replace

import numpy as np

from solver.approach.task.task import ApproachTask
from solver.kinematics.families.family import Rail
from solver.methods.tolerances import RAIL_FINE_M, RAIL_POSITIONS
from solver.problem.effort import posture_effort
from solver.robots.model import Array


def at_rail(task: ApproachTask, rail: Rail, position_m: float) -> ApproachTask:
    """The six-joint task with the slide at a position.

    The target and its approach frame stay: angle zero is "straight out" from the base origin, which
    does not move with the slide. Reference and weights are those of the arm's joints; the slide's
    part of the effort is `rail_effort`.
    """
    return replace(
        task,
        robot=rail.arm_at(position_m),
        reference=task.reference[1:],
        joint_weights=task.joint_weights[1:],
    )


def rail_effort(task: ApproachTask, position_m: float) -> float:
    """What the slide's travel from the reference adds to the effort of any approach there."""
    options, weights = task.options, task.joint_weights
    return posture_effort([position_m], task.reference[:1], weights[:1], options.norm)


def rail_positions(task: ApproachTask) -> Array:
    """Positions tried with the closed form, the least travel first, shape (n,) [m].

    An even grid between the slide's limits and, so that staying put is always among them, the
    reference's own position.
    """
    lower, upper = task.robot.lower[0], task.robot.upper[0]
    own = task.reference[0]
    grid = lower + (upper - lower) * np.arange(RAIL_POSITIONS) / (RAIL_POSITIONS - 1)
    # Rounding of the grid would make a second of one place.
    positions = np.sort(np.append(grid[np.abs(grid - own) > RAIL_FINE_M], own))
    travel = np.abs(positions - own)
    return np.asarray(positions[np.argsort(travel, kind="stable")])
