"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

EFFORT_CELL_RAD: Final = 0.03
"""Cells in which effort is sampled along an arc [rad]: joints turn nearly evenly in one."""

EFFORT_SWING_RAD: Final = 0.5
"""Turn of a joint within half a cell [rad] above which the cell is halved before kinks are looked
for: a joint that swings may pass its reference more than once."""

EFFORT_SMOOTH_RAD: Final = 0.1
"""Turn of a joint between two samples of an arc [rad] above which slopes of the effort are not
believed: it is near a straight wrist."""

SMOOTH_MINIMUM_RAD: Final = 3e-8
"""Width to which a smooth minimum of the effort is closed in on [rad]: beside a straight wrist,
where effort curves by 2e5 a rad2, it is still good to 1e-10."""

FLAT_EFFORT: Final = 1e-12
"""Difference of the efforts of the three lowest angles [rad or rad2] at which a smooth minimum is
found: a thousand times the rounding of an effort."""

SLOPE_SHARE: Final = 1e-5
"""Share of an interval over which it is looked whether effort falls at its ends."""

KINK_TRAVEL_RAD: Final = 1e-13
"""Travel from its reference below which a joint is at it [rad]: ten times the closed form's
rounding."""

KINK_ANGLE_RAD: Final = 1e-12
"""Width of the bracket of such an angle below which it is found [rad]: a hundredth of
ANGLE_STEP_RAD."""

KINK_STEPS: Final = 60
"""Steps of the Illinois method at most; bisection alone would take thirty-five."""

EFFORT_STACK: Final = 64
"""Intervals of a cell that wait to be looked at, at most: each halving adds one."""
