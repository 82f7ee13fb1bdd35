"""The methods as the text prints them, to show what goes wrong; nothing else uses these.

One misprint hides the next, so each variant mends what comes before the one that it shows:

    as_printed               nothing is mended: step 1 refuses every target
    as_printed_18            with a corrected step 1 and (14), (15) clipped: (18) misses by 2 d_z
    ssas_printed             with (18) and (26) corrected too: P1 as printed, with equality (30)
    ssas_printed_without_30  the same P1 without it: |dJ/ds10| is least where J is greatest

What an answer claims as its index is Table 3's, so that it is its posture that is judged.
"""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from solver.comparison.strawberry.analytic import beta_at, outside_box, slide_span
from solver.comparison.strawberry.angle_choice import Choice, angle_sets
from solver.comparison.strawberry.answer import Answer
from solver.comparison.strawberry.index import energy_index
from solver.comparison.strawberry.mechanism import Mechanism, Point, Posture, Span, posture_at
from solver.comparison.strawberry.semi_analytic import pieces, root_between, slopes_of
from solver.comparison.strawberry.tolerances import PRINTED_SAMPLES
from solver.problem.solution import Reason


def printed_box(mechanism: Mechanism) -> tuple[Span, Span, Span]:
    """Bounds of the targets as (5) to (10) print them [m]; along z the lower is above the upper."""
    m = mechanism
    longest = m.l2_m + m.l3_m * math.cos(m.beta.lower)
    shortest = m.l2_m + m.l3_m * math.cos(m.beta.upper)
    across = m.l1_m - m.d_y_m
    return (
        Span(
            m.s21.lower + m.d_x_m - longest * math.sin(m.theta.upper),
            m.s21.upper + m.d_x_m - shortest * math.sin(m.theta.lower),
        ),
        Span(
            m.s10.lower + across + m.l3_m * math.sin(m.beta.lower),
            m.s10.upper + across + m.l3_m * math.sin(m.beta.upper),
        ),
        Span(
            -m.s32.lower + m.d_z_m - longest * math.cos(m.theta.lower),
            -m.s32.upper + m.d_z_m - shortest * math.cos(m.theta.upper),
        ),
    )


def solve_as_printed(mechanism: Mechanism, target: Point) -> Answer | Reason:
    """Algorithm 1 to the letter, which ends at step 1: (9) and (10) leave no z."""
    for axis, value, span in zip("xyz", target, printed_box(mechanism), strict=True):
        if not span.lower <= value <= span.upper:
            return Reason(
                "out_of_reach",
                f"step 1 as printed: {axis} is not between {span.lower:.4f} and {span.upper:.4f} m",
            )
    return solve_as_printed_18(mechanism, target)


def solve_as_printed_18(mechanism: Mechanism, target: Point) -> Answer | Reason:
    """Algorithm 1 with everything corrected but (18), which has the sign of d_z wrong."""
    if (reason := outside_box(mechanism, target)) is not None:
        return reason
    m = mechanism
    span = slide_span(m, target)
    beta = beta_at(m, target, (span.lower + span.upper) / 2.0)
    reach = m.l2_m + m.l3_m * math.cos(beta)
    choice = angle_sets(m, target).choose(reach)
    if choice is None:
        return Reason("joint_limit", "no theta suits s10 in the middle of its set", joint="theta")
    right = posture_at(m, target, choice.theta(reach), beta)
    posture = right._replace(s32_m=-target[2] - m.d_z_m - reach * math.cos(right.theta_rad))
    return Answer(posture, energy_index(m, posture))


def solve_ssas_printed(mechanism: Mechanism, target: Point) -> Answer | Reason:
    """P1 with equality (30), which is dJ_fric/ds10 = 0 whatever the potential energy.

    With theta = 0 it holds at beta = 45 degrees only, which some targets do not allow.
    """
    return _stationary(mechanism, target, equality=True)


def solve_ssas_printed_without_30(mechanism: Mechanism, target: Point) -> Answer | Reason:
    """P1 without equality (30): the least |dJ/ds10| with J as (21) prints it."""
    return _stationary(mechanism, target, equality=False)


def _stationary(mechanism: Mechanism, target: Point, *, equality: bool) -> Answer | Reason:
    if (reason := outside_box(mechanism, target)) is not None:
        return reason
    found: list[tuple[float, Posture]] = []
    looked = 0
    for span, choice in pieces(mechanism, target):
        slopes = slopes_of(mechanism, choice)
        betas = np.linspace(span.lower, span.upper, PRINTED_SAMPLES).tolist()
        # Where a case begins its slope may be infinite.
        betas = betas if choice.offset_m == 0.0 else betas[1:-1]
        looked += len(betas)
        values = _equality_roots(slopes, betas) if equality else betas
        for beta in values:
            steepness = abs(sum(slopes(beta)) / (mechanism.l3_m * math.cos(beta)))
            found.append((steepness, _posture(mechanism, target, choice, beta)))
    if not found:
        return Reason("solver_failed", "equality (30) holds at no s10 that beta's limits leave")
    posture = min(found)[1]
    return Answer(posture, energy_index(mechanism, posture), looked)


def _equality_roots(
    slopes: Callable[[float], tuple[float, float]], betas: list[float]
) -> list[float]:
    roots = []
    for left, right in pairwise(betas):
        before, after = slopes(left)[0], slopes(right)[0]
        if before < 0.0 <= after:
            roots.append(root_between(lambda beta: slopes(beta)[0], left, right))
        elif after < 0.0 <= before:
            roots.append(root_between(lambda beta: -slopes(beta)[0], left, right))
    return roots


def _posture(mechanism: Mechanism, target: Point, choice: Choice, beta: float) -> Posture:
    reach = mechanism.l2_m + mechanism.l3_m * math.cos(beta)
    return posture_at(mechanism, target, choice.theta(reach), beta)
