"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

NEAREST_INSIDE_RAD: Final = 1e-4
"""How far inside its limits every joint of the nearest displacement is put [rad]. At the smallest
displacement the feasible arc is often a point; this opens it to the width that no search misses,
for about 0.01 mm of displacement."""

NEAREST_INSIDE_M: Final = 1e-5
"""The same for the reach [m]."""

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
"""Penalty of a broken constraint, in multiples of the displacement at the start plus 2 cm: above
the multipliers, which are as large as the displacement unless constraints nearly oppose."""

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
"""Largest slope of a joint constraint at a row out of reach, in half arm lengths a metre."""

NEAREST_FLATTEST: Final = 0.1
"""Smallest slope with which an estimate counts, in the same unit: no division by zero."""

NEAREST_RESTORATIONS: Final = 12
"""Steps at most straight back to the constraints at the end; near them each squares the error."""

NEAREST_JUMP_SHARE: Final = 0.01
"""Share of the travel that counts as a wrist jump which the nearest displacement leaves unused: the
feasible arc is then some hundredths of a radian wide, for a few hundredths of a millimetre."""

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
