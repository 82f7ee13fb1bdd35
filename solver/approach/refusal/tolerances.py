"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

NEAREST_INSIDE_RAD: Final = 1e-4
"""How far inside its limits every joint of the nearest displacement is put [rad]. At the smallest
displacement the feasible arc is often a point; this opens it to the width that no search misses,
for about 0.01 mm of displacement."""

NEAREST_INSIDE_M: Final = 3e-5
"""How far inside the reach the nearest displacement is put [m], for the same reason, and because at
its very edge the elbow turns faster than it may."""

NEAREST_INSIDE_ARC_RAD: Final = 1e-6
"""How far inside its arc the nearest angle is put [rad], so that digits lost on the way to another
program do not lose it."""

NEAREST_CONVERGED_M: Final = 1e-7
"""Step of the displacement below which its minimum is found [m]."""

NEAREST_ANGLE_SCALE_M: Final = 0.05
"""Tool travel that a radian of approach angle counts as in the first step [m]: half a tool."""

NEAREST_LARGEST_TURN_RAD: Final = 0.3
"""Largest step of the approach angle in one step; beyond, the linear constraints mean nothing."""

NEAREST_PENALTY: Final = 10.0
"""Penalty of a broken constraint, in multiples of the displacement at the start plus
NEAREST_PENALTY_LEAST_M: a factor above the multipliers, which are as large as the displacement
unless constraints nearly oppose."""

NEAREST_QP_SWEEPS: Final = 60
"""Sweeps over the constraints in each quadratic programme; ten are usual."""

NEAREST_STEPS: Final = 40
"""Quadratic programmes at most from one start; twelve are usual."""

NEAREST_ROUNDS: Final = 7
"""How often a row that breaks a limit is added to the rows watched, or the spread widened."""

NEAREST_ANGLES: Final = 72
"""Approach angles at which the displacement needed is estimated."""

NEAREST_STARTS: Final = 8
"""Branches and angles from which the nearest displacement is searched, the best estimates first."""

NEAREST_START_INSIDE_M: Final = 1e-3
"""How deep inside the reach a search starts [m]: at the edge the elbow's rate has no bound."""

NEAREST_STEEPEST: Final = 10.0
"""Largest slope of a joint constraint at a row out of reach [half arm lengths / m]: there it is the
stretched arm's, which has no bound."""

NEAREST_FLATTEST: Final = 0.1
"""Smallest slope with which an estimate counts [half arm lengths / m]: no division by zero."""

NEAREST_RESTORATIONS: Final = 12
"""Steps at most straight back to the constraints at the end; near them each squares the error."""

NEAREST_RATE_ROOM: Final = 1e-3
"""How much room below the highest joint rate the nearest displacement leaves [a sine, see
`rate_room`], so that the feasible arc is no point, for a few hundredths of a millimetre."""

NEAREST_TURNS_RAD: Final = (-0.6, -0.3, -0.15, 0.15, 0.3, 0.6)
"""Angles from the best one found at which it is searched once more [rad]."""

NEAREST_DIFFERENCE: Final = 1e-6
"""Step of the differences that the slope of that room is taken from [m and rad]."""

NEAREST_SPARES_M: Final = (0.0, 1e-4, 3e-4, 1e-3)
"""Freedom to move that a displaced target is given beyond what it needs, in turn until its arcs
verify [m]."""

NEAREST_TRIAL_STEPS: Final = 4
"""Quadratic programmes from one start before it may be left for leading too far."""

NEAREST_HOPELESS: Final = 1.3
"""A start is left when its next step leads to a displacement this many times the best one found."""

DIAGNOSED_ANGLES: Final = 180
"""Approach angles at which the closest failure is looked for before the best is refined."""

NEAREST_PRUNED: Final = 2.0
"""Starts whose estimate is above this many times the best displacement found are left out."""

NEAREST_QP_CONVERGED_M: Final = 1e-10
"""Change of a multiplier, which is a length here, below which a quadratic programme is solved [m]:
a thousandth of the step that ends the search."""

NEAREST_PENALTY_LEAST_M: Final = 0.02
"""What is added to the displacement at the start before it is made the penalty [m]: a start that
needs no displacement would have none."""

NEAREST_CUTS: Final = 10
"""How often a step that does not lower the merit function is shortened."""

NEAREST_CUT: Final = 2.5
"""Factor by which such a step is shortened each time; after ten times a ten-thousandth is left."""

NEAREST_DAMPING: Final = 0.2
"""Least curvature along a step as a share of the approximate Hessian's there (Powell's damping), so
that its update stays positive definite."""

NEAREST_REACH_STEPS: Final = 3
"""Linearised steps into the reach where a search starts; what they miss is the search's own."""

NEAREST_FLAT_REACH: Final = 1e-12
"""Least squared slope [m2/m2] of the reach that such a step is divided by: no division by zero."""

NEAREST_WIDENING: Final = 1.1
"""Factor on what is missing, by which the displacement that has to be borne is widened: limits
bend, and one that just misses would miss again."""

HALF_TURN_DEG: Final = 180.0
"""A joint that turns further than this in a millimetre of cut-in is said to make half a turn [deg]:
it swings round a singular posture, as fast as one likes."""
