"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

EVEN_ROWS_M: Final = 1e-12
"""Rows whose distances differ by less are evenly spaced [m]: rounding."""

BETWEEN_ROWS_REACH: Final = 0.25
"""How far beyond two rows, as a share of their distance, the vertex of a parabola counts as between
them."""

BETWEEN_ROWS_CUSHION: Final = 0.05
"""Share of a joint's second difference that its parabola may be wrong by between two rows."""

EXCHANGE_ZOOMS: Final = 4
"""How often the place between two rows where a limit is broken most is narrowed, eightfold each
time: 2 mm to 0.5 um."""

DEVIATION_SAMPLES: Final = 3
"""Postures between two rows at which the distance from the straight line is measured. It is nearly
a parabola between rows, so its middle is among them and its quarter points tell if it is not."""
