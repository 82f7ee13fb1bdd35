"""Simple solids, of which bodies of arms and obstacles are made: capsules, boxes and forks."""

import math
from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Capsule:
    """All that is within a radius of a straight line between two points; a ball if they are one.

    Attributes:
        start_m: one end of the line, in the frame that the shape is given in [m].
        end_m: the other.
        radius_m: above zero [m].
    """

    start_m: tuple[float, float, float]
    end_m: tuple[float, float, float]
    radius_m: float

    @property
    def makes_sense(self) -> bool:
        """Whether it is finite and has a thickness."""
        ends = (*self.start_m, *self.end_m)
        return all(map(math.isfinite, ends)) and 0.0 < self.radius_m < math.inf


@dataclass(frozen=True)
class Box:
    """A cuboid.

    Attributes:
        position_m: its centre [m].
        size_m: lengths of its edges, above zero [m].
        quaternion_xyzw: how its edges are turned; of any length but zero.
    """

    position_m: tuple[float, float, float]
    size_m: tuple[float, float, float]
    quaternion_xyzw: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)

    @property
    def makes_sense(self) -> bool:
        """Whether it is finite, has a volume and is turned somehow."""
        numbers = (*self.position_m, *self.size_m, *self.quaternion_xyzw)
        turned = any(self.quaternion_xyzw)
        return all(map(math.isfinite, numbers)) and min(self.size_m) > 0.0 and turned


@dataclass(frozen=True)
class Forks:
    """Two round rods along the tool's z axis, one at either side of the branch that is thinned.

    They lie in the plane across the branch (the tool's x and z axes).

    Attributes:
        gap_m: free width between them [m].
        length_m: from their root to their tips [m].
        thickness_m: diameter of each [m].
        ahead_m: how far the tips are beyond the tool centre point [m].
    """

    gap_m: float
    length_m: float
    thickness_m: float
    ahead_m: float

    @property
    def makes_sense(self) -> bool:
        """Whether they are finite, have a thickness and reach the tool centre point."""
        sizes = (self.gap_m, self.length_m, self.thickness_m)
        return all(0.0 < size < math.inf for size in sizes) and 0.0 <= self.ahead_m < self.length_m

    def capsules(self) -> Iterator[Capsule]:
        """Both, in the tool's frame; their round ends are within the length."""
        radius = self.thickness_m / 2
        aside = self.gap_m / 2 + radius
        root, tip = self.ahead_m - self.length_m + radius, self.ahead_m - radius
        for x in (aside, -aside):
            yield Capsule((x, 0.0, min(root, tip)), (x, 0.0, max(root, tip)), radius)


@dataclass(frozen=True)
class Fixture:
    """What the arm stands on, or beside, wherever it is used: a table, a mast; in the base frame.

    Attributes:
        name: that a collision with it tells.
        capsules: some of its shapes.
        boxes: the others.
    """

    name: str
    capsules: tuple[Capsule, ...] = ()
    boxes: tuple[Box, ...] = ()
