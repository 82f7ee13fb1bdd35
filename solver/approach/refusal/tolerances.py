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
"""Step of the displacement below which its minimum is found [m], and besides a share of its length:
NEAREST_CONVERGED_SHARE."""

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

NEAREST_STEPS: Final = 24
"""Quadratic programmes at most from one start; twelve are usual."""

NEAREST_ROUNDS: Final = 7
"""How often a row that breaks a limit is added to the rows watched, or the spread widened."""

NEAREST_STARTS: Final = 32
"""Branches and angles from which the nearest displacement is searched at most, the best estimates
first; most are soon left."""

NEAREST_STEEPEST: Final = 10.0
"""Largest slope of a joint constraint at a row out of reach [half arm lengths / m]: there it is the
stretched arm's, which has no bound."""

NEAREST_RESTORATIONS: Final = 12
"""Steps at most straight back to the constraints at the end; near them each squares the error."""

NEAREST_RATE_ROOM: Final = 1e-3
"""How much room below the highest joint rate the nearest displacement leaves [a sine, see
`rate_room`], so that the feasible arc is no point, for a few hundredths of a millimetre."""

NEAREST_DIFFERENCE: Final = 1e-6
"""Step of the differences that the slope of that room is taken from [m and rad]."""

NEAREST_SPARES_M: Final = (0.0, 1e-4, 3e-4, 1e-3)
"""Freedom to move that a displaced target is given beyond what it needs, in turn until its arcs
verify [m]."""

NEAREST_TRIAL_STEPS: Final = 4
"""Quadratic programmes from one start before it may be left for leading too far."""

NEAREST_HOPELESS: Final = 1.3
"""A start is left when its next step leads to a displacement this many times the best one found."""

DIAGNOSED_ANGLES: Final = 90
"""Approach angles at which the closest failure is looked for before the best is refined."""

NEAREST_QP_CONVERGED_M: Final = 1e-6
"""Change of a multiplier, which is a length here, below which a quadratic programme is solved [m]:
a tenth of what may be missing in the end."""

NEAREST_PENALTY_LEAST_M: Final = 0.02
"""What is added to the displacement at the start before it is made the penalty [m]: a start that
needs no displacement would have none."""

NEAREST_CUTS: Final = 5
"""How often a step that does not lower the merit function is shortened."""

NEAREST_CUT: Final = 4.0
"""Factor by which such a step is shortened each time; after five times a thousandth is left."""

NEAREST_DAMPING: Final = 0.2
"""Least curvature along a step as a share of the approximate Hessian's there (Powell's damping), so
that its update stays positive definite."""

NEAREST_WIDENING: Final = 1.1
"""Factor on what is missing, by which the displacement that has to be borne is widened: limits
bend, and one that just misses would miss again."""

HALF_TURN_DEG: Final = 180.0
"""A joint that turns further than this in a millimetre of cut-in is said to make half a turn [deg]:
it swings round a singular posture, as fast as one likes."""


NEAREST_CONVERGED_SHARE: Final = 1e-3
"""Step of the displacement below which its minimum is found, as a share of its length: a twentieth
of what an offer may be too far."""

NEAREST_MISSING_M: Final = 1e-5
"""What may be missing in all constraints together [m]: a third of how far inside they are put."""

SEED_ANGLES: Final = 24
"""Approach angles of the grid that searches start from, over a whole turn: 15 degrees."""

SEED_WAISTS: Final = 14
"""Angles of joint 1 in that grid, over its limits: 21 degrees for the table-top arm."""

SEED_TILTS: Final = 12
"""Sums of joints 2 and 3 in that grid, over their limits: 28 degrees for the table-top arm."""

SEED_BINS: Final = 12
"""Parts of the turn in each of which the best point of the grid is a start, on each branch."""

SEED_OUTSIDE_M: Final = 0.2
"""What a radian beyond a limit counts in that grid [m]: between the lengths of the tool and of the
arm; of 0.1, 0.2 and 0.3 m the one with which fewest of 2,000 offers are too far."""

SEED_SPREAD: Final = 1.3
"""Starts that need more than so many times another's displacement are left out, and besides"""

SEED_SPREAD_M: Final = 0.08
"""what the tool moves over half a step of the grid [m]."""

NEAREST_ABOVE_MULTIPLIERS: Final = 1.5
"""Penalty with which steps are judged, in multiples of the largest multiplier."""

SEED_STRIDE: Final = 7
"""Steps from one approach angle of that grid to the next one looked at; without a common divisor
with their number."""

NEAREST_SAME: Final = 0.01
"""A start is left when its next step leads to a displacement this near the best one found, as a
share of that: half of what an offer may be too far."""

NEAREST_SHORT_M: Final = 0.02
"""Displacement below which it counts how far inside the reach the wrist centre is put [m]: that is
a tenth of a millimetre where no elbow is too fast."""

NEAREST_RATE_STEPS: Final = 40
"""Quadratic programmes at most where joint rates count, which have corners."""

NEAREST_RATE_CUTS: Final = 8
"""How often a step is shortened there."""

NEAREST_QP_EXACT_M: Final = 1e-10
"""The same for steps straight back to the constraints [m], where limits may leave a sliver."""

NEAREST_QP_EXACT_SWEEPS: Final = 300
"""Sweeps over the constraints for such a step: limits that nearly oppose agree slowly."""

NEAREST_FOUND_SHARE: Final = 1e-5
"""The same share for the best one found, which is followed to its end."""

NEAREST_RESTORED_M: Final = 2e-2
"""What may be missing where steps straight back to the constraints are tried [m]; beyond, they are
left for broken."""

NEAREST_RESTORED: Final = 0.95
"""Share of what was missing that each such step may leave; near the constraints it is squared."""

NEAREST_CALMER: Final = 25.0
"""How many times as far inside the reach as no elbow is too fast a search goes on from where joint
rates were broken: there the elbow's rates are a fifth, and bend little."""

NEAREST_BENT_RAD: Final = 0.05
"""How far from straight the wrist is there [rad]: that much more than joints 4 and 6 need where
the forearm turns by 10 rad for each metre, as it does about a bent elbow."""

NEAREST_UPRIGHT_SINE: Final = 1e-5
"""Sine between position and branch below which "straight out" is found as for every target: ten
times where it no longer comes from the position (PARALLEL_SINE)."""
