"""Every tolerance of this room, with its unit and its reason."""

import math
from typing import Final

RUNG_STRIKE_M: Final = 0.02
"""The shortest strike zone on the ladder [m], each of the others twice the one before. A blade or a
pair of forks strikes along a few centimetres; rungs closer together cost time and gain nothing."""

RUNG_TILT_RAD: Final = math.radians(10)
"""The smallest tilt tolerance on the ladder [rad], each of the others twice the one before."""

LOOKED_AT_STRIKE_M: Final = 0.002
"""Step of the strikes that are looked at with the closed form where nothing leans [m]."""

LOOKED_AT_TILT_RAD: Final = math.radians(5)
"""Step of the tilts that are looked at with the closed form [rad], half the first rung."""

BOTH_STRIKE_M: Final = 0.005
"""The first of the strikes looked at where the tool leans [m], each twice the one before."""

BOTH_TILT_RAD: Final = math.radians(2.5)
"""The first of the tilts looked at beside a strike [rad], each twice the one before."""

SWING_DIRECTIONS: Final = 8
"""Directions in which the tool leans where a tilt is looked at, 45 degrees apart."""

POINTS_KEPT: Final = 4
"""Approaches that a zone hands on, each on a tool side and branch of its own: one that does not
verify makes way for the next."""

RESTORED_ANGLES: Final = 48
"""Approach angles, 7.5 degrees apart, among which those are looked for that come closest."""

RESTORED_STARTS: Final = 12
"""How many of them are brought inside at most."""

RESTORED_FAR_RAD: Final = 1.5
"""What is further outside than this [rad] is not brought inside by a zone of any size."""

RESTORED_ROUNDS: Final = 20
"""Steps of bringing inside at most; five are usual."""

RESTORED_INSIDE_RAD: Final = 1e-4
"""How far inside limits and reach a step aims [rad, upper arms]: the linearised arm misses."""

RESTORED_LONGEST: Final = 0.4
"""Longest step [rad, or share of the zone]."""

RESTORED_STEP: Final = 1e-6
"""Step of the differences [rad, share], and of a search that stands still: far above rounding, far
below what is asked."""

RESTORED_DAMPING: Final = 1e-4
"""Damping of a step's normal equations, relative to gradients near one: of several steps the
shortest, and none where nothing helps."""

SIMPLEX_SIZE: Final = 0.3
"""First edge of the simplex, a share of the zone; a quarter of it at each new beginning."""

FIRST_LOOKS: Final = 80
"""Points that a descent looks at before the programme: enough to find the valley."""

MORE_LOOKS: Final = 240
"""Points that it looks at where the programme is of no help."""

AGREED_EFFORT: Final = 1e-6
"""Effort of the closed form above the programme's, relative, from which the programme has left out
something that the whole cut-in needs."""

SIMPLEX_SHARE: Final = 1e-4
"""Size of the simplex below which it is begun anew, a share of the zone."""

SIMPLEX_GAIN: Final = 1e-5
"""Gain of a new beginning, relative to the effort, below which the descent ends."""

TILT_ROUNDING_RAD: Final = 1e-12
"""What the length of a swing may be off by [rad]: rounding."""
