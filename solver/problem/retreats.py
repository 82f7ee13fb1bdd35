"""Where the rows of a cut-in are: evenly spaced behind the target."""

import numpy as np

from solver.problem.options import Options
from solver.robots.model import Array


def even_retreats(options: Options, rows: int | None = None) -> Array:
    """Distances behind the target, from the standoff down to 0, shape (rows,) [m].

    Args:
        options: of the problem.
        rows: how many; None for `path_points` of them, 2 for the ends alone.
    """
    return np.linspace(options.standoff_m, 0.0, options.path_points if rows is None else rows)
