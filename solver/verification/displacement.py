"""How far targets may move, by means of the verifier's own: postures there, one by one.

Nothing of `solver.approach.uncertainty` is used. The posture at a shifted wrist centre follows from
the triangle of the arm in plain NumPy, on the side where the posture stands; slopes are differences
of such postures. What an approach claims is tried out: its target is moved by as much against each
of the nearest limits, in the direction in which that is nearest there, and around a wrist that is
nearly straight.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from solver.kinematics.families import rail_of
from solver.kinematics.forward import many_poses
from solver.kinematics.spherical_wrist import WristGeometry, wrist_geometry
from solver.problem.problem import Problem
from solver.robots.model import Array, Robot
from solver.robots.rigid import inverse
from solver.verification.tolerances import (
    DISPLACED_LIMITS,
    DISPLACED_ROUNDS,
    DISPLACED_SHARE,
    DISPLACED_SPACING_M,
    DISPLACED_STEP_M,
    LEAST_SLOPE,
    STRAIGHT_LEAN,
)

_CORNERS: Final = (
    np.array([(x, y, z) for x in (1, -1) for y in (1, -1) for z in (1, -1)]).T / 3**0.5
)
"""Directions to all sides, shape (3, 8)."""

_REACH: Final = 6
_LEAN: Final = slice(7, 9)
"""Places of the reach and of the forearm's lean across the tool among what is looked at."""

_OF_LIMIT: Final = np.array([*range(6), *range(6), _REACH])
_SIGNS: Final = np.array([*(1.0,) * 6, *(-1.0,) * 6, 1.0])
"""Of each limit, lower ones first, then upper ones, then the reach: what it limits, and the sign
with which its distance grows."""


def displacement_overshoots(
    problem: Problem, branches: NDArray[np.int64], paths: Array, claims: Array
) -> Array:
    """By how much n claims of how far targets may move are too large, shape (n,) [m].

    They are tried short of DISPLACED_SHARE of themselves. Not above zero where nothing is met
    there; not a number where nothing is claimed.

    Args:
        problem: what was asked.
        branches: inverse kinematics branches, on a rail those of the arm, shape (n,).
        paths: the cut-ins, standby first, shape (n, path_points, joints) [rad or m].
        claims: how far each target may move, shape (n,) [m].
    """
    robot, claims = problem.robot, (1.0 - DISPLACED_SHARE) * claims
    rail = rail_of(robot, problem.mounted_tool)
    if rail is None:
        return _overshoots(problem, robot, branches, paths, claims)
    found = np.empty(len(paths))
    for k, path in enumerate(paths):
        arm, own = rail.arm_at(float(path[-1, 0])), slice(k, k + 1)
        found[own] = _overshoots(problem, arm, branches[own], paths[own, :, 1:], claims[own])
    return found


@dataclass(frozen=True)
class _Arms:
    """n arms, each with its tool's orientation; an axis of one is left for the points of each.

    Attributes:
        x: the tool's axis in the mount's frame, shape (3, n, 1); so `y` and `z`.
        signs: which side of the waist's axis, of the elbow and of the wrist, shape (3, n, 1).
        lower: limits less the margin asked for, shape (6, 1, 1) [rad]; so `upper`.
    """

    geometry: WristGeometry
    x: Array
    y: Array
    z: Array
    signs: Array
    lower: Array
    upper: Array

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
        found[_REACH] = reach
        found[7], found[8] = lean_x, lean_y
        return found

    def slopes(self, centres: Array, near: Array) -> tuple[Array, Array]:
        """`postures`, and their slopes by forward differences, shape (9, 3, n, m) [1/m]."""
        n, m = centres.shape[1:]
        steps = np.zeros((3, 1, 4, 1))
        steps[:, 0, 1:, 0] = DISPLACED_STEP_M * np.eye(3)
        every = (centres[:, :, None] + steps).reshape(3, n, 4 * m)
        same = np.broadcast_to(near[:, :, None], (6, n, 4, m)).reshape(6, n, 4 * m)
        found = self.postures(every, same).reshape(9, n, 4, m)
        here = found[:, :, 0]
        change = (found[:, :, 1:] - found[:, :, :1]) / DISPLACED_STEP_M
        return here, np.swapaxes(change, 1, 2)

    def room(self, found: Array) -> Array:
        """Distances to the limits [rad, or m for the reach], shape (13, n, m), of `postures`."""
        joints = found[:6]
        parts = (joints - self.lower, self.upper - joints, found[_REACH : _REACH + 1])
        return np.concatenate(parts)


