"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

UNIT_MISTAKE_REACHES: Final = 20.0
"""A target further away than this many times the reach was not sent in metres."""

LARGEST_STD_REACHES: Final = 0.25
"""A standard deviation above this share of the reach is refused: sent in another unit, or no
detection at all."""

SAME_POINT_M: Final = 1e-6
"""Neighbouring points of a branch this near are one point, and have no direction between them [m];
a camera tells nothing apart at a micrometre."""

LONGEST_SEGMENT_M: Final = 100.0
"""A segment of a branch longer than any tree is a mistake of units [m]."""

LEAST_STRIKE_ZONE_M: Final = 1e-9
"""A strike zone up to this is none [m]: a thousandth of what the verifier lets pass, and far above
where shares of it underflow."""

LEAST_TILT_RAD: Final = 1e-9
"""A tilt tolerance up to this is none [rad], for the same reason."""

LEAST_DWELL_S: Final = 1e-9
"""A dwell up to this is none [s]: added to the seconds before it, a shorter one is lost."""
