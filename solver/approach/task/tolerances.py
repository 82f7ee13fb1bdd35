"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

PARALLEL_SINE: Final = 1e-6
"""|b x p| / |p|, a sine, below which "straight out from the base" defines no zero of the angle."""

NEAR_FEASIBLE_RAD: Final = 0.3
"""A thinning posture further outside its limits [rad], or out of reach [m], is not looked at more
closely: its cut-in is not traced."""
