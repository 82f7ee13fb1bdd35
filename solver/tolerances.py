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

# --- Arms without a closed form, arms on a rail, weights -----------------------------------------
RAIL_POSITIONS: Final = 25
"""Positions of a slide tried with the closed form: 5 cm apart on 1.2 m. Not an optimum in the
slide; `ncos` starts from the best of them."""

WEIGHT_POSTURES: Final = 4096
"""Postures over which torques are averaged for the weights: the mean is sure to about 1 %."""

WEIGHT_SEED: Final = 0
"""Seed of those postures, fixed so that the weights are those of the robot and its tool."""

NUMERICAL_STARTS: Final = 64
"""Start postures of the numerical inverse for each tool side. Of 200 reachable targets of a UR5, 8
starts solve 199, 32 all; from 32 to 64 the mean effort falls by 0.9 %, from there to 256 by 1.8 %,
in four times the time."""

NUMERICAL_REACH_STEPS: Final = 40
"""Damped steps towards the target from each start; from half the joint range 15 are usual."""

NUMERICAL_PULL_STEPS: Final = 60
"""Steps that lean towards the reference posture while the tool stays at the target."""

NUMERICAL_PULL_SHARE: Final = 0.3
"""Share of the way to the reference that such a step leans; smaller ones only take longer."""

NUMERICAL_MOST_STEP: Final = 0.5
"""Largest joint step [rad or m]: the Jacobian says nothing about what is further away."""

NUMERICAL_DAMPING: Final = 1e-9
"""Damping left at the target; half the squared error is added on the way there (Sugihara 2011)."""

NUMERICAL_REACHED: Final = 1e-3
"""Error [m and rad] below which a start has come to the target and is polished."""

NUMERICAL_POLISHED: Final = 1e-12
"""Error [m and rad] of a polished posture: rounding, six orders below what the verifier allows."""

NUMERICAL_FOLLOWED: Final = 1e-10
"""Error [m and rad] above which a row of a cut-in was not reached from its neighbour."""

NUMERICAL_MOST_PIECES: Final = 64
"""Most pieces into which the way from that neighbour is cut, by fours: 2 mm to 30 um. A joint that
turns too fast for that is beyond JOINT_RATE_RAD_M."""

NUMERICAL_POLISH_STEPS: Final = 12
"""Newton steps allowed for it; the error is squared in each, so 3 or 4 are usual."""

# --- Axes of other tools' models ----------------------------------------------------------------
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
