"""Every tolerance, with its unit and its reason. No other file holds a bare threshold."""

from typing import Final

# --- Accepted by the verifier -------------------------------------------------------------------
LIMIT_EXCESS_RAD: Final = 1e-9
"""A joint beyond its limit by more is refused [rad]. Rounding of the closed form is 1e-14; an
interior-point solver relaxes bounds by 1e-8, which is why its answers are polished."""

POSITION_ERROR_M: Final = 1e-6
"""Tool centre point off its place [m]: a thousandth of a servo tick's effect on this arm."""

AXIS_ERROR_RAD: Final = 1e-6
"""Tool axes off their direction [rad]: at 0.1 m of tool the same order as POSITION_ERROR_M."""

EFFORT_ERROR_RELATIVE: Final = 1e-9
"""A claimed effort against the recomputed one, relative to max(1, effort)."""

SAME_BRANCH_RAD: Final = 1e-4
"""A row and the closed form's posture on its branch. Two branches are further apart unless the arm
is all but singular, where the inverse itself loses digits."""

RATE_EXCESS_RELATIVE: Final = 1e-6
"""Velocities and accelerations above their limits, relative: divided differences of times that are
rounded at 1e-13 s over steps of 1e-2 s lose nine digits in the second difference."""

SAME_POSTURE_RAD: Final = 1e-9
"""Two postures that have to be one: where segments join, or rows repeat another field [rad]."""

# --- Inverse kinematics -------------------------------------------------------------------------
REACH_ROUNDING_M: Final = 1e-12
"""A wrist centre beyond reach by less is at the edge [m]: rounding of lengths near 0.5 m."""

SINGULAR_WRIST: Final = 1e-10
"""sin(q5) below which q4 and q6 turn about one axis and q4 is set to zero. Above it the directions
that give q4 still have six digits; below it the axis error made is at most 1e-10 rad."""

RIGHT_ANGLE_RAD: Final = 1e-12
"""How far a link twist may be from a right angle for the closed form [rad]: rounding of radians."""

# --- Approach frame and request -----------------------------------------------------------------
PARALLEL_SINE: Final = 1e-6
"""|b x p| / |p| below which "straight out from the base" defines no zero of the angle."""

SHORTEST_DIRECTION: Final = 1e-9
"""A branch direction shorter than this has no direction; directions may have any unit."""

UNIT_MISTAKE_REACHES: Final = 20.0
"""A target further away than this many times the reach was not sent in metres."""

# --- Feasible arcs and search -------------------------------------------------------------------
ARC_SAMPLES: Final = 720
"""Approach angles at which the feasibility margin is sampled before arcs are refined (0.5 deg)."""

NEAR_FEASIBLE_RAD: Final = 0.3
"""A sampled maximum of the margin below -this is not looked at more closely: from there the margin
would have to rise by 0.3 rad within 0.5 deg of approach angle."""

ARC_END_RAD: Final = 1e-12
"""Width to which the ends of an arc are bisected [rad]; the feasible side is kept."""

ANGLE_STEP_RAD: Final = 1e-10
"""Width to which a one-dimensional optimum in the approach angle is bracketed [rad]."""

JOINT_RATE_RAD_M: Final = 250.0
"""Joint travel for tool travel in the cut-in above which it counts as a wrist jump [rad/m]: 14
degrees of joint for each millimetre; at 2 rad/s the tool would creep at 8 mm/s."""

EXCHANGE_ROUNDS: Final = 8
"""How often a cut-in posture that breaks a limit between two rows is added to the rows and the
target solved again. One or two are usual: the posture moves quadratically little."""

EXCHANGE_DENSITY: Final = 8
"""Postures looked at between two rows of the cut-in when such a posture is searched."""

EXCHANGE_ZOOMS: Final = 4
"""How often the place of that posture is narrowed, eightfold each time: 2 mm to 0.5 um."""

ARC_PIECES: Final = 8
"""Pieces at least in which the effort of an arc is sampled; long arcs have one for 0.5 degrees."""

# --- Nonlinear programme ------------------------------------------------------------------------
NLP_TOLERANCE: Final = 1e-9
"""IPOPT's overall error: below the verifier's by three orders in metres and radians."""

NLP_ITERATIONS: Final = 200
"""IPOPT's iteration limit; warm-started problems take about 15. A budget counts iterations, never
seconds, so that the same request has the same answer."""

