"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

SAME_AXIS: Final = 1e-9
"""Sine of an angle, or distance [m], below which two axes are parallel, or meet: ten thousand times
the rounding of a chain of transforms, and far below what anybody builds."""

CONVERTED_POSE: Final = 1e-7
"""How far a converted arm's pose may be from the original's [m, and per axis]: a hundred times what
SAME_AXIS lets pass in each joint, a tenth of what the verifier allows."""

CONVERTED_POSTURES: Final = 100
"""Random postures at which the two are compared."""

URDF_DIGITS: Final = 4
"""Digits after the point from which an angle counts as a rounded one: 1.5708 is a right angle."""

URDF_DIGIT_SHARE: Final = 0.51
"""Share of its last digit by which a rounded angle is off at most: half of it, and the rounding of
the comparison."""

URDF_SHORTEST_M: Final = 1e-3
"""Length from which the cylinders' radius is taken at least [m]: an arm whose links have no length
would be out of sight."""
