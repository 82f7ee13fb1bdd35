"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

TINY_M2: Final = 1e-30
"""A squared distance below which a point lies on the axis and has no direction [m2]."""

RIGHT_ANGLE_RAD: Final = 1e-12
"""How far a link twist may be from a right angle for the closed form [rad]: rounding of radians."""

WEIGHT_POSTURES: Final = 4096
"""Postures over which torques are averaged for the weights: the mean is sure to about 1 %."""

WEIGHT_SEED: Final = 0
"""Seed of those postures, fixed so that the weights are those of the robot and its tool."""

NUMERICAL_POLISHED: Final = 1e-12
"""Error [m and rad] of a polished posture: rounding, six orders below what the verifier allows."""

NUMERICAL_FOLLOWED: Final = 1e-10
"""Error [m and rad] above which a row of a cut-in was not reached from its neighbour."""

NUMERICAL_MOST_PIECES: Final = 64
"""Most pieces into which the way from a row to its neighbour is cut, by fours: 2 mm to 30 um. A
joint that turns too fast for that is beyond JOINT_RATE_RAD_M."""

NUMERICAL_POLISH_STEPS: Final = 12
"""Newton steps allowed to polish a posture; the error is squared in each, so 3 or 4 are usual."""

SWING_SHARE: Final = 0.9
"""Share of a rate between two rows, where they go on as a straight line, from which it is told by
that alone to be too high: a hundredth is what the line may be off by."""

RATE_PIECES: Final = 8
"""Pieces into which two rows of a cut-in between which a joint may be too fast are cut, 0.3 mm each
where rows are 2.7 mm apart: a joint that is as fast as it may is so for some 4 mm."""

RATE_ZOOMS: Final = 3
"""How often the fastest of these is closed in on, fourfold each: to 5 um, within which the rate of
such a joint changes by a millionth."""

RATE_MISSED: Final = 1e-6
"""How far joints at their rates may miss straight ahead, for a unit of travel [m and rad]: rounding
makes 1e-8 of rates ten times JOINT_RATE_RAD_M, and next to a singular posture a tenth is missed."""
