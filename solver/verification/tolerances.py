"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

RATE_EXCESS_RELATIVE: Final = 1e-6
"""Velocities and accelerations above their limits, relative: divided differences of times that are
rounded at 1e-13 s over steps of 1e-2 s lose nine digits in the second difference."""

SAME_TIME_S: Final = 1e-9
"""Two durations that have to be one [s]: times are rounded at 1e-13 s."""
