"""`ssas`: the least index over s10 along the choice of theta that `as` makes (S 3.2, algorithm 2).

P1 of S looks for a root of dJ/ds10. Here the candidates are compared by J itself: every stationary
point with a minimum, both ends of s10's set, and every s10 at which the choice of theta changes its
case (27, 28). Equality (30) is left out: it fixes beta at 45 degrees wherever theta is 0, whatever
the index. The derivative is taken by beta, with s10 = y - l1 + d_y - l3 sin beta, which has no
singular end.
"""

import math
from collections.abc import Callable, Iterator
from itertools import pairwise

from solver.comparison.strawberry.analytic import beta_at, outside_box, slide_span
from solver.comparison.strawberry.angle_choice import (
    CASE_1,
    STRAIGHT,
    AngleSets,
    Choice,
    angle_sets,
)
from solver.comparison.strawberry.answer import Answer
from solver.comparison.strawberry.index import bent_arm_n, energy_index
from solver.comparison.strawberry.mechanism import Mechanism, Point, Posture, Span, posture_at
from solver.comparison.strawberry.tolerances import (
    STATIONARY_CELLS,
    STATIONARY_INSET,
    STATIONARY_RAD,
)
from solver.problem.solution import Reason


def solve_ssas(mechanism: Mechanism, target: Point) -> Answer | Reason:
    """The posture of least index on the curve that `as`'s choice of theta draws over s10.

    Returns:
        The posture, with the number of candidates compared as `iterations`; `out_of_reach` outside
        the box, `joint_limit` where no s10 has a theta.
    """
    if (reason := outside_box(mechanism, target)) is not None:
        return reason
    m = mechanism
    best: Posture | None = None
    least, compared = math.inf, 0
    for span, choice in pieces(m, target):
        for beta in _candidates(m, choice, span):
            reach = m.l2_m + m.l3_m * math.cos(beta)
            posture = posture_at(m, target, choice.theta(reach), beta)
            index = energy_index(m, posture)
            compared += 1
            if index < least:
                best, least = posture, index
    if best is None:
        return Reason("joint_limit", "no s10 has a theta within the limits", joint="theta")
    return Answer(best, least, compared)


def pieces(mechanism: Mechanism, target: Point) -> Iterator[tuple[Span, Choice]]:
    """The intervals of beta [rad] on which the choice of theta is one case, and that case."""
    m = mechanism
    sets = angle_sets(m, target)
    slides = slide_span(m, target)
    lower, upper = beta_at(m, target, slides.upper), beta_at(m, target, slides.lower)
    for start, end in pairwise(_cuts(m, sets, lower, upper)):
        reach = m.l2_m + m.l3_m * math.cos((start + end) / 2.0)
        if (choice := sets.choose(reach)) is not None:
            yield Span(start, end), choice


def _cuts(mechanism: Mechanism, sets: AngleSets, lower: float, upper: float) -> list[float]:
    l2, l3 = mechanism.l2_m, mechanism.l3_m
    ratios = ((reach - l2) / l3 for reach in sets.case_changes())
    between = (math.acos(ratio) for ratio in ratios if -1.0 < ratio < 1.0)
    return [lower, *sorted(beta for beta in between if lower < beta < upper), upper]


def _candidates(mechanism: Mechanism, choice: Choice, span: Span) -> Iterator[float]:
    """Both ends of a piece and its minima between them [rad]."""
    yield from span
    if choice.case is STRAIGHT:
        # J = -mu W l3 sin beta - ((mu W + (m2 + m3) g) l3 - m3 g l3 / 2) cos beta + constant
        m = mechanism
        stationary = math.atan2(m.friction_n, m.friction_n + m.lifted_n - m.tip_weight_n / 2.0)
        if span.lower < stationary < span.upper:
            yield stationary
        return
    slope = slope_of(mechanism, choice)
    step = (span.upper - span.lower) / STATIONARY_CELLS
    # The ends themselves are candidates already, and a case may begin with an infinite slope.
    inset = step * STATIONARY_INSET
    left = span.lower + inset
    before = slope(left)
    for cell in range(1, STATIONARY_CELLS + 1):
        right = span.lower + cell * step - inset
        after = slope(right)
        if before < 0.0 < after:
            yield root_between(slope, left, right)
        left, before = right, after


def slopes_of(mechanism: Mechanism, choice: Choice) -> Callable[[float], tuple[float, float]]:
    """d/dbeta of friction loss and of potential rise along a case [J/rad].

    Times dbeta/ds10 = -1 / (l3 cos beta) these are S's (25) and (24); (26) prints l2 for l1.
    """
    m = mechanism
    friction, lifted = m.friction_n, m.lifted_n
    bent = bent_arm_n(m) * m.l2_m
    tip = m.tip_weight_n * m.l3_m / 2.0

    def slopes(beta: float) -> tuple[float, float]:
        sin_beta, cos_beta = math.sin(beta), math.cos(beta)
        reach, shrinks = m.l2_m + m.l3_m * cos_beta, -m.l3_m * sin_beta
        theta = choice.theta(reach)
        sine, cosine = math.sin(theta), math.cos(theta)
        if choice.case is STRAIGHT:
            turns = 0.0
        elif choice.case is CASE_1:  # sin theta L = k
            turns = -shrinks * sine / (reach * cosine)
        else:  # cos theta L = c
            turns = shrinks * cosine / (reach * sine)
        slides = shrinks * (sine - cosine) + reach * (cosine + sine) * turns
        lowers = shrinks * cosine - reach * sine * turns
        return (
            friction * (slides - m.l3_m * cos_beta),
            lifted * lowers
            + bent * sine * turns
            + tip * (sin_beta * cosine + cos_beta * sine * turns),
        )

    return slopes


def slope_of(mechanism: Mechanism, choice: Choice) -> Callable[[float], float]:
    """dJ/dbeta along a case, with Table 3's sign [J/rad]."""
    slopes = slopes_of(mechanism, choice)

    def slope(beta: float) -> float:
        lost, rise = slopes(beta)
        return lost - rise

    return slope


def root_between(slope: Callable[[float], float], left: float, right: float) -> float:
    """The root of a function that rises from below zero to above it in a bracket [rad]."""
    while right - left > STATIONARY_RAD:
        middle = (left + right) / 2.0
        if slope(middle) < 0.0:
            left = middle
        else:
            right = middle
    return (left + right) / 2.0
