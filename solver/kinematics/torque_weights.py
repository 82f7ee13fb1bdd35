"""Joint weights from the arm's own torques: the waist costs more than the wrist (T 5.2.2)."""

from functools import lru_cache

import numpy as np

from solver.kinematics.dynamics import joint_loads
from solver.kinematics.tolerances import WEIGHT_POSTURES, WEIGHT_SEED
from solver.robots.model import Array, Robot, Tool


@lru_cache(maxsize=64)
def torque_weights(robot: Robot, tool: Tool) -> tuple[float, ...]:
    """The weight of each joint, of mean 1, so that it compares with `uniform`.

        w_i = t_i / mean(t),   t_i^2 = mean over postures of g_i^2 + (M_ii a_i)^2

    g_i is the torque that gravity asks of joint i, M_ii the inertia that it feels when it moves
    alone. a_i is one acceleration for all revolute joints, the least of their limits, so that all
    are asked for the same motion; a prismatic joint has its own. The mean of squares is that over
    speeding up and slowing down, in which the product of the two parts cancels. The postures are
    drawn evenly inside the joint limits with a fixed seed: the weights belong to robot and tool and
    to no posture. A prismatic joint's t is a force; t times travel is an energy for both kinds.

    Args:
        robot: an arm with masses.
        tool: its tool.
    """
    loads = torque_parts(robot, tool)
    total = np.sqrt(np.sum(loads**2, axis=0))
    return tuple(float(value) for value in total / total.mean())


def torque_parts(robot: Robot, tool: Tool) -> Array:
    """Root mean squares of gravity's and inertia's part, shape (2, n) [N m; N]."""
    rng = np.random.default_rng(WEIGHT_SEED)
    q = rng.uniform(robot.lower, robot.upper, (WEIGHT_POSTURES, len(robot.joints)))
    loads = joint_loads(robot, tool, q)
    turning = robot.turning > 0
    common = robot.acceleration[turning].min() if turning.any() else 0.0
    accelerations = np.where(turning, common, robot.acceleration)
    parts = np.stack((loads.gravity, loads.inertia * accelerations))
    return np.asarray(np.sqrt(np.mean(parts**2, axis=1)))
