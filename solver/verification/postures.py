"""The verifier's own inverse kinematics: the triangle of the arm in plain NumPy, on one branch.

No kernel and no other formula of the methods is used: postures follow from the wrist centre, on the
side where a branch stands.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.kinematics.forward import many_poses
from solver.kinematics.spherical_wrist import WristGeometry, wrist_geometry
from solver.robots.model import Array, Robot, Tool
from solver.robots.rigid import inverse

REACH = 6
LEAN = slice(7, 9)
"""Places of the reach and of the forearm's lean across the tool in what `Arms.postures` tells."""


@dataclass(frozen=True)
class Arms:
    """n arms, each with its tool's orientation; an axis of one is left for the points of each.

    Attributes:
        geometry: of them all.
        tips: tool centre points in the mount's frame, shape (3, n, 1) [m].
        x: the tool's axis there, shape (3, n, 1); so `y` and `z`.
        signs: which side of the waist's axis, of the elbow and of the wrist, shape (3, n, 1).
    """

    geometry: WristGeometry
    tips: Array
    x: Array
    y: Array
    z: Array
    signs: Array

    def centres_behind(self, retreats: Array) -> Array:
        """Wrist centres with the tool so far behind, shape (m,) [m], as (3, n, m)."""
        return np.asarray(self.tips - (self.geometry.tool_length + retreats) * self.z)

    def postures(self, centres: Array, near: Array) -> Array:
        """What wrist centres, shape (3, n, m), ask of the arm, shape (9, n, m).

        Joints on the turns nearest to those of `near`, shape (6, n, m) [rad]; how far the centre is
        inside the reach [m]; and the forearm's direction along the tool's x and y.
        """
        g, (waist, elbow, wrist) = self.geometry, self.signs
        cx, cy, cz = centres
        across = np.hypot(cx, cy)
        ahead = waist * np.sqrt(np.maximum(across**2 - g.shoulder**2, 0.0))
        r, s = ahead - g.a1, g.sign1 * (cz - g.d1)
        distance = np.hypot(r, s)
        # The triangle of upper arm and forearm.
        cosine = (distance**2 - g.a2**2 - g.l3**2) / (2 * g.a2 * g.l3)
        bend = elbow * np.arccos(np.clip(cosine, -1.0, 1.0))
        turn1 = np.arctan2(cy, cx) - np.arctan2(-g.sign1 * g.shoulder, ahead)
        turn2 = np.arctan2(s, r) - np.arctan2(g.l3 * np.sin(bend), g.a2 + g.l3 * np.cos(bend))
        forearm = turn2 + bend - g.beta
        cos1, sin1, cos, sin = np.cos(turn1), np.sin(turn1), np.cos(forearm), np.sin(forearm)
        # Its frame: along the forearm, and the two directions across.
        along = (g.sign3 * sin * cos1, g.sign3 * sin * sin1, -g.sign3 * g.sign1 * cos)
        first = (cos1 * cos, sin1 * cos, g.sign1 * sin)
        other = (g.sign3 * g.sign1 * sin1, -g.sign3 * g.sign1 * cos1)
        ahead_x, ahead_y, ahead_z = self.z
        by_first = first[0] * ahead_x + first[1] * ahead_y + first[2] * ahead_z
        by_other = other[0] * ahead_x + other[1] * ahead_y
        by_along = along[0] * ahead_x + along[1] * ahead_y + along[2] * ahead_z
        lean_x, lean_y = (
            along[0] * axis[0] + along[1] * axis[1] + along[2] * axis[2]
            for axis in (self.x, self.y)
        )
        turns = (
            turn1,
            turn2,
            bend - g.beta,
            np.arctan2(wrist * g.sign5 * by_other, wrist * g.sign5 * by_first),
            np.arctan2(wrist * np.hypot(by_first, by_other), -g.sign4 * g.sign5 * by_along),
            np.arctan2(-wrist * g.sign4 * lean_y, wrist * g.sign4 * lean_x),
        )
        found = np.empty((9, *centres.shape[1:]))
        for i, (turn, offset) in enumerate(zip(turns, g.offsets, strict=True)):
            apart = turn - offset - near[i]
            found[i] = near[i] + apart - 2 * np.pi * np.round(apart / (2 * np.pi))
        inner = distance - abs(g.a2 - g.l3)
        reach = np.minimum(np.minimum(g.a2 + g.l3 - distance, inner), across - abs(g.shoulder))
        found[REACH] = reach
        found[7], found[8] = lean_x, lean_y
        return found


def arms_of(robot: Robot, tool: Tool, branches: NDArray[np.int64], postures: Array) -> Arms:
    """Arms that keep the tool as it is in postures, shape (n, 6) [rad], on branches, shape (n,).

    Args:
        robot: an arm with a spherical wrist that is not on a rail.
        tool: its tool.
        branches: inverse kinematics branches, 0 to 7: bits of waist, elbow and wrist.
        postures: shape (n, 6) [rad].
    """
    poses = inverse(robot.mount) @ many_poses(robot, tool, postures)
    x, y, z, tips = np.moveaxis(poses[:, :3, :, None], (2, 1), (0, 1))
    places = np.stack((branches // 4, branches // 2, branches)) % 2
    signs = np.where(places[..., None] == 0, 1.0, -1.0)
    return Arms(wrist_geometry(robot, tool), tips, x, y, z, signs)