def _overshoots(
    problem: Problem, robot: Robot, branches: NDArray[np.int64], paths: Array, claims: Array
) -> Array:
    tool, options = problem.mounted_tool, problem.options
    geometry = wrist_geometry(robot, tool)
    poses = inverse(robot.mount) @ many_poses(robot, tool, paths[:, -1])
    x, y, z = np.moveaxis(poses[:, :3, :3, None], (2, 1), (0, 1))
    places = np.stack((branches // 4, branches // 2, branches)) % 2
    signs = np.where(places[..., None] == 0, 1.0, -1.0)
    lower, upper = (one[:, None, None] for one in robot.limits_within(options.limit_margin_rad))
    arms = _Arms(geometry, x, y, z, signs, lower, upper)

    rows = max(2, round(options.standoff_m / DISPLACED_SPACING_M)) + 1
    behind = geometry.tool_length + np.linspace(options.standoff_m, 0.0, rows)
    centres = poses[:, :3, 3].T[..., None] - behind * z
    sent = np.round(np.linspace(0, paths.shape[1] - 1, rows)).astype(np.int64)
    near = np.moveaxis(paths[:, sent], 2, 0)
    here, slopes = arms.slopes(centres, near)
    near = here[:6]
    steep = _length(slopes[: _REACH + 1], 1)
    distances = arms.room(here) / steep[_OF_LIMIT]

    nearest_row = distances.argmin(axis=2)
    nearest = np.take_along_axis(distances, nearest_row[..., None], axis=2)[..., 0]
    limits = np.argpartition(nearest, DISPLACED_LIMITS, axis=0)[:DISPLACED_LIMITS].T
    own = np.arange(len(paths))[:, None]
    row = nearest_row[limits, own]
    against = _against(slopes[_OF_LIMIT[limits], :, own, row], limits)
    start, near_start = centres[:, own, row], near[:, own, row]
    worst, least_steep = -nearest.min(axis=0), steep[:, own, row]
    for _ in range(DISPLACED_ROUNDS):
        found, slopes_there = arms.slopes(start + claims[:, None] * against, near_start)
        # At the edge of reach differences step out of it, where joints stand still.
        steep_there = np.maximum(_length(slopes_there[: _REACH + 1], 1), least_steep)[_OF_LIMIT]
        worst = np.maximum(worst, _deepest(arms.room(found), steep_there))
        places = np.arange(limits.shape[1])
        against = _against(slopes_there[_OF_LIMIT[limits], :, own, places], limits)
    found = arms.postures(start + claims[:, None] * against, near_start)
    worst = np.maximum(worst, _deepest(arms.room(found), steep_there))

    way = _way_to_straight(here[_LEAN], slopes[_LEAN], 0.0)
    row = _length(way, 0).argmin(axis=1)[:, None]
    start, near_start, way = centres[:, own, row], near[:, own, row], way[:, own, row]
    for _ in range(DISPLACED_ROUNDS):
        found, slopes_there = arms.slopes(start + way, near_start)
        way = _way_to_straight(found[_LEAN], slopes_there[_LEAN], way)
    found = arms.postures(start + way, near_start)
    is_straight = np.hypot(*found[_LEAN])[:, 0] <= STRAIGHT_LEAN
    beyond = (claims[:, None] - _length(way, 0))[:, 0]
    worst = np.where(is_straight & (found[_REACH, :, 0] >= 0), np.maximum(worst, beyond), worst)
    found = arms.postures(
        start + claims[:, None] * _CORNERS[:, None],
        np.broadcast_to(near_start, (6, len(paths), _CORNERS.shape[1])),
    )
    return np.asarray(np.maximum(worst, _deepest(arms.room(found), steep[_OF_LIMIT][:, own, row])))


def _against(slopes: Array, limits: NDArray[np.int64]) -> Array:
    """Unit directions towards limits, (3, n, m), from slopes of what they limit, (n, m, 3)."""
    towards = -_SIGNS[limits][..., None] * slopes
    return np.asarray(np.moveaxis(towards / _length(towards, 2)[..., None], 2, 0))


def _deepest(room: Array, steep: Array) -> Array:
    """The furthest that a limit is passed at some of the points, shape (n,) [m]."""
    return np.asarray(-(room / steep).min(axis=(0, 2)))


def _way_to_straight(lean: Array, slopes: Array, way: Array | float) -> Array:
    """The shortest shift that straightens the wrist to first order, shape (3, n, m) [m].

    Args:
        lean: the forearm's direction along the tool's x and y, shape (2, n, m).
        slopes: of both, shape (2, 3, n, m) [1/m].
        way: the shift already made, shape (3, n, m) [m].
    """
    one, two = slopes
    left = -lean + np.sum(slopes * way, axis=1)
    m11, m12, m22 = (np.sum(a * b, axis=0) for a, b in ((one, one), (one, two), (two, two)))
    determinant = np.maximum(m11 * m22 - m12 * m12, LEAST_SLOPE)
    along, across = m22 * left[0] - m12 * left[1], m11 * left[1] - m12 * left[0]
    return np.asarray((along * one + across * two) / determinant)


def _length(vectors: Array, axis: int) -> Array:
    return np.asarray(np.maximum(np.sqrt(np.sum(vectors * vectors, axis=axis)), LEAST_SLOPE))
