"""`as`: the analytical solution, algorithm 1 (S table 1) with its misprints corrected."""

import math

from solver.comparison.strawberry.angle_choice import angle_sets
from solver.comparison.strawberry.answer import Answer
from solver.comparison.strawberry.index import energy_index
from solver.comparison.strawberry.mechanism import Mechanism, Point, Span, posture_at
from solver.problem.solution import Reason


def workspace_box(mechanism: Mechanism) -> tuple[Span, Span, Span]:
    """Bounds of the targets along x, y and z (S 5 to 10, corrected) [m].

    (6) needs the longest reach, so beta_min. (9) and (10) have the ends of s32 exchanged; moreover
    the lowest tip hangs straight down, and the highest has the angle that is furthest from it,
    which need not be theta_min and theta_max.
    """
    m = mechanism
    longest = m.l2_m + m.l3_m * math.cos(m.beta.lower)
    shortest = m.l2_m + m.l3_m * math.cos(m.beta.upper)
    flattest = min(math.cos(m.theta.lower), math.cos(m.theta.upper))
    across = m.l1_m - m.d_y_m
    return (
        Span(
            m.s21.lower + m.d_x_m - longest * math.sin(m.theta.upper),
            m.s21.upper + m.d_x_m - longest * math.sin(m.theta.lower),
        ),
        Span(
            m.s10.lower + across + m.l3_m * math.sin(m.beta.lower),
            m.s10.upper + across + m.l3_m * math.sin(m.beta.upper),
        ),
        Span(-m.s32.upper + m.d_z_m - longest, -m.s32.lower + m.d_z_m - shortest * flattest),
    )


def outside_box(mechanism: Mechanism, target: Point) -> Reason | None:
    """Step 1: why no posture can be at the target, or None where one may be."""
    for axis, value, span in zip("xyz", target, workspace_box(mechanism), strict=True):
        if not span.lower <= value <= span.upper:
            nearest = span.lower if value < span.lower else span.upper
            return Reason(
                "out_of_reach",
                f"{axis} is outside [{span.lower:.4f}, {span.upper:.4f}] m, where the tip can be",
                margin_m=-abs(value - nearest),
            )
    return None


def slide_span(mechanism: Mechanism, target: Point) -> Span:
    """S_s10: where s10 may be with beta within its limits (S 11 and 12) [m]; empty if reversed."""
    m = mechanism
    across = target[1] - m.l1_m + m.d_y_m
    return Span(
        max(across - m.l3_m * math.sin(m.beta.upper), m.s10.lower),
        min(across - m.l3_m * math.sin(m.beta.lower), m.s10.upper),
    )


def beta_at(mechanism: Mechanism, target: Point, s10_m: float) -> float:
    """Beta that belongs to s10 (S 13) [rad]; rounding beyond its limits is taken off."""
    m = mechanism
    sine = (target[1] - s10_m - m.l1_m + m.d_y_m) / m.l3_m
    return min(max(math.asin(max(-1.0, min(1.0, sine))), m.beta.lower), m.beta.upper)


def solve_as(mechanism: Mechanism, target: Point) -> Answer | Reason:
    """s10 in the middle of its set (remark 1), theta of least absolute value (remark 2).

    Args:
        mechanism: the mechanism.
        target: where the tip shall be, in F0 [m].

    Returns:
        The posture, or why there is none: `out_of_reach` outside the box, `joint_limit` where
        S_theta is empty at that s10. Then another s10 may still do, which `ssas` and `ncos` find.
    """
    if (reason := outside_box(mechanism, target)) is not None:
        return reason
    span = slide_span(mechanism, target)
    beta = beta_at(mechanism, target, (span.lower + span.upper) / 2.0)
    reach = mechanism.l2_m + mechanism.l3_m * math.cos(beta)
    choice = angle_sets(mechanism, target).choose(reach)
    if choice is None:
        return Reason("joint_limit", "no theta suits s10 in the middle of its set", joint="theta")
    posture = posture_at(mechanism, target, choice.theta(reach), beta)
    return Answer(posture, energy_index(mechanism, posture))
