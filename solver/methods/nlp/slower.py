"""Bounds that keep a posture's joints from turning faster than they may along the cut-in.

A programme does not know of rates. A joint turns too fast where the elbow is all but stretched or
folded, or the wrist straight: sin g or sin5 is below what its rate's numerator needs (see
`solver.kinematics.straight_rates`). A bound on joint 3 or 5 keeps it above, on its side.
"""

import math

import numpy as np

from solver.approach.task.task import ApproachTask
from solver.kinematics.spherical_wrist import wrap, wrist_geometry
from solver.kinematics.straight_rates import posture_rates
from solver.methods.nlp.tolerances import RATE_BOUND_SPARE
from solver.robots.model import Array
from solver.tolerances import JOINT_RATE_RAD_M

ELBOW, WRIST = 2, 4


def slower_limits(task: ApproachTask, posture: Array, limits: Array) -> Array | None:
    """Limits of a posture, drawn in so that the joint of its fastest rate is slow enough.

    Args:
        task: of an arm with a closed form.
        posture: where joints turn too fast, shape (6,) [rad].
        limits: lower and upper limits so far, shape (2, 6) [rad].

    Returns:
        New limits, shape (2, 6); None where only the waist is too fast, which no bound slows, or
        the joint has no room left.
    """
    geometry, rates = wrist_geometry(task.robot, task.tool), np.empty(6)
    posture_rates(geometry, posture, rates)
    elbow, wrist = rates[[1, 2]].max(), rates[[3, 5]].max()
    joint, rate = (ELBOW, elbow) if elbow >= wrist else (WRIST, wrist)
    if rate <= JOINT_RATE_RAD_M:
        return None
    offset = geometry.offsets[joint] + (geometry.beta if joint == ELBOW else 0.0)
    angle = wrap(posture[joint] + offset)
    needed = abs(math.sin(angle)) * rate / JOINT_RATE_RAD_M * (1.0 + RATE_BOUND_SPARE)
    if needed >= 1.0:
        return None
    straight = abs(angle) < math.pi / 2
    least = math.copysign(math.asin(needed) if straight else math.pi - math.asin(needed), angle)
    drawn = limits.copy()
    outwards = (angle > 0.0) == straight
    bound = posture[joint] + least - angle
    if outwards:
        drawn[0, joint] = max(drawn[0, joint], bound)
    else:
        drawn[1, joint] = min(drawn[1, joint], bound)
    return drawn if drawn[0, joint] < drawn[1, joint] else None
