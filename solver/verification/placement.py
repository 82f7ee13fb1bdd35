"""How a tool stands to its target, by means of the verifier's own: no rotation vectors.

The smallest rotation that takes a unit direction to another is written out for the vector that it
is applied to. The methods use `solver.approach.task.relaxation`.
"""

from dataclasses import dataclass

import numpy as np

from solver.robots.model import Array


@dataclass(frozen=True)
class Seen:
    """A tool pose seen from a target.

    Attributes:
        strike_m: how far the tool centre point is beyond the target along z [m].
        tilt_rad: angle between the tool's y axis and where it should point, along the branch.
        along: where it should point, shape (3,).
        towards: where it leans to from there, unit and normal to it, shape (3,); zero where it does
            not lean, or points the opposite way.
    """

    strike_m: float
    tilt_rad: float
    along: Array
    towards: Array

    def leaning(self, axes: Array, most_rad: float) -> Array:
        """Axes, columns of (3, 3), that lean as the tool does, but no further than `most_rad`."""
        angle = min(self.tilt_rad, most_rad)
        leant = np.cos(angle) * self.along + np.sin(angle) * self.towards
        return least_rotation(self.along, leant, axes)


def seen_from(position: Array, branch: Array, tool_side: int, pose: Array) -> Seen:
    """A tool pose taken apart.

    Args:
        position: the target, shape (3,) [m].
        branch: unit direction of its branch, shape (3,).
        tool_side: 1 or -1.
        pose: the tool frame at thinning, shape (4, 4) [m].
    """
    along, y, z = tool_side * branch, pose[:3, 1], pose[:3, 2]
    across = y - (y @ along) * along
    sine = float(np.sqrt(across @ across))
    towards = across / sine if sine > 0.0 else np.zeros(3)
    strike = float(z @ (pose[:3, 3] - position))
    return Seen(strike, float(np.arctan2(sine, y @ along)), along, towards)


def least_rotation(start: Array, end: Array, vectors: Array) -> Array:
    """Vectors, columns of (3, n), turned by the smallest rotation from a unit direction to another.

    v - (a + c) (a + c).v / (1 + a.c) + 2 c (a.v), with a the start and c the end: half a turn about
    the middle of both, and one about c. Opposite directions have no such rotation.
    """
    middle = start + end
    halves = np.outer(middle, middle @ vectors) / (1.0 + start @ end)
    return np.asarray(vectors - halves + 2.0 * np.outer(end, start @ vectors))
