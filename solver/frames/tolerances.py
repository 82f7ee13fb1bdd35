"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

SHORTEST_DIRECTION: Final = 1e-9
"""A branch direction shorter than this [any unit] has no direction; rows of a rotation matrix that
are as small, or large by its inverse, are no rotation's either."""

FURTHEST_M: Final = 1e7
"""Coordinates beyond are refused [m]. Northings of maps end there, where doubles still tell points
apart that are 2 nm from each other."""

UNIT_QUATERNION: Final = 1e-3
"""How far the length of a quaternion may be from one, relative: what is left of it written with
three digits. It is brought to length one, which turns nothing."""

ORTHONORMAL: Final = 2e-3
"""How far R'R may be from the identity, in each entry, relative to one: three digits again (2 *
5e-4 * sqrt(3)). The nearest rotation is taken, which differs by less than 1e-3 rad: half a
millimetre at this arm."""

FEW_DIGITS: Final = 1e-6
"""Change of a number, relative to one, when a rotation is made exact, from which that is worth a
warning: numbers of single precision change by less."""

SUSPICIOUS_M: Final = 100.0
"""A frame further away was probably not sent in metres [m]; maps are, so it is only a warning."""

LEAST_PAIRS: Final = 3
"""Fewer leave a rotation open."""

MOST_PAIRS: Final = 1000
"""Pairs of one request; the mean of that many adds nothing that a camera has."""

SAME_PLACE_M: Final = 1e-3
"""Points whose spread about their centre (root mean square) is below are one point [m]."""

COLLINEAR: Final = 0.01
"""Spread across the longest direction, as a share of the spread along it, below which points are on
a line. At half a metre that is 5 mm, what the arm itself may be off: no rotation follows."""

SCALE_LEAST: Final = 1e-3
"""A scale this near to one, relative, is one: 1 mm in a metre."""

SCALE_FALSE_ALARM: Final = 1e-3
"""Share of sets of pairs in which noise alone, if normal, is taken for a scale that is off."""

MIRROR_FACTOR: Final = 5.0
"""Factor by which a reflection must fit better, and how far the points' smallest spread must be
above what the reflection leaves: flat sets are their own mirror images, as far as noise tells."""

EXACT_FIT: Final = 1e-9
"""Residuals below this share of the spread are rounding."""

LARGE_RESIDUAL_M: Final = 0.005
"""A residual above this is no rounding of the arm's [m]: goals rounded to ticks move the tool by up
to 1.2 mm, noise of a single read by up to 3.7 mm."""

MOST_ROTATION_STD_RAD: Final = 0.1
"""A rotation known worse is refused [rad]: 5 cm at half a metre."""

POOR_ROTATION_STD_RAD: Final = 0.01
"""A rotation known worse is warned of [rad]: 5 mm at half a metre."""

CLEARLY_BETTER: Final = 5.0
"""Factor by which the residuals of one explanation are below another's: no accident of noise."""

OUTLIER_PAIRS: Final = 5
"""Pairs from which one may be accused: the others are then enough to contradict it."""

OUTLIER_FACTOR: Final = 3.0
"""Factor by which the others must agree better without it."""

UNIT_NEARNESS: Final = 0.05
"""A scale within this share of a unit's is that unit's."""
