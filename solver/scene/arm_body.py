"""The arm's body as the kernels take it: capsules that its links carry, and what it stands on."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.kinematics.numerical import Chain, chain_of
from solver.robots.model import TOOL, Array, Robot, Tool
from solver.robots.rigid import inverse, transform
from solver.robots.shapes import Capsule
from solver.scene.packing import BOX_COLUMNS, box_row, capsule_rows, rows_of


class ArmBody(NamedTuple):
    """Shapes of an arm with a tool; numbers of links are those of `chain`'s frames.

    Attributes:
        chain: where the links are at a posture.
        links: whose capsule each is, from 1; shape (n,).
        capsules: in the frames of their links, rows of `Obstacles.capsules`, shape (n, columns).
        forks: whether a capsule is one of the tool's forks, shape (n,).
        fixed_capsules: of what the arm stands on, in the base frame, shape (m, columns).
        fixed_boxes: the same, rows of `Obstacles.boxes`, shape (k, columns).
        pairs: of capsules that may not meet, shape (p, 2).
        fixed_pairs: of a capsule and a fixed capsule, shape (q, 2).
        box_pairs: of a capsule and a fixed box, shape (r, 2).
    """

    chain: Chain
    links: NDArray[np.int64]
    capsules: Array
    forks: NDArray[np.bool_]
    fixed_capsules: Array
    fixed_boxes: Array
    pairs: NDArray[np.int64]
    fixed_pairs: NDArray[np.int64]
    box_pairs: NDArray[np.int64]


@lru_cache(maxsize=64)
def arm_body(robot: Robot, tool: Tool) -> ArmBody:
    """The body of an arm with a tool; without shapes where its model has none."""
    count = len(robot.joints)
    shapes: list[tuple[int, str, Capsule, bool]] = []
    # The last frame is the tool's; the last joint's own is behind it.
    flange = transform((0.0, 0.0, tool.length_m), (0.0, 0.0, robot.flange_roll_rad))
    for k, joint in enumerate(robot.joints, start=1):
        back = inverse(flange) if k == count else np.eye(4)
        shapes += [(k, joint.name, _moved(one, back), False) for one in joint.body]
    shapes += [(count, TOOL, one, False) for one in tool.body]
    if tool.forks is not None:
        shapes += [(count, TOOL, one, True) for one in tool.forks.capsules()]
    names = [name for _, name, _, _ in shapes]
    capsules = [(one.name, shape) for one in robot.fixtures for shape in one.capsules]
    boxes = [(one.name, shape) for one in robot.fixtures for shape in one.boxes]
    return ArmBody(
        chain=chain_of(robot, tool),
        links=np.array([link for link, *_ in shapes], dtype=np.int64),
        capsules=capsule_rows([shape for *_, shape, _ in shapes]),
        forks=np.array([is_fork for *_, is_fork in shapes], dtype=np.bool_),
        fixed_capsules=capsule_rows([shape for _, shape in capsules]),
        fixed_boxes=rows_of([box_row(shape) for _, shape in boxes], BOX_COLUMNS),
        pairs=_pairs(robot, names, names, one_way=True),
        fixed_pairs=_pairs(robot, names, [name for name, _ in capsules]),
        box_pairs=_pairs(robot, names, [name for name, _ in boxes]),
    )


def body_reach_m(robot: Robot, tool: Tool, most_m: float) -> float:
    """How far from the base something may be that comes within `most_m` of a part of the arm [m].

    No link's frame is further than the tool centre point may be; its shapes stick out.
    """
    shapes = arm_body(robot, tool).capsules
    ends = np.maximum(
        np.linalg.norm(shapes[:, :3], axis=1),
        np.linalg.norm(shapes[:, :3] + shapes[:, 3:6], axis=1),
    )
    return robot.reach_m(tool) + float((ends + shapes[:, 6]).max(initial=0.0)) + most_m


def shape_names(robot: Robot, tool: Tool) -> tuple[str, ...]:
    """Whose each capsule of the body is: names of joints, or TOOL."""
    own = [joint.name for joint in robot.joints for _ in joint.body]
    forks = 0 if tool.forks is None else len(list(tool.forks.capsules()))
    return (*own, *(TOOL,) * (len(tool.body) + forks))


def _moved(capsule: Capsule, pose: Array) -> Capsule:
    ends = np.array((capsule.start_m, capsule.end_m)) @ pose[:3, :3].T + pose[:3, 3]
    start, end = (tuple(at) for at in ends.tolist())
    return Capsule(start, end, capsule.radius_m)


def _pairs(
    robot: Robot, firsts: list[str], seconds: list[str], *, one_way: bool = False
) -> NDArray[np.int64]:
    apart = {frozenset(pair) for pair in robot.kept_apart}
    found = [
        (j, k)
        for j, first in enumerate(firsts)
        for k, second in enumerate(seconds)
        if frozenset((first, second)) in apart and not (one_way and k <= j)
    ]
    return np.array(found, dtype=np.int64).reshape(len(found), 2)
