"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

PARALLEL_SINE: Final = 1e-6
"""|b x p| / |p|, a sine, below which "straight out from the base" defines no zero of the angle."""
