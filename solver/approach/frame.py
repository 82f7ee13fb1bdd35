"""The frame of an approach: z along the forks, y along the branch, x = y cross z.

The approach angle phi turns z about the branch direction b as given:
z(phi) = cos(phi) u + sin(phi) (b x u), where u points straight out from the base, normal to b.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from solver.robots.model import Array
from solver.tolerances import PARALLEL_SINE


@dataclass(frozen=True)
class ApproachFrame:
    """Directions that an approach angle turns in, all unit and normal to each other, shape (3,).

    Attributes:
        branch: along the branch, b.
        outward: the approach direction at angle zero, u.
        sideways: the approach direction at a quarter turn, b x u.
    """

    branch: Array
    outward: Array
    sideways: Array

    def direction(self, approach_angle: float) -> Array:
        """The approach direction z, shape (3,)."""
        z = math.cos(approach_angle) * self.outward + math.sin(approach_angle) * self.sideways
        return np.asarray(z)

    def axes(self, approach_angle: float, tool_side: int) -> Array:
        """The tool frame's axes as columns x, y, z, shape (3, 3)."""
        z = self.direction(approach_angle)
        y = tool_side * self.branch
        return np.column_stack((np.cross(y, z), y, z))


def approach_frame(position: Sequence[float], branch_direction: Sequence[float]) -> ApproachFrame:
    """The frame of a target.

    Where the target's position vector is parallel to the branch, "straight out" is taken from the
    base frame's z axis, then from its x axis.
    """
    branch = _unit(np.asarray(branch_direction, dtype=np.float64))
    for candidate in (np.asarray(position, dtype=np.float64), np.eye(3)[2], np.eye(3)[0]):
        length = np.linalg.norm(candidate)
        normal = candidate - (candidate @ branch) * branch
        if length > 0 and np.linalg.norm(np.cross(branch, candidate)) >= PARALLEL_SINE * length:
            # Taking the component along b away twice leaves rounding errors of rounding errors.
            outward = _unit(normal - (normal @ branch) * branch)
            return ApproachFrame(branch, outward, np.cross(branch, outward))
    raise AssertionError("z and x cannot both be parallel to the branch")


def signed_angle(angle: float) -> float:
    """The angle less whole turns, in (-pi, pi]."""
    turned = math.remainder(angle, 2 * math.pi)
    return math.pi if turned == -math.pi else turned


def _unit(vector: Array) -> Array:
    # Scaled first: a direction may have any length, and its square may not be a number.
    scaled = vector / np.max(np.abs(vector))
    return np.asarray(scaled / np.linalg.norm(scaled))
