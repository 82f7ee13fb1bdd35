"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

# --- Approach frame and request -----------------------------------------------------------------
UNIT_MISTAKE_REACHES: Final = 20.0
"""A target further away than this many times the reach was not sent in metres."""

# --- Uncertain targets --------------------------------------------------------------------------
LARGEST_STD_REACHES: Final = 0.25
"""A standard deviation above this share of the reach is refused: sent in another unit, or no
detection at all."""

# --- Strawberry mechanism -----------------------------------------------------------------------
SAME_POINT_M: Final = 1e-6
"""Neighbouring points of a branch this near are one point, and have no direction between them [m];
a camera tells nothing apart at a micrometre."""
