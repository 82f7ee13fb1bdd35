"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

STILL_RAD: Final = 1e-9
"""Two postures that differ by less are one step apart at any speed [rad]; the time that the speed
limits allow for less and less travel would end in an overflow."""

FLAT_SLOPE_RAD_M: Final = 1e-6
"""A joint that turns less along the cut-in does not set its pace [rad/m]; no division by zero."""
