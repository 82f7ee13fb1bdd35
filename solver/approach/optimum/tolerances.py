"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

EFFORT_CELL_RAD: Final = 0.03
"""Cells in which effort is sampled along an arc [rad]: joints turn nearly evenly in one."""

EFFORT_SWING_RAD: Final = 0.5
"""Turn of a joint within half a cell above which the cell is halved before kinks are looked for."""

EFFORT_SMOOTH_RAD: Final = 0.1
"""Turn of a joint between two samples of an arc above which slopes of the effort are not believed:
it is near a straight wrist."""

SMOOTH_MINIMUM_RAD: Final = 3e-8
"""Width to which a smooth minimum of the effort is closed in on [rad]: beside a straight wrist,
where effort curves by 2e5 a rad2, it is still good to 1e-10."""

FLAT_EFFORT: Final = 1e-12
"""Difference of the efforts of the three lowest angles at which a smooth minimum is found."""
