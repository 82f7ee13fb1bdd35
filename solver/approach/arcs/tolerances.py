"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

ARC_END_RAD: Final = 1e-15
"""Width to which the ends of an arc are refined [rad]; the feasible side is kept. At the edge of
reach joints turn with the square root of the angle: 1e-12 would leave 1e-6 of the effort there."""

CELL_SWING_COSINE: Final = 0.7
"""Cosine of the turn of a joint from cell to cell (0.8 rad) from which the cell is halved: beside a
straight wrist joints 4 and 6 turn by half a turn in an arbitrarily short way."""

CLEAR_MARGIN: Final = 0.1
"""Margin [difference of cosines, or m] at both ends of a cell above which a joint is not looked at
in each row: it would have to turn back within 5 degrees of approach angle."""

CLEAR_ROOM: Final = 0.1
"""Room below the highest joint rate [a sine, see `rate_room`] at both ends of a cell above which
none is exceeded in between: the tool turns by 0.04 rad from an end to the middle, a wrist too."""

ROUND_TURN_COSINE: Final = -0.6
"""Cosine of half a joint's range below which it can be inside its limits at both ends of a cell
and have passed what it may not in between, without turning by CELL_SWING_COSINE."""

NARROW_JUMP_RAD: Final = 3e-4
"""Width to which cells next to the edge of reach, with a joint too fast at both ends, are halved
before slopes are believed [rad]."""

STRETCHED_SINE: Final = 0.1
"""Sine of the elbow's angle below which an arc that its rate ends is said to end at the reach: it
is stretched, or folded, within 0.1 rad."""

NARROWEST_CELL_RAD: Final = 1e-6
"""Cells are not halved further [rad]: a hundredth of the narrowest arc that may not be missed."""

NARROWEST_ARC_RAD: Final = 1e-9
"""Width of an arc beside a straight wrist that may not be missed [rad]: a cut-in that ends a
micrometre before one is slow in so little."""

EXTREME_ANGLE_RAD: Final = 1e-7
"""Width to which an extremum of a margin is bracketed [rad]; the value is then good to 1e-14."""

ROOT_STEPS: Final = 100
"""Steps of a root search at most; bisection alone would take some fifty."""

PULL_IN_STEPS: Final = 8
"""How often each constraint, on average, may be the one that ends a part of a cell before the cell
is taken for one that does not behave."""

CELL_STACK: Final = 64
"""Parts of a cell that wait to be looked at, at most: each halving adds one."""

ARC_SAMPLES: Final = 720
"""Approach angles on one turn, 0.5 degrees apart, at which effort is drawn."""

SAME_ANGLE_RAD: Final = 1e-12
"""Approach angles beside a cell that are taken for one [rad]: slopes there are no better known."""
