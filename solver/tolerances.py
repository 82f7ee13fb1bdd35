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

TINY_M2: Final = 1e-30
"""A squared distance below which a point lies on the axis and has no direction [m2]."""

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

ARC_END_RAD: Final = 1e-15
"""Width to which the ends of an arc are refined [rad]; the feasible side is kept. At the edge of
reach joints turn with the square root of the angle: 1e-12 would leave 1e-6 of the effort there."""

ARC_CELLS: Final = 72
"""Cells of one turn in which arcs are searched (5 deg). A single joint's margin is smooth in the
angle, with a few extrema a turn; a cell must not hold two of them."""

CELL_SWING_COSINE: Final = 0.7
"""Cosine of the turn of a joint from cell to cell (0.8 rad) from which the cell is halved: beside a
straight wrist joints 4 and 6 turn by half a turn in an arbitrarily short way."""

CLEAR_MARGIN: Final = 0.1
"""Margin (a difference of cosines, or metres) at both ends of a cell above which a joint is not
looked at in each row: it would have to turn back within 5 degrees of approach angle."""

ROUND_TURN_COSINE: Final = -0.6
"""Cosine of half a joint's range below which it can be inside its limits at both ends of a cell
and have passed what it may not in between, without turning by CELL_SWING_COSINE."""

NARROW_JUMP_RAD: Final = 3e-3
"""Width to which cells with a jump at both ends are halved before slopes are believed [rad]."""

STEEPEST_JUMP: Final = 4.0
"""How fast the margin of a jump (a difference of cosines) may rise with the angle [1/rad]; where it
would have to rise faster between the ends of a cell, the whole cell jumps."""

NARROWEST_CELL_RAD: Final = 1e-6
"""Cells are not halved further [rad]: a hundredth of the narrowest arc that may not be missed."""

EXTREME_ANGLE_RAD: Final = 1e-7
"""Width to which an extremum of a margin is bracketed [rad]; the value is then good to 1e-14."""

ANGLE_STEP_RAD: Final = 1e-10
"""Width to which a one-dimensional optimum in the approach angle is bracketed [rad]."""

JOINT_RATE_RAD_M: Final = 250.0
"""Joint travel for tool travel in the cut-in above which it counts as a wrist jump [rad/m]: 14
degrees of joint for each millimetre; at 2 rad/s the tool would creep at 8 mm/s."""

LEAST_REFINED_ROWS: Final = 20
"""Rows from which a cut-in without timing is refined: T's number."""

EXCHANGE_ROUNDS: Final = 8
"""How often a cut-in posture that breaks a limit between two rows is added to the rows and the
target solved again. One or two are usual: the posture moves quadratically little."""

EXCHANGE_DENSITY: Final = 8
"""Postures looked at between two rows of the cut-in when such a posture is searched."""

EVEN_ROWS_M: Final = 1e-12
"""Rows whose distances differ by less are evenly spaced [m]: rounding."""

BETWEEN_ROWS_REACH: Final = 0.25
"""How far beyond two rows, in their distance, the vertex of a parabola counts as between them."""

BETWEEN_ROWS_CUSHION: Final = 0.05
"""Share of a joint's second difference that its parabola may be wrong by between two rows."""

EXCHANGE_ZOOMS: Final = 4
"""How often the place of that posture is narrowed, eightfold each time: 2 mm to 0.5 um."""

BATCH_PART: Final = 4096
"""Targets of a batch that are made ready for the inner loops at a time: about 3 MB."""

EFFORT_CELL_RAD: Final = 0.03
"""Cells in which effort is sampled along an arc [rad]: joints turn nearly evenly in one."""

LEAST_EFFORT_CELLS: Final = 4
"""Cells of the shortest arc."""

EFFORT_SWING_RAD: Final = 0.5
"""Turn of a joint within half a cell above which the cell is halved before kinks are looked for."""

EFFORT_SMOOTH_RAD: Final = 0.1
"""Turn of a joint between two samples of an arc above which slopes of the effort are not believed:
it is near a straight wrist."""

SMOOTH_MINIMUM_RAD: Final = 3e-8
"""Width to which a smooth minimum of the effort is closed in on [rad]: beside a straight wrist,
where effort curves by 2e5 a rad2, it is still good to 1e-10."""

FLAT_EFFORT: Final = 1e-12
"""Difference of the efforts of the three lowest angles at which a smooth minimum is found."""

