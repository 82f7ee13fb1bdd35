"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

RATE_EXCESS_RELATIVE: Final = 1e-6
"""Velocities and accelerations above their limits, relative: divided differences of times that are
rounded at 1e-13 s over steps of 1e-2 s lose nine digits in the second difference."""

SAME_TIME_S: Final = 1e-9
"""Two durations that have to be one [s]: times are rounded at 1e-13 s."""

RATE_SPACING_M: Final = 0.0027
"""Rows no further apart tell by their differences whether rates have to be looked at [m]: a joint
that turns faster than it may somewhere does so for some 4 mm, or by half a turn in no distance."""

RATE_SCREENED: Final = 0.25
"""Share of JOINT_RATE_RAD_M, from row to row, below which no joint is faster than that between two:
where it is at one point it turns by 0.4 rad or more within 3 mm."""

RATE_ZOOMS: Final = 2
"""How often the place of the fastest rate is closed in on, fiftyfold each: 0.3 mm to 0.1 um."""
