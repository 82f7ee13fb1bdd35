"""Tolerances that two rooms of `solver.approach` or more share, with unit and reason."""

from typing import Final

ARC_CELLS: Final = 72
"""Cells of one turn in which arcs are searched (5 deg). A single joint's margin is smooth in the
angle, with a few extrema a turn; a cell must not hold two of them."""

ANGLE_STEP_RAD: Final = 1e-10
"""Width to which an approach angle is closed in on [rad]: the best of those refused, and cells in
which a joint swings too far for its kinks to be told apart."""

EXCHANGE_DENSITY: Final = 8
"""Postures looked at between two rows of the cut-in where a joint may break its limit there."""

LEAST_EFFORT_CELLS: Final = 4
"""Cells of the shortest arc: slopes beside a cell are what tells that effort is smooth in it."""

UNCERTAINTY_DEVIATIONS: Final = 3.0
"""Factor on the standard deviation: how far a target may be from where it was seen. The nearest
limit is all but flat at that scale: 99.87 % of normally distributed targets are on its feasible
side, and 97 % in the whole ball."""

TURN_CHANGE_SHARE: Final = 0.5
"""Share of what a joint's turn changes from one cell to the next by which it may leave the range
between the cell's ends. A parabola rises above its chord by an eighth of it; a square root, as at
the edge of reach, leaves its range by 0.43 at most."""
