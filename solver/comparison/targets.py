"""Seeded targets of the table-top arm, drawn from a box or at the edges of what it can do."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from solver.kinematics.forward import forward_kinematics
from solver.problem.targets import Target
from solver.robots.model import Array, Robot, Tool

BOX: Final = (0.05, -0.3, 0.05), (0.38, 0.3, 0.5)
"""Corners of the box in front of the arm from which positions are drawn [m]."""


def drawn_in_box(seed: int, count: int) -> tuple[Array, Array]:
    """Positions anywhere in the box and branches in every direction, shape (count, 3) each [m, 1].

    Half of them have no approach.
    """
    rng = np.random.default_rng(seed)
    positions = rng.uniform(*BOX, (count, 3))
    return positions, rng.normal(size=(count, 3))


def drawn_at_edges(
    robot: Robot, tool: Tool, margin_rad: float, seed: int, count: int
) -> tuple[Array, Array]:
    """Targets at the edges of what an arm with a spherical wrist can do, shape (count, 3) each.

    They are where random postures put the tool: a third with a joint beside its limit, a third with
    a nearly straight wrist, a third with a nearly stretched arm; branches lie along the tool's y.
    Half of them lose their cut-in.

    Args:
        robot: the arm.
        tool: its tool.
        margin_rad: kept from the limits [rad].
        seed: of the random numbers.
        count: how many.
    """
    rng = np.random.default_rng(seed)
    lower, upper = robot.limits_within(margin_rad)
    q = rng.uniform(lower, upper, (count, len(lower)))
    beside = 10.0 ** rng.uniform(-5, -1, count)
    k = np.arange(count)
    joint, kind = rng.integers(len(lower), size=count), k % 3
    at_limit = np.where(rng.random(count) < 0.5, lower[joint] + beside, upper[joint] - beside)
    q[k[kind == 0], joint[kind == 0]] = at_limit[kind == 0]
    signs = rng.choice((-1.0, 1.0), count)
    q[kind == 1, 4] = (signs * beside)[kind == 1]
    q[kind == 2, 2] = (signs * beside)[kind == 2]
    poses = forward_kinematics(robot, tool, q)
    return poses[:, :3, 3], poses[:, :3, 1]


def as_targets(positions: Array, directions: Array, kept: Sequence[int]) -> tuple[Target, ...]:
    """The targets of some rows, named by what number they were drawn as."""
    return tuple(
        Target(str(k), tuple(positions[k].tolist()), tuple(directions[k].tolist())) for k in kept
    )
