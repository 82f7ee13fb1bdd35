"""The ladder of zones that a relaxed task is solved in, and the points looked at inside them.

Zones and points are the same for every task and do not depend on how much is asked for, but for the
last of each: so what a smaller zone on the ladder offers, a larger one offers too.
"""

import math
from dataclasses import replace

import numpy as np

from solver.approach.task.task import ApproachTask
from solver.methods.relaxed.tolerances import (
    BOTH_STRIKE_M,
    BOTH_TILT_RAD,
    LOOKED_AT_STRIKE_M,
    LOOKED_AT_TILT_RAD,
    RUNG_STRIKE_M,
    RUNG_TILT_RAD,
    SWING_DIRECTIONS,
)
from solver.problem.options import Options
from solver.robots.model import Array


def strike_rungs(options: Options) -> tuple[float, ...]:
    """Strike zones of the ladder up to the one asked for, from 0 [m]."""
    return _doubling(RUNG_STRIKE_M, options.strike_zone_m) if options.strikes else (0.0,)


def tilt_rungs(options: Options) -> tuple[float, ...]:
    """Tilt tolerances of the ladder up to the one asked for, from 0 [rad]."""
    return _doubling(RUNG_TILT_RAD, options.tilt_tolerance_rad) if options.tilts else (0.0,)


def zone_of(options: Options) -> Array:
    """Strike zone [m] and tilt tolerance [rad], shape (2,); zero for one that is off."""
    strike_m = options.strike_zone_m if options.strikes else 0.0
    return np.array([strike_m, options.tilt_tolerance_rad if options.tilts else 0.0])


def in_zone(task: ApproachTask, strike_m: float, tilt_rad: float) -> ApproachTask:
    """The task with another strike zone and tilt tolerance."""
    options = replace(task.options, strike_zone_m=strike_m, tilt_tolerance_rad=tilt_rad)
    return replace(task, options=options)


def looked_at(task: ApproachTask) -> tuple[Array, Array]:
    """Points of a task's zone: strikes, shape (n,) [m], and swings, shape (n, 3) [rad].

    Closely where one relaxation alone is used, further apart where both are.
    """
    strike_m, tilt_rad = zone_of(task.options).tolist()
    strikes, none = _even(LOOKED_AT_STRIKE_M, strike_m), np.zeros((1, 3))
    swings = _swings(task, _even(LOOKED_AT_TILT_RAD, tilt_rad))
    parts = [(np.zeros(1), none), (strikes, none), (np.zeros(1), swings)]
    if strike_m > 0.0 and tilt_rad > 0.0:
        rings = _doubling(BOTH_TILT_RAD, tilt_rad)[1:]
        strikes = np.array(_doubling(BOTH_STRIKE_M, strike_m)[1:])
        parts.append((strikes, _swings(task, np.array(rings))))
    return (
        np.concatenate([np.repeat(some, len(others)) for some, others in parts]),
        np.concatenate([np.tile(others, (len(some), 1)) for some, others in parts]),
    )


def _swings(task: ApproachTask, rings: Array) -> Array:
    """Rotation vectors of every tilt in every direction, shape (n, 3) [rad]."""
    turns = np.arange(SWING_DIRECTIONS) * (2 * math.pi / SWING_DIRECTIONS)
    frame = task.frame
    circle = np.outer(np.cos(turns), frame.outward) + np.outer(np.sin(turns), frame.sideways)
    return np.asarray((rings[:, None, None] * circle).reshape(-1, 3))


def _even(step: float, last: float) -> Array:
    """Multiples of a step below `last`, and `last`, without zero."""
    if last == 0.0:
        return np.empty(0)
    return np.append(step * np.arange(1, math.ceil(last / step)), last)


def _doubling(first: float, last: float) -> tuple[float, ...]:
    """Zero, `first`, twice that and so on below `last`, and `last`."""
    count = max(0, math.ceil(math.log2(last / first)))
    return (0.0, *(first * 2.0**k for k in range(count)), last)
