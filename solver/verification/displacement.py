"""How far targets may move, by means of the verifier's own: postures there, one by one.

Nothing of `solver.approach.uncertainty` is used. The posture at a shifted wrist centre follows from
the triangle of the arm in plain NumPy, on the side where the posture stands; slopes are differences
of such postures. What an approach claims is tried out: its target is moved by as much against each
of the nearest limits, in the direction in which that is nearest there, and around a wrist that is
nearly straight.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from solver.kinematics.families.registry import family_of
from solver.problem.problem import Problem
from solver.robots.model import Array, Robot
from solver.verification.postures import LEAN, REACH, Arms, arms_of
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

_OF_LIMIT: Final = np.array([*range(6), *range(6), REACH])
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
    family = family_of(robot, problem.mounted_tool)
    if family.has_closed_form:
        return _overshoots(problem, robot, branches, paths, claims)
    found = np.empty(len(paths))
    for k, path in enumerate(paths):
        standing, own = family.standing(robot, path[-1]), slice(k, k + 1)
        assert standing is not None, "it has branches"
        arm, joints = standing.arm, paths[own, :, standing.first :]
        found[own] = _overshoots(problem, arm, branches[own], joints, claims[own])
    return found


def _slopes(arms: Arms, centres: Array, near: Array) -> tuple[Array, Array]:
    """`Arms.postures`, and their slopes by forward differences, shape (9, 3, n, m) [1/m]."""
    n, m = centres.shape[1:]
    steps = np.zeros((3, 1, 4, 1))
    steps[:, 0, 1:, 0] = DISPLACED_STEP_M * np.eye(3)
    every = (centres[:, :, None] + steps).reshape(3, n, 4 * m)
    same = np.broadcast_to(near[:, :, None], (6, n, 4, m)).reshape(6, n, 4 * m)
    found = arms.postures(every, same).reshape(9, n, 4, m)
    here = found[:, :, 0]
    change = (found[:, :, 1:] - found[:, :, :1]) / DISPLACED_STEP_M
    return here, np.swapaxes(change, 1, 2)


def _overshoots(
    problem: Problem, robot: Robot, branches: NDArray[np.int64], paths: Array, claims: Array
) -> Array:
    options = problem.options
    arms = arms_of(robot, problem.mounted_tool, branches, paths[:, -1])
    lower, upper = (one[:, None, None] for one in robot.limits_within(options.limit_margin_rad))

    def room(found: Array) -> Array:
        """Distances to the limits [rad, or m for the reach], shape (13, n, m), of postures."""
        joints = found[:6]
        return np.concatenate((joints - lower, upper - joints, found[REACH : REACH + 1]))

    rows = max(2, round(options.standoff_m / DISPLACED_SPACING_M)) + 1
    centres = arms.centres_behind(np.linspace(options.standoff_m, 0.0, rows))
    sent = np.round(np.linspace(0, paths.shape[1] - 1, rows)).astype(np.int64)
    near = np.moveaxis(paths[:, sent], 2, 0)
    here, slopes = _slopes(arms, centres, near)
    near = here[:6]
    steep = _length(slopes[: REACH + 1], 1)
    distances = room(here) / steep[_OF_LIMIT]

    nearest_row = distances.argmin(axis=2)
    nearest = np.take_along_axis(distances, nearest_row[..., None], axis=2)[..., 0]
    limits = np.argpartition(nearest, DISPLACED_LIMITS, axis=0)[:DISPLACED_LIMITS].T
    own = np.arange(len(paths))[:, None]
    row = nearest_row[limits, own]
    against = _against(slopes[_OF_LIMIT[limits], :, own, row], limits)
    start, near_start = centres[:, own, row], near[:, own, row]
    worst, least_steep = -nearest.min(axis=0), steep[:, own, row]
    for _ in range(DISPLACED_ROUNDS):
        found, slopes_there = _slopes(arms, start + claims[:, None] * against, near_start)
        # At the edge of reach differences step out of it, where joints stand still.
        steep_there = np.maximum(_length(slopes_there[: REACH + 1], 1), least_steep)[_OF_LIMIT]
        worst = np.maximum(worst, _deepest(room(found), steep_there))
        places = np.arange(limits.shape[1])
        against = _against(slopes_there[_OF_LIMIT[limits], :, own, places], limits)
    found = arms.postures(start + claims[:, None] * against, near_start)
    worst = np.maximum(worst, _deepest(room(found), steep_there))

    way = _way_to_straight(here[LEAN], slopes[LEAN], 0.0)
    row = _length(way, 0).argmin(axis=1)[:, None]
    start, near_start, way = centres[:, own, row], near[:, own, row], way[:, own, row]
    for _ in range(DISPLACED_ROUNDS):
        found, slopes_there = _slopes(arms, start + way, near_start)
        way = _way_to_straight(found[LEAN], slopes_there[LEAN], way)
    found = arms.postures(start + way, near_start)
    is_straight = np.hypot(*found[LEAN])[:, 0] <= STRAIGHT_LEAN
    beyond = (claims[:, None] - _length(way, 0))[:, 0]
    worst = np.where(is_straight & (found[REACH, :, 0] >= 0), np.maximum(worst, beyond), worst)
    found = arms.postures(
        start + claims[:, None] * _CORNERS[:, None],
        np.broadcast_to(near_start, (6, len(paths), _CORNERS.shape[1])),
    )
    return np.asarray(np.maximum(worst, _deepest(room(found), steep[_OF_LIMIT][:, own, row])))


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
