"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

RAIL_POSITIONS: Final = 25
"""Positions of a slide tried with the closed form: 5 cm apart on 1.2 m. Not an optimum in the
slide; `ncos` searches on around the best few of them."""

RAIL_BRACKETS: Final = 4
"""Local minima of that grid, the cheapest first, around which the slide is searched."""

RAIL_COARSE_M: Final = 1e-3
"""Step of the slide [m] to which all of them are searched, before the best goes on alone."""

RAIL_FINE_M: Final = 1e-8
"""Last step of the slide [m]: an arm's effort changes by some rad a metre, so by less than 1e-7."""

NUMERICAL_PROGRAMMES: Final = 2
"""Numerical warm starts from which the programme starts: the direct search before it has left
little to gain, and the second is for a first whose cut-in breaks."""
