"""The frame of an approach: z along the forks, y along the branch, x = y cross z.

The approach angle phi turns z about the branch direction b as given:
z(phi) = cos(phi) u + sin(phi) (b x u), where u points straight out from the base, normal to b.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from solver.approach.task.tolerances import PARALLEL_SINE
from solver.robots.model import Array


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
    """The frame of a target; see `approach_frames`."""
    return _frame(tuple(map(float, position)), tuple(map(float, branch_direction)))


@lru_cache(maxsize=256)
def _frame(position: tuple[float, ...], branch_direction: tuple[float, ...]) -> ApproachFrame:
    vectors = approach_frames(np.array([position]), np.array([branch_direction]))
    return ApproachFrame(*(_read_only(vector[0]) for vector in vectors))


def _read_only(vector: Array) -> Array:
    vector.flags.writeable = False
    return vector


def approach_frames(positions: Array, branch_directions: Array) -> tuple[Array, Array, Array]:
    """Frames of n targets: b, u and b x u, shape (n, 3) each, from positions and directions (n, 3).

    Where a target's position vector is parallel to the branch, "straight out" is taken from the
    base frame's z axis, then from its x axis.
    """
    branch = _unit(branch_directions)
    outward = np.empty_like(branch)
    left = np.ones(len(branch), dtype=np.bool_)
    for candidate in (positions, np.eye(3)[[2]], np.eye(3)[[0]]):
        vectors = np.broadcast_to(candidate, branch.shape)
        sines = np.linalg.norm(_cross(branch, vectors), axis=1)
        lengths = np.linalg.norm(vectors, axis=1)
        usable = left & (lengths > 0) & (sines >= PARALLEL_SINE * lengths)
        normal = _without(vectors[usable], branch[usable])
        # Taking the component along b away twice leaves rounding errors of rounding errors.
        outward[usable] = _unit(_without(normal, branch[usable]))
        left &= ~usable
        if not left.any():
            break
    assert not left.any(), "z and x cannot both be parallel to the branch"
    return branch, outward, _cross(branch, outward)


def signed_angle(angle: float) -> float:
    """The angle less whole turns, in (-pi, pi]."""
    turned = math.remainder(angle, 2 * math.pi)
    return math.pi if turned == -math.pi else turned


def _cross(a: Array, b: Array) -> Array:
    # NumPy's own takes ten times as long for a few vectors.
    ax, ay, az = a.T
    bx, by, bz = b.T
    return np.column_stack((ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx))


def _without(vectors: Array, branch: Array) -> Array:
    return np.asarray(vectors - np.sum(vectors * branch, axis=1, keepdims=True) * branch)


def _unit(vectors: Array) -> Array:
    # Scaled first: a direction may have any length, and its square may not be a number.
    scaled = vectors / np.max(np.abs(vectors), axis=1, keepdims=True, initial=0.0)
    return np.asarray(scaled / np.linalg.norm(scaled, axis=1, keepdims=True))
