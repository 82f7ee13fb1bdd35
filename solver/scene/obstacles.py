"""A scene: obstacles as they are given, in the robot's base frame [m]."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.robots.shapes import Box, Capsule

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Chain:
    """A branch, a post or a wire: capsules from point to point, with balls where they meet.

    Attributes:
        id: its name in the scene.
        points_m: at least two, or one for a ball [m].
        radius_m: all along it [m].
        soft: leaves, which may be touched.
    """

    id: str
    points_m: tuple[tuple[float, float, float], ...]
    radius_m: float
    soft: bool = False

    def capsules(self) -> Iterator[Capsule]:
        """Its pieces, one between each two points."""
        ends = self.points_m[1:] or self.points_m
        for start, end in zip(self.points_m, ends, strict=False):
            yield Capsule(start, end, self.radius_m)


@dataclass(frozen=True)
class Block:
    """A box that stands in the scene.

    Attributes:
        id: its name in the scene.
        box: where, and how large.
        soft: leaves, which may be touched.
    """

    id: str
    box: Box
    soft: bool = False


@dataclass(frozen=True)
class Plane:
    """All that is behind a plane: the ground, a wall.

    Attributes:
        id: its name in the scene.
        position_m: a point of it [m].
        normal: out of the solid, of any length but zero.
    """

    id: str
    position_m: tuple[float, float, float]
    normal: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Points:
    """What a depth camera sees: balls of one size.

    Attributes:
        id: the name that a collision with one of them tells.
        points_m: shape (n, 3) [m].
        radius_m: of each [m].
        soft: leaves, which may be touched.
    """

    id: str
    points_m: Array
    radius_m: float
    soft: bool = False


@dataclass(frozen=True, eq=False)
class Scene:
    """What stands around the arm. Ids are each another."""

    chains: Sequence[Chain] = ()
    blocks: Sequence[Block] = ()
    planes: Sequence[Plane] = ()
    points: Sequence[Points] = ()

    @property
    def ids(self) -> tuple[str, ...]:
        """Of all obstacles, in the order in which they are numbered."""
        groups = (self.chains, self.blocks, self.planes, self.points)
        return tuple(one.id for group in groups for one in group)
