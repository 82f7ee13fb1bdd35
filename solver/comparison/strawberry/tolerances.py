"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

LIMIT_EXCESS_M: Final = 1e-9
"""A slide beyond its limit by more is refused [m]: the same reason as LIMIT_EXCESS_RAD."""

INDEX_ROUNDING_J: Final = 1e-7
"""Two indices closer than this are equal [J]: IPOPT ends about 1e-9 m beside its equations, and a
metre of table costs some 25 J; a ten-thousandth of the last digit that the paper prints."""

STATIONARY_CELLS: Final = 12
"""Cells, between two changes of case, in which the index's derivative is looked at for a minimum:
less than 6.1 degrees of beta each, where the index has a single curvature."""

STATIONARY_INSET: Final = 1e-6
"""How far inside a cell, as a share of it, the derivative is taken: where a case begins it may be
infinite, and the ends are compared by their index anyway."""

STATIONARY_RAD: Final = 1e-12
"""How narrow the bracket of such a minimum becomes by bisection [rad]."""

MECHANISM_NLP_TOLERANCE: Final = 1e-10
"""Overall error of IPOPT on the mechanism's programme [J, m]: below INDEX_ROUNDING_J."""

MECHANISM_NLP_BARRIER: Final = 1e-2
"""IPOPT's first barrier parameter there [J]: below a hundredth of an index of some 6 J. Over S's
Table 3 the default of 0.1, and smaller ones, take about a tenth more iterations from the reset."""

PRINTED_SAMPLES: Final = 721
"""Values of beta at which the printed problem P1 is looked at, 0.1 degrees apart."""