# --- Certificate --------------------------------------------------------------------------------
CERTIFICATE_GAP: Final = 2e-7
"""A proven bound that is nearer to the least effort found than this, relative, is near enough: half
of the 1e-6 that `certify` promises."""

CERTIFICATE_CELLS: Final = 20_000
"""Cells of approach angles looked at for one target before the bound so far is returned."""

CERTIFICATE_PIECES: Final = 16
"""Cells that one turn of one branch starts with."""

ENCLOSURE_ROUNDING: Final = 2e-15
"""Rounding of the closed form in direction cosines, by which enclosures are widened: some ten
operations on numbers near one, at 1.1e-16 each."""

ANGLE_ROUNDING_RAD: Final = 1e-14
"""Rounding of sums of a few angles of up to two turns, by which enclosures are widened [rad]."""

ENCLOSURE_SINGULAR_WRIST: Final = 1e-9
"""sin(q5) below which nothing is taken for known of q4 and q6: where the closed form sets q4 to
zero (SINGULAR_WRIST), and ten times as far."""

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
"""Overall error of IPOPT, and equations of our sequential method [m, rad]: below the verifier's by
three orders."""

NLP_ITERATIONS: Final = 200
"""IPOPT's iteration limit; warm-started problems take about 15. A budget counts iterations, never
seconds, so that the same request has the same answer."""

NLP_BARRIER: Final = 1e-4
"""IPOPT's first barrier parameter. It starts at an optimum, so far below the default of 0.1."""

NLP_BOUND_PUSH: Final = 1e-5
"""How far IPOPT moves its start inside the bounds, absolute and relative, for the same reason."""

NLP_LIMIT_INSET: Final = 1e-8
"""How far a relaxed programme stays inside the joint limits [rad], more than its own tolerance, so
that the closed form's posture next to its answer is inside them too."""

SQP_ITERATIONS: Final = 100
"""Iteration limit of the sequential method; warm-started problems take about 4."""

SQP_STEP: Final = 1e-7
"""A step below this, in radians and shares of a relaxation, is the last: near the optimum the steps
square, so what is left is rounding."""

SQP_LONGEST_STEP: Final = 0.5
"""Longest step of a variable [rad or share]; the linearised arm says nothing further away."""

SQP_CURVATURE: Final = 1e-3
"""Least curvature of the reduced Hessian, whose negative ones are mirrored: the l1 norm has none of
its own, and a step needs a length."""

SQP_SLACK_CURVATURE: Final = 1e-4
"""Curvature given to the slacks of the l1 norm, whose cost is linear; far below any weight, and
without effect where the step ends at zero."""

SQP_DECREASE: Final = 1e-4
"""Share of the promised decrease of the merit function that a step has to keep (Armijo)."""

SQP_HALVINGS: Final = 20
"""How often a step is halved before the line search gives up."""

SQP_CORRECTIONS: Final = 4
"""Second-order corrections of a step, each a step back onto the equations, before it is halved."""

SQP_PENALTY: Final = 2.0
"""The merit function's price of an infeasibility, in multiples of the largest multiplier; above one
it is exact: no step gains by trading feasibility for cost."""

SQP_ROUNDING: Final = 1e-13
"""A promised decrease of the merit function below this share of it is rounding."""

SQP_RANK: Final = 1e-9
"""Smallest diagonal of the factorised equations, which are of size one, above which they are
independent; below it the arm is at a singular posture."""

SQP_DAMPING: Final = 1e-6
"""Damping of a step that only repairs the equations: it has to be the shortest of several."""

RELAXED_SWINGS: Final = 6
"""Directions in which the tool leans by its whole tolerance where a relaxed programme starts."""

RELAXED_STARTS: Final = 3
"""Starts of a relaxed programme from the cheapest feasible corners of the relaxations."""

RELAXED_NEAREST: Final = 6
"""Starts where no corner is feasible, from the angles that come closest."""

RELAXED_SAMPLES: Final = 72
"""Approach angles, five degrees apart, among which those starts are looked for."""

RELAXED_ROUNDS: Final = 4
"""How often a row of the cut-in that does not hold is added to a relaxed programme."""

QP_TOLERANCE: Final = 1e-10
"""Tolerance of the quadratic programmes, below that of the programme they are part of."""

