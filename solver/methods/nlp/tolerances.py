"""Every tolerance of this room, with its unit and its reason."""

from typing import Final

NLP_TOLERANCE: Final = 1e-9
"""Overall error of IPOPT, and equations of our sequential method [m, rad]: below the verifier's by
three orders."""

NLP_BARRIER: Final = 1e-4
"""IPOPT's first barrier parameter [of the cost]. It starts at an optimum, so far below the default
of 0.1."""

NLP_BOUND_PUSH: Final = 1e-5
"""How far IPOPT moves its start inside the bounds, absolute [rad or m] and relative: a warm start
near limits is not to be moved away from its optimum."""

NLP_LIMIT_INSET: Final = 1e-8
"""How far a relaxed programme stays inside the joint limits [rad], more than its own tolerance, so
that the closed form's posture next to its answer is inside them too."""

SQP_ITERATIONS: Final = 100
"""Iteration limit of the sequential method; warm-started problems take about 4."""

SQP_STEP: Final = 1e-7
"""A step below this [rad, and share of a relaxation] is the last: near the optimum the steps
square, so what is left is rounding."""

SQP_LONGEST_STEP: Final = 0.5
"""Longest step of a variable [rad or share]; the linearised arm says nothing further away."""

SQP_CURVATURE: Final = 1e-3
"""Least curvature of the reduced Hessian [cost / rad2], whose negative ones are mirrored: the l1
norm has none of its own, and a step needs a length."""

SQP_SLACK_CURVATURE: Final = 1e-4
"""Curvature given to the slacks of the l1 norm [cost / rad2], whose cost is linear; far below any
weight, and without effect where the step ends at zero."""

SQP_DECREASE: Final = 1e-4
"""Share of the promised decrease of the merit function that a step has to keep (Armijo)."""

SQP_HALVINGS: Final = 20
"""How often a step is halved before the line search gives up."""

SQP_CORRECTIONS: Final = 4
"""Second-order corrections of a step, each a step back onto the equations, before it is halved."""

SQP_PENALTY: Final = 2.0
"""The merit function's price of an infeasibility, as a factor on the largest multiplier; above one
it is exact: no step gains by trading feasibility for cost."""

SQP_ROUNDING: Final = 1e-13
"""A promised decrease of the merit function below this share of it is rounding."""

SQP_RANK: Final = 1e-9
"""Smallest diagonal of the factorised equations, relative to their size of one, above which they
are independent; below it the arm is at a singular posture."""

SQP_DAMPING: Final = 1e-6
"""Damping, relative to the equations' size of one, of a step that only repairs them: it has to be
the shortest of several."""

WHOLE_CUT_IN_ROUNDS: Final = 6
"""How often a row of the cut-in that does not hold is added to a programme, or its limits are
drawn in because a joint is too fast there."""

QP_TOLERANCE: Final = 1e-10
"""Tolerance of the quadratic programmes [as scaled, near one], below that of the programme they are
part of."""

PIQP_ROOM: Final = 1e-8
"""Least room that PIQP is given at a limit [rad or share]: an interior-point method needs an
interior. A step into that room is below SQP_STEP, and is clipped."""

OSQP_TOLERANCE: Final = 1e-6
"""Tolerance of the quadratic programmes before polishing, relative, for OSQP: a first-order method
that stops making progress below; polishing then takes its active set and solves for it exactly."""

OSQP_STEP: Final = 1.0
"""OSQP's first step size, relative; ten times its default: limits are closer than costs are steep
here."""

OSQP_ITERATIONS: Final = 20_000
"""Iteration limit of OSQP; the other two take a few dozen of their own."""

RATE_BOUND_SPARE: Final = 0.03
"""Share beyond what is needed by which a bound keeps elbow or wrist from a singular posture: what
is needed changes a little with the posture, by less than this from one solution to the next."""
