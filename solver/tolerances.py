"""Tolerances that two rooms or more share, each with its unit and its reason.

What one room alone uses stands in that room's own `tolerances.py`.
"""

from typing import Final

LIMIT_EXCESS_RAD: Final = 1e-9
"""A joint beyond its limit by more is refused [rad]. Rounding of the closed form is 1e-14; a
programme ends within its own tolerance of the equations, which is why its answers are put back on
the closed form."""

POSITION_ERROR_M: Final = 1e-6
"""Tool centre point off its place [m]: a thousandth of a servo tick's effect on this arm."""

AXIS_ERROR_RAD: Final = 1e-6
"""Tool axes off their direction [rad]: at 0.1 m of tool the same order as POSITION_ERROR_M."""

EFFORT_ERROR_RELATIVE: Final = 1e-9
"""A claimed effort against the recomputed one, relative to max(1, effort)."""

SAME_BRANCH_RAD: Final = 1e-4
"""How far a row may be from the closed form's posture on its branch [rad]. Two branches are further
apart unless the arm is all but singular, where the inverse itself loses digits."""

SAME_POSTURE_RAD: Final = 1e-9
"""Two postures that have to be one: where segments join, or rows repeat another field [rad]."""

REACH_ROUNDING_M: Final = 1e-12
"""A wrist centre beyond reach by less is at the edge [m]: rounding of lengths near 0.5 m."""

SINGULAR_WRIST: Final = 1e-10
"""sin(q5) below which q4 and q6 turn about one axis and q4 is set to zero. Above it the directions
that give q4 still have six digits; below it the axis error made is at most 1e-10 rad."""

JOINT_RATE_RAD_M: Final = 250.0
"""Joint travel for tool travel in the cut-in above which it counts as a wrist jump [rad/m]: 14
degrees of joint for each millimetre; at 2 rad/s the tool would creep at 8 mm/s."""

RATE_EXCESS_SHARE: Final = 1e-7
"""Share by which a joint may be faster than JOINT_RATE_RAD_M: where it is that fast, a posture good
to 1e-12 makes 1e-10 of it, and an exchange ends within 5e-8."""

LEAST_REFINED_ROWS: Final = 20
"""Rows from which a cut-in without timing is refined: T's number."""

EXCHANGE_ROUNDS: Final = 8
"""How often a cut-in posture that breaks a limit between two rows is added to the rows and the
target solved again. One or two are usual: the posture moves quadratically little."""

BATCH_PART: Final = 4096
"""Targets of a batch that are made ready for the inner loops at a time: about 3 MB."""

NUMERICAL_DAMPING: Final = 1e-9
"""Damping of the numerical inverse at the target, relative to a Jacobian of size one; half the
squared error is added on the way there (Sugihara 2011)."""

LEAST_DIVISOR: Final = 1e-300
"""What a divisor that may be zero is raised to [any]: the quotient is as good as infinite then, and
none becomes a NaN."""

NLP_ITERATIONS: Final = 200
"""IPOPT's iteration limit; warm-started problems take about 15. A budget counts iterations, never
seconds, so that the same request has the same answer."""

EXACT_ZERO: Final = 1e-15
"""A cosine or sine of a link twist below this is zero: a right angle's cosine comes as 6e-17 and
would keep dead terms in every expression."""

TRAJECTORY_STEP_S: Final = 0.02
"""Largest time between two rows of a moving segment [s]; the servos' own loop is not faster."""

TRAJECTORY_HALVINGS: Final = 8
"""How often the step is halved to keep the cut-in straight between rows; 0.1 ms is the end."""
