"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

RAIL_POSITIONS: Final = 25
"""Positions of a slide tried with the closed form: 5 cm apart on 1.2 m. Not an optimum in the
slide; `ncos` starts from the best of them."""
