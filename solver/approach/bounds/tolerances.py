"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

CERTIFICATE_GAP: Final = 2e-7
"""A proven bound that is nearer to the least effort found than this, relative, is near enough: half
of the 1e-6 that `certify` promises."""

CERTIFICATE_CELLS: Final = 20_000
"""Cells of approach angles looked at for one target before the bound so far is returned."""

CERTIFICATE_PIECES: Final = 16
"""Cells that one turn of one branch starts with."""

ENCLOSURE_ROUNDING: Final = 2e-15
"""Rounding of the closed form in direction cosines, by which enclosures are widened: some ten
operations on numbers near one, at 1.1e-16 each."""

ANGLE_ROUNDING_RAD: Final = 1e-14
"""Rounding of sums of a few angles of up to two turns, by which enclosures are widened [rad]."""

ENCLOSURE_SINGULAR_WRIST: Final = 1e-9
"""sin(q5) below which nothing is taken for known of q4 and q6: where the closed form sets q4 to
zero (SINGULAR_WRIST), and ten times as far."""
