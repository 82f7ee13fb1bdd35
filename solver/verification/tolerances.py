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

STRAIGHTNESS_SHARES: Final = (0.0, 0.25, 0.5, 0.75)
"""Shares of the way from a row to the next at which the distance from the line is measured. It is
nearly a parabola there, so its middle is among them and its quarter points tell if it is not."""

ROW_ERROR: Final = 1e-12
"""Error of a finer row above which it is improved [m and rad]: four digits above rounding, and the
next step squares it."""

ROW_ROUNDS: Final = 12
"""Steps of Newton's method that a finer row may take; from between rows that are sent four do."""

ROW_LARGEST_STEP: Final = 0.3
"""Longest step of a joint towards a finer row [rad or m]: further the arm is no longer linear."""

DISPLACED_SPACING_M: Final = 0.01
"""About how far apart rows are at which it is tried how far a target may move [m]: all rows have
one orientation, so what stops one stops those beside it no more than their distance later."""

DISPLACED_LIMITS: Final = 4
"""Limits, nearest to first order, towards which a target is moved as far as is claimed."""

DISPLACED_STEP_M: Final = 1e-7
"""Step of the differences that slopes are taken from [m]: good to 1e-7 where joints turn slowly."""

LEAST_SLOPE: Final = 1e-12
"""What a slope that may be zero is raised to before something is divided by it [1/m or 1/m2]: such
a limit is nowhere near."""

DISPLACED_SHARE: Final = 0.05
"""Share of a claimed displacement margin that is not tried: around a straight wrist the postures at
its very end are any, and rows between those tried may be nearer to it by as much."""

DISPLACED_ROUNDS: Final = 2
"""How often a direction towards a limit, or the way to a straight wrist, is found anew where it led
to: the second is right to a thousandth within 5 cm."""

DISPLACED_ERROR_M: Final = 1e-5
"""A claimed displacement margin too large by more is refused [m]: between the rows that it was
taken from a joint comes nearer to its limit by up to 5e-5 rad."""

STRAIGHT_LEAN: Final = 0.01
"""Sine of joint 5 below which the way to a straight wrist has come to one."""
