"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

EVEN_ROWS_M: Final = 1e-12
"""Rows whose distances differ by less are evenly spaced [m]: rounding."""

BETWEEN_ROWS_REACH: Final = 0.25
"""How far beyond two rows, as a share of their distance, the vertex of a parabola counts as between
them."""

BETWEEN_ROWS_CUSHION: Final = 0.05
"""Share of a joint's second difference that its parabola may be wrong by between two rows."""

MARGIN_REACH: Final = 0.75
"""The same share for the reach, or a rate's room: where that is zero in the first or last row, on
its way up beside a straight wrist, a hyperbola still falls a little beside it."""

MARGIN_CUSHION: Final = 0.5
"""Share of the second difference of the reach, or of a rate's room, that its parabola may be wrong
by between two rows: beside a straight wrist or elbow it is a hyperbola."""

EXCHANGE_ZOOMS: Final = 5
"""How often the place between two rows where a limit is broken most is narrowed, eightfold each
time: 3 mm to 0.1 um, as far as a rate of 250 rad/m has to be known to seven digits."""

RATE_ROOM_EXCESS: Final = 1e-9
"""How far below zero the room of a rate may be [a sine, see `rate_room`]: where joints turn as fast
as they may the sine is a hundredth, so that is 1e-7 of the rate, a tenth of what is verified."""

DEVIATION_SAMPLES: Final = 3
"""Postures between two rows at which the distance from the straight line is measured. It is nearly
a parabola between rows, so its middle is among them and its quarter points tell if it is not."""

NEAR_RATE_ROOM: Final = 1e-3
"""Room of a rate [a sine] below which a row is looked at beside it as well: a tenth of the sine
where joints turn as fast as they may."""

BESIDE_ROW_M: Final = 1e-5
"""How far beside it [m]: no dip that begins in a row ends so near, and what it falls is far above
rounding."""
