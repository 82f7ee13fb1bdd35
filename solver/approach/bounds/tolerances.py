"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

from solver.tolerances import JOINT_RATE_RAD_M, RATE_EXCESS_SHARE

CERTIFICATE_GAP: Final = 2e-7
"""A proven bound that is nearer to the least effort found than this, relative, is near enough: half
of the 1e-6 that `certify` promises."""

ACCEPTED_RATE_RAD_M: Final = JOINT_RATE_RAD_M * (1.0 + 1.1 * RATE_EXCESS_SHARE)
"""Joint rate above which no approach is planned [rad/m]: the verifier's, and rounding."""

CERTIFICATE_CELLS: Final = 20_000
"""Cells of approach angles looked at for one target before the bound so far is returned."""

CERTIFICATE_PIECES: Final = 16
"""Cells that one turn of one branch starts with."""

ENCLOSURE_ROUNDING: Final = 2e-15
"""Rounding of the closed form, relative to direction cosines of one, by which enclosures are
widened: some ten operations on numbers near one, at 1.1e-16 each."""

ANGLE_ROUNDING_RAD: Final = 1e-14
"""Rounding of sums of a few angles of up to two turns, by which enclosures are widened [rad]."""

ENCLOSURE_SINGULAR_WRIST: Final = 1e-9
"""sin(q5) below which nothing is taken for known of q4 and q6: where the closed form sets q4 to
zero (SINGULAR_WRIST), and ten times as far."""

ROUNDING_STEP: Final = 2.0**-52
"""Relative step by which a result is moved outward; IEEE 754 rounds to half of it."""

LIBRARY_STEPS: Final = 4.0
"""How many times that for sin, cos, acos and atan2, which the C library keeps within one or two."""

SUM_STEPS: Final = 16.0
"""How many times that for a sum of six products of numbers that are not negative; it rounds by
fewer."""

LEAST_WIDTH: Final = 1e-300
"""What every result is moved outward by besides, in its own unit [any]: next to zero a relative
step is nothing."""

STEEPEST_SLOPE: Final = 1e30
"""Slope that stands for one without a bound [unit / rad]. Angles where the true slope is larger
still are those within 1e-60 of the root of a square root, over which it adds nothing that a double
can hold."""