NLP_BARRIER: Final = 1e-4
"""IPOPT's first barrier parameter. It starts at an optimum, so far below the default of 0.1."""

NLP_BOUND_PUSH: Final = 1e-5
"""How far IPOPT moves its start inside the bounds, absolute and relative, for the same reason."""

EXACT_ZERO: Final = 1e-15
"""A cosine or sine of a link twist below this is zero: a right angle's cosine comes as 6e-17 and
would keep dead terms in every expression."""

# --- Trajectory ---------------------------------------------------------------------------------
TRAJECTORY_STEP_S: Final = 0.02
"""Largest time between two rows of a moving segment [s]; the servos' own loop is not faster."""

TRAJECTORY_HALVINGS: Final = 8
"""How often the step is halved to keep the cut-in straight between rows; 0.1 ms is the end."""

STILL_RAD: Final = 1e-9
"""Two postures that differ by less are one step apart at any speed [rad]; the time that the speed
limits allow for less and less travel would end in an overflow."""

DEVIATION_SAMPLES: Final = 3
"""Postures between two rows at which the distance from the straight line is measured. It is nearly
a parabola between rows, so its middle is among them and its quarter points tell if it is not."""

FLAT_SLOPE_RAD_M: Final = 1e-6
"""A joint that turns less along the cut-in does not set its pace [rad/m]; no division by zero."""

# --- Sequences ----------------------------------------------------------------------------------
CHAIN_STENCIL_RAD: Final = 1e-4
"""Distance of the angles from which a posture's parabola is drawn [rad]: its slope is then good to
1e-8 and its curvature to 1e-7, from third differences and from rounding alike."""

CHAIN_REACH_RAD: Final = 0.03
"""How far an angle of a chain may move in the first round of polishing [rad]: what lies between two
nodes of the ladder graph, and more."""

CHAIN_STILL_RAD: Final = 1e-8
"""Reach of a round of polishing below which nothing is gained any more [rad]."""

CHAIN_ROUNDS: Final = 20
"""Most rounds of polishing."""

CHAIN_GAIN_RELATIVE: Final = 1e-11
"""Polishing ends where a round changes the effort by less, relative."""

CHAIN_MU_LEAST: Final = 1e-11
"""Width within which the l1 norm is rounded off at the end [rad]."""

CHAIN_MU_FACTOR: Final = 0.3
"""From one width to the next."""

CHAIN_NEWTON_STEPS: Final = 6
"""Newton steps for one width at most."""

ANNEAL_HOT: Final = 0.3
"""Temperature at the start of the search for an order, in efforts of a target on average."""

ANNEAL_COLD: Final = 0.005
"""Temperature at its end."""

ANNEAL_HOPELESS: Final = 0.5
"""A move that is dearer by so much before approaches are chosen anew is not looked at further, in
efforts of a target on average."""

ANNEAL_WINDOW: Final = 3
"""Places on each side of a change whose approaches are chosen anew."""

ANNEAL_LONGEST_RUN: Final = 3
"""Most targets that are moved elsewhere together."""

ANNEAL_LONGEST_TURN: Final = 50
"""Most targets that are turned about together."""

ANNEAL_STEP_RAD: Final = 0.262
"""Distance of the approach angles that an order is searched with [rad]; finer ones cost more and
end, for the same time, with dearer orders."""

ANNEAL_NEIGHBOURS: Final = 12
"""Targets cheap to reach a target from, behind one of which a run is moved that begins with it."""

ANNEAL_TRIALS: Final = 10_000
"""Moves tried for each target when an order is searched, about 1 us each."""

EXACT_TARGETS: Final = 8
"""Up to so many targets the order is exact."""

EXACT_STEP_RAD: Final = 0.0525
"""Distance of the approach angles when it is [rad]."""

EXACT_ORDERS_KEPT: Final = 24
"""Orders, cheapest on those angles, whose approaches are refined before one is taken."""

LADDER_STEP_RAD: Final = 0.0525
"""Distance of the angles at which the ladder graph of an order begins [rad], 120 on a turn."""

LADDER_KEPT: Final = 16
"""Nodes a target that are halved in the next round."""

LADDER_ROUNDS: Final = 3
"""Halvings; the angles are then 6.6 mrad apart, and polishing has no further to go than that."""
