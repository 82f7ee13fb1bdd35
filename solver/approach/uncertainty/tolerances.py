"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

SINGULAR_SINE: Final = 1e-6
"""Sine of the wrist's, elbow's or waist's singular angle below which rates are those at this sine:
joints turn by 1e6 times the tool's turn there, and no division by zero."""

DISPLACEMENT_ROUNDS: Final = 12
"""Linearisations at most in the search for the nearest point of a limit; four are usual."""

DISPLACEMENT_STEP_RELATIVE: Final = 1e-6
"""Change of that point, relative to its distance, below which it is found."""

SCREENED_DISTANCES: Final = 2.5
"""Limits whose first-order distance is above this many times the smallest exact one are not looked
at more closely."""

STRAIGHT_WRIST_PROBES: Final = 12
"""Directions around a straight wrist in which limits of joints 4 and 6 are looked for: 30 degrees,
a tenth of what these joints turn in all."""

PROBE_HALVINGS: Final = 12
"""Halvings of the way to a broken limit before the nearest point of the limit is looked for."""

ROBUST_ANGLE_RAD: Final = 1e-9
"""Width to which the ends of arcs that bear an uncertainty are bisected [rad]. The margin changes
by less than 1e-8 m within it; the verifier allows POSITION_ERROR_M."""

DISPLACEMENT_STEP_M: Final = 1e-9
"""Step of that point that is not shortened any further where it leads out of reach [m]."""

STRAIGHT_WRIST_SINE: Final = 10 * SINGULAR_SINE
"""Sine of joint 5 below which the search for the nearest straight wrist has come to it; nearer,
rates are no longer those of the posture."""

ROBUST_CELL_RAD: Final = 0.025
"""Spacing of the angles at which it is looked what an arc bears [rad]: a margin of a millimetre
comes and goes over some 0.01 rad, a twentieth of a tool of 0.2 m."""

BORNE_EXCESS_M: Final = 1e-8
"""Excess over what has to be borne at which the end of a robust part is found [m]: a hundredth of
what the verifier lets pass."""

ROOT_SHARE: Final = 0.01
"""Share of an interval that each step of the search for such an end takes at least."""

ROOT_STEPS: Final = 60
"""Steps of that search at most; bisection alone would take thirty. Six are usual."""

EXTREME_STEPS: Final = 14
"""Steps of a search for a narrow extreme of the margin: 0.05 rad to 1e-4 rad, where the margin
changes by a hundredth of a millimetre."""

MARGIN_HALVINGS: Final = 3
"""How often `position_margin_m` is halved for a target that cannot have it: an eighth of a
millimetre is what a detector's pixel is worth."""

LEVEL_ROUNDING_M: Final = 1e-7
"""What a displacement margin may be short of a level that it is said to bear [m]: the search for
the nearest point of a limit ends within 1e-6 of its distance."""

PROBE_ENDS_RAD: Final = 1e-4
"""How far a joint may be from its limit where a search that began beside a straight wrist says that
it meets it [rad]: a hundredth of what it turns in a millimetre there."""
