"""Problems that several tests use: the thesis's data set 3, and seeded random targets."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from solver import Options, Problem, Robot, Target
from solver.comparison.targets import as_targets, drawn_in_box
from solver.kinematics.forward import forward_kinematics

# F. Ouyang, thesis, 2012, program listing, data set 3 (cm there, m here).
DATA_SET_3 = (
    Target("1", (0.185, -0.057, 0.420), (-1, -1, 1)),
    Target("2", (0.180, -0.070, 0.425), (-1, -1, 1)),
    Target("3", (0.160, -0.083, 0.435), (-1, -1, 0)),
    Target("4", (0.150, -0.089, 0.445), (-1, -1, 0)),
    Target("5", (0.140, -0.095, 0.450), (-1, -1, 0)),
)


def data_set_3(robot: Robot, **options: object) -> Problem:
    """Data set 3 with options by keyword."""
    return Problem(robot, DATA_SET_3, options=Options(**options))  # type: ignore[arg-type]


def targets_for(method: str, seed: int, count: int) -> list[Target]:
    """Random targets that suit a method.

    `fixed_z` wants branches normal to the world's x axis, and finds an approach to few of them.
    """
    if method != "fixed_z":
        return random_targets(seed, count)
    targets = random_targets(seed, 4 * count)
    return [replace(one, branch_direction=(0.0, *one.branch_direction[1:])) for one in targets]


def in_front_of(arm: Robot, targets: Sequence[Target]) -> list[Target]:
    """Targets moved with an arm that is mounted elsewhere."""
    return [
        replace(one, position_m=tuple(arm.mount[:3, :3] @ one.position_m + arm.mount[:3, 3]))
        for one in targets
    ]


def random_targets(seed: int, count: int) -> list[Target]:
    """Targets in a box in front of the arm, branches in every direction; many are unreachable."""
    return list(as_targets(*drawn_in_box(seed, count), range(count)))


def reachable_targets(robot: Robot, seed: int, count: int) -> list[Target]:
    """Where the tool is in random postures well inside the limits, with the branch across it."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(0.9 * robot.lower, 0.9 * robot.upper, (count, len(robot.joints)))
    poses = forward_kinematics(robot, robot.tools[0], q)
    return [
        Target(str(k), pose[:3, 3].tolist(), pose[:3, 1].tolist()) for k, pose in enumerate(poses)
    ]
