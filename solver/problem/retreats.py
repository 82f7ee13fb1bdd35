"""Where the rows of a cut-in are: evenly spaced behind the target."""

import math
from typing import Final

import numpy as np

from solver.problem.options import Options
from solver.robots.model import Array

LOOKED_AT_ROWS: Final = 16
"""Fewest postures of a cut-in that is planned: as many as the inner loops have room for at once."""

LOOKED_AT_SPACING_M: Final = 0.0027
"""Largest distance of two of them [m]. A joint that turns faster than JOINT_RATE_RAD_M (250 rad/m)
somewhere does so for some 4 mm, or turns by more than that allows from one of them to the next."""


def even_retreats(options: Options, rows: int | None = None) -> Array:
    """Distances behind the target, from the standoff down to 0, shape (rows,) [m].

    Args:
        options: of the problem.
        rows: how many; None for `path_points` of them, 2 for the ends alone.
    """
    return np.linspace(options.standoff_m, 0.0, options.path_points if rows is None else rows)


def looked_at_retreats(options: Options) -> Array:
    """Distances behind the target at which a cut-in is planned, shape (rows,) [m].

    From the standoff down to 0. They depend on the standoff alone: what is feasible does not depend
    on the rows that are sent.
    """
    spaces = math.ceil(options.standoff_m / LOOKED_AT_SPACING_M)
    return even_retreats(options, max(LOOKED_AT_ROWS, spaces + 1))
