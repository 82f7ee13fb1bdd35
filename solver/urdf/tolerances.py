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