PIQP_ROOM: Final = 1e-8
"""Least room that PIQP is given at a limit [rad or share]: an interior-point method needs an
interior. A step into that room is below SQP_STEP, and is clipped."""

OSQP_TOLERANCE: Final = 1e-6
"""The same before polishing, for OSQP: a first-order method that stops making progress below;
polishing then takes its active set and solves for it exactly."""

OSQP_STEP: Final = 1.0
"""OSQP's first step size, ten times its default: limits are closer than costs are steep here."""

OSQP_ITERATIONS: Final = 20_000
"""Iteration limit of OSQP; the other two take a few dozen of their own."""

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


# --- Displaced targets --------------------------------------------------------------------------
SINGULAR_SINE: Final = 1e-6
"""Sine of the wrist's, elbow's or waist's singular angle below which rates are those at this sine:
joints turn by 1e6 times the tool's turn there, and no division by zero."""

DISPLACEMENT_ROUNDS: Final = 12
"""Linearisations at most in the search for the nearest point of a limit; four are usual."""

DISPLACEMENT_STEP_RELATIVE: Final = 1e-6
"""Relative change of that point below which it is found."""

SCREENED_DISTANCES: Final = 2.5
"""Limits whose first-order distance is above this many times the smallest exact one are not looked
at more closely."""

STRAIGHT_WRIST_PROBES: Final = 12
"""Directions around a straight wrist in which limits of joints 4 and 6 are looked for: 30 degrees,
a tenth of what these joints turn in all."""

PROBE_HALVINGS: Final = 12
"""Halvings of the way to a broken limit before the nearest point of the limit is looked for."""

# --- Nearest feasible change --------------------------------------------------------------------
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

# --- Uncertain targets --------------------------------------------------------------------------
UNCERTAINTY_DEVIATIONS: Final = 3.0
"""Standard deviations that a target may be away from where it was seen. The nearest limit is all
but flat at that scale: 99.87 % of normally distributed targets are on its feasible side, and 97 %
in the whole ball."""

LARGEST_STD_REACHES: Final = 0.25
"""A standard deviation above this share of the reach is refused: sent in another unit, or no
detection at all."""

ROBUST_ANGLE_RAD: Final = 1e-9
"""Width to which the ends of arcs that bear an uncertainty are bisected [rad]. The margin changes
by less than 1e-8 m within it; the verifier allows POSITION_ERROR_M."""
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

# --- Strawberry mechanism -----------------------------------------------------------------------
LIMIT_EXCESS_M: Final = 1e-9
"""A slide beyond its limit by more is refused [m]: the same reason as LIMIT_EXCESS_RAD."""

INDEX_ROUNDING_J: Final = 1e-7
"""Two indices closer than this are equal [J]: IPOPT ends about 1e-9 m beside its equations, and a
metre of table costs some 25 J; a ten-thousandth of the last digit that the paper prints."""

STATIONARY_CELLS: Final = 12
"""Cells, between two changes of case, in which the index's derivative is looked at for a minimum:
less than 6.1 degrees of beta each, where the index has a single curvature."""

STATIONARY_INSET: Final = 1e-6
"""How far inside a cell, as a share of it, the derivative is taken: where a case begins it may be
infinite, and the ends are compared by their index anyway."""

STATIONARY_RAD: Final = 1e-12
"""How narrow the bracket of such a minimum becomes by bisection [rad]."""

MECHANISM_NLP_TOLERANCE: Final = 1e-10
"""Overall error of IPOPT on the mechanism's programme [J, m]: below INDEX_ROUNDING_J."""

MECHANISM_NLP_BARRIER: Final = 1e-2
"""IPOPT's first barrier parameter there [J]: below a hundredth of an index of some 6 J. Over S's
Table 3 the default of 0.1, and smaller ones, take about a tenth more iterations from the reset."""

PRINTED_SAMPLES: Final = 721
"""Values of beta at which the printed problem P1 is looked at, 0.1 degrees apart."""

SAME_POINT_M: Final = 1e-6
"""Neighbouring points of a branch this near are one point, and have no direction between them [m];
a camera tells nothing apart at a micrometre."""

AS_CHEAP_RELATIVE: Final = 1e-7
"""How much dearer than another method's an effort may be and still count as the same, as a share:
an optimum is found to about 1e-9, and efforts of a few radians are recomputed to 1e-12."""
