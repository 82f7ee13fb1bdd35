"""One plain synchronised timing: a trapezoidal speed along each piece, rest at its ends."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solver.motion.rates import rate_ratios
from solver.motion.tolerances import FLAT_SLOPE_RAD_M, STILL_RAD
from solver.robots.model import Array, Robot


@dataclass(frozen=True)
class TrapezoidalLaw:
    """Travel from rest to rest over `distance`, in its unit, a second and a second squared."""

    distance: float
    peak_velocity: float
    acceleration: float

    @property
    def ramp_s(self) -> float:
        """Time from rest to the highest speed; that may be below the peak on a short way."""
        return min(
            self.peak_velocity / self.acceleration, math.sqrt(self.distance / self.acceleration)
        )

    @property
    def duration_s(self) -> float:
        """Time of the whole travel."""
        return self.ramp_s + self.distance / (self.acceleration * self.ramp_s)

    def position(self, times: Array) -> Array:
        """Distance travelled at times in [0, duration]; shape of `times`."""
        ramp, total = self.ramp_s, self.duration_s
        speed = self.acceleration * ramp
        from_start = np.where(
            times < ramp, self.acceleration * times**2 / 2, speed * (times - ramp / 2)
        )
        left = np.maximum(total - times, 0.0)
        return np.asarray(
            np.where(left < ramp, self.distance - self.acceleration * left**2 / 2, from_start)
        )


@dataclass(frozen=True)
class TimedRows:
    """Joint vectors, shape (n, joints) [rad], at times from 0, shape (n,) [s]."""

    times_s: Array
    joints: Array

    @property
    def duration_s(self) -> float:
        """Time of the last row."""
        return float(self.times_s[-1])

    def reversed(self) -> "TimedRows":
        """The same motion backwards."""
        return TimedRows(self.times_s[-1] - self.times_s[::-1], self.joints[::-1])


def time_joint_line(robot: Robot, start: Array, end: Array, step_s: float) -> TimedRows:
    """The straight line in joint space between two postures, all joints in step.

    The joint that needs longest sets the pace. One row when start and end are the same.
    """
    change = np.abs(end - start)
    if not change.any():
        return TimedRows(np.zeros(1), np.array([start]))
    if change.max() < STILL_RAD:
        return TimedRows(np.array([0.0, step_s]), np.array([start, end]))
    law = TrapezoidalLaw(
        distance=1.0,
        peak_velocity=float(1 / np.max(change / robot.velocity)),
        acceleration=float(1 / np.max(change / robot.acceleration)),
    )

    def line(shares: Array) -> Array:
        rows = start + shares[:, None] * (end - start)
        rows[-1] = end
        return np.asarray(rows)

    return _sample(robot, law, line, step_s)


def time_cut_in(
    robot: Robot, standoff_m: float, rows: Array, path: Callable[[Array], Array], step_s: float
) -> TimedRows:
    """The cut-in from rest to rest, with every row on the path.

    Args:
        robot: its speed limits.
        standoff_m: length of the path [m].
        rows: postures evenly spaced along the path, from which speeds are estimated.
        path: distances travelled, shape (n,), ascending to the standoff [m], to postures (n, 6).
        step_s: largest time between rows, before the last adjustment of pace.
    """
    spacing = standoff_m / (len(rows) - 1)
    slope = np.max(np.abs(np.diff(rows, axis=0)), axis=0) / spacing
    law = TrapezoidalLaw(
        distance=standoff_m,
        peak_velocity=float(np.min(robot.velocity / np.maximum(slope, FLAT_SLOPE_RAD_M))),
        acceleration=float(np.min(robot.acceleration / np.maximum(slope, FLAT_SLOPE_RAD_M))),
    )
    return _sample(robot, law, path, step_s)


def _sample(
    robot: Robot, law: TrapezoidalLaw, path: Callable[[Array], Array], step_s: float
) -> TimedRows:
    """Rows at even times; slowed down as a whole where curvature needs it."""
    n = max(2, math.ceil(law.duration_s / step_s))
    times = np.linspace(0.0, law.duration_s, n + 1)
    distances = law.position(times)
    distances[-1] = law.distance
    rows = path(distances)
    velocity, acceleration = rate_ratios(times, rows, robot.velocity, robot.acceleration)
    slowdown = max(1.0, velocity, math.sqrt(acceleration))
    return TimedRows(times * slowdown, rows)
