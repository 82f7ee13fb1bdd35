"""Velocities and accelerations of timed rows, against limits."""

import numpy as np

from solver.robots.model import Array


def rate_ratios(
    times: Array, rows: Array, velocity: Array, acceleration: Array
) -> tuple[float, float]:
    """Largest velocity and acceleration as shares of their limits, for a motion from rest to rest.

    Args:
        times: shape (n,), strictly increasing [s].
        rows: shape (n, joints) [rad], linear between rows.
        velocity: limits, shape (joints,) [rad/s].
        acceleration: limits, shape (joints,) [rad/s2].

    The accelerations are second divided differences, with rest before the first row and after the
    last. Where the rows sample a smooth motion each is a mean of that motion's acceleration, so a
    motion inside its limits has no ratio above 1.
    """
    if len(times) < 2:
        return 0.0, 0.0
    steps = np.diff(times)[:, None]
    speeds = np.diff(rows, axis=0) / steps
    inner = 2 * np.diff(speeds, axis=0) / (steps[1:] + steps[:-1])
    ends = 2 * speeds[[0, -1]] / steps[[0, -1]]
    accelerations = np.concatenate((inner, ends))
    return (
        float(np.max(np.abs(speeds) / velocity)),
        float(np.max(np.abs(accelerations) / acceleration)),
    )
