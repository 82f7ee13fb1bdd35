"""The direct search from the cheapest arrivals of different solution families."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from solver.approach.numerical.descent import descend, holds
from solver.approach.numerical.sweep import Arrival, apart, pose_family
from solver.approach.numerical.tolerances import (
    DESCENT_DIRECTIONS,
    DESCENT_ROWS,
    DESCENT_STARTS,
    OTHER_FAMILY_RAD,
)
from solver.approach.task.task import ApproachTask
from solver.kinematics.numerical import chain_of
from solver.problem.effort import posture_effort
from solver.robots.model import Array

_POSE: Final = 6


def refined(task: ApproachTask, arrivals: Sequence[Arrival]) -> list[Arrival]:
    """What the search ended with, the least effort first.

    It starts from the DESCENT_STARTS first arrivals that are well apart and have a cut-in. That is
    looked at in DESCENT_ROWS rows here: the whole of it is still to be looked at. Arms of five
    joints or fewer have nothing to choose beside a solution: arrivals are returned as they are.
    """
    if len(task.reference) < _POSE:
        return list(arrivals)
    chain, options = chain_of(task.robot, task.tool), task.options
    weights = np.asarray(task.joint_weights, dtype=np.float64)
    retreats = np.linspace(task.retreats_m[0], 0.0, DESCENT_ROWS)
    directions = _directions(options.seed, len(task.reference) + 1)
    families = {side: pose_family(task, side, task.lower, task.upper) for side in task.tool_sides}
    begun: list[Array] = []
    ended: list[tuple[float, Arrival]] = []
    for one in arrivals:
        if len(ended) == DESCENT_STARTS:
            break
        family = families[one.tool_side]
        if not apart(one.posture, begun, OTHER_FAMILY_RAD):
            continue
        begun.append(one.posture)
        if not holds(chain, family, retreats, one.posture):
            continue
        posture = one.posture.copy()
        angle = descend(
            chain, family, retreats, weights, options.squared, directions, one.angle_rad, posture
        )
        effort = posture_effort(posture, task.reference, task.joint_weights, options.norm)
        ended.append((effort, Arrival(posture, angle, one.tool_side)))
    return [one for _, one in sorted(ended, key=lambda entry: entry[0])]


def _directions(seed: int, size: int) -> Array:
    """Directions of length one, evenly drawn, shape (DESCENT_DIRECTIONS, size)."""
    drawn = np.random.default_rng(seed).normal(size=(DESCENT_DIRECTIONS, size))
    return np.asarray(drawn / np.linalg.norm(drawn, axis=1)[:, None])
