import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from solver.comparison.strawberry.analytic import outside_box, solve_as
from solver.comparison.strawberry.angle_choice import CASE_1, CASE_2, STRAIGHT, angle_sets
from solver.comparison.strawberry.index import energy_index, friction_loss, potential_rise
from solver.comparison.strawberry.mechanism import Point, Posture, forward_kinematics, posture_at
from solver.comparison.strawberry.semi_analytic import pieces, slope_of, slopes_of, solve_ssas
from solver.comparison.strawberry.tolerances import INDEX_ROUNDING_J
from solver.comparison.strawberry.verification import verify_answer
from solver.problem.solution import Reason
from solver.tolerances import LIMIT_EXCESS_RAD
from tests.solver.comparison.strawberry.places import MECHANISM, TARGETS, answered, near, reachable

BETAS = np.linspace(*MECHANISM.beta, 4001).tolist()
STEP_RAD = 1e-6


def least_on_a_grid(target: Point) -> float:
    """The least index over beta on a grid, wherever `as`'s choice of theta suits its s10."""
    sets = angle_sets(MECHANISM, target)
    least = math.inf
    for beta in BETAS:
        reach = MECHANISM.l2_m + MECHANISM.l3_m * math.cos(beta)
        choice = sets.choose(reach)
        if choice is None:
            continue
        posture = posture_at(MECHANISM, target, choice.theta(reach), beta)
        if MECHANISM.s10.lower <= posture.s10_m <= MECHANISM.s10.upper:
            least = min(least, energy_index(MECHANISM, posture))
    return least


@pytest.mark.parametrize("target", TARGETS)
def test_no_s10_of_a_grid_is_better_at_the_targets_of_table_3(target: Point) -> None:
    answer = answered(solve_ssas(MECHANISM, target))
    assert verify_answer(MECHANISM, target, answer).verification.accepted
    grid = least_on_a_grid(target)
    assert answer.index_j <= grid + INDEX_ROUNDING_J
    assert answer.index_j == pytest.approx(grid, abs=1e-6)


@settings(max_examples=60)
@given(near | reachable)
def test_no_s10_of_a_grid_is_better_anywhere(target: Point) -> None:
    grid = least_on_a_grid(target)
    answer = solve_ssas(MECHANISM, target)
    if isinstance(answer, Reason):
        assert outside_box(MECHANISM, target) or not math.isfinite(grid)
        return
    found = verify_answer(MECHANISM, target, answer)
    assert found.verification.accepted, found.verification.failures
    assert answer.index_j <= grid + INDEX_ROUNDING_J


@given(near | reachable)
def test_it_is_never_dearer_than_as(target: Point) -> None:
    closed = solve_as(MECHANISM, target)
    assume(not isinstance(closed, Reason))
    assert answered(solve_ssas(MECHANISM, target)).index_j <= (
        answered(closed).index_j + INDEX_ROUNDING_J
    )


@pytest.mark.parametrize("beta", [0.3, 0.6, 0.9])
@pytest.mark.parametrize("theta", MECHANISM.theta)
@pytest.mark.parametrize(
    ("s21", "s32"),
    [(MECHANISM.s21.lower, 0.2), (MECHANISM.s21.upper, 0.2), (0.5, MECHANISM.s32.lower)],
)
def test_where_thetas_own_limit_ends_a_case(
    beta: float, theta: float, s21: float, s32: float
) -> None:
    """Targets at which theta would pass its limit at this beta, in the middle of s10's set.

    Not with both slides at their ends: there the set is one point, which rounding may miss.
    """
    target = forward_kinematics(MECHANISM, Posture(0.3, s21, s32, theta, beta))
    answer = answered(solve_ssas(MECHANISM, target))
    found = verify_answer(MECHANISM, target, answer)
    assert found.verification.accepted, found.verification.failures
    assert answer.index_j <= least_on_a_grid(target) + INDEX_ROUNDING_J
    for span, choice in pieces(MECHANISM, target):
        for end in span:
            reach = MECHANISM.l2_m + MECHANISM.l3_m * math.cos(end)
            lower, upper = MECHANISM.theta
            assert lower - LIMIT_EXCESS_RAD <= choice.theta(reach) <= upper + LIMIT_EXCESS_RAD


def test_targets_near_the_limits_meet_every_case() -> None:
    """So that the tests above are not about theta = 0 alone; the ends of both slides occur."""
    high = -MECHANISM.s32.lower + MECHANISM.d_z_m - 0.11
    seen = set()
    for x in np.linspace(0.0, 1.0, 41):
        for z in (-0.33, high):
            for _, choice in pieces(MECHANISM, (float(x), 0.35, z)):
                seen.add((choice.case, math.copysign(1.0, choice.offset_m), choice.sign))
    assert {case for case, _, _ in seen} == {STRAIGHT, CASE_1, CASE_2}
    assert {(CASE_1, 1.0, 1.0), (CASE_1, -1.0, 1.0)} <= seen
    assert {sign for case, _, sign in seen if case is CASE_2} == {1.0, -1.0}


@given(near | reachable, st.floats(0.05, 0.95))
def test_slopes_are_those_of_the_energies(target: Point, share: float) -> None:
    """Central differences, in the middle of each case's interval."""
    assume(not outside_box(MECHANISM, target))
    for span, choice in pieces(MECHANISM, target):
        if span.upper - span.lower < 1e-2:
            continue
        beta = span.lower + share * (span.upper - span.lower)

        def energies(at: float, choice=choice) -> np.ndarray:  # type: ignore[no-untyped-def]
            reach = MECHANISM.l2_m + MECHANISM.l3_m * math.cos(at)
            posture = posture_at(MECHANISM, target, choice.theta(reach), at)
            return np.array((friction_loss(MECHANISM, posture), potential_rise(MECHANISM, posture)))

        rough = (energies(beta + STEP_RAD) - energies(beta - STEP_RAD)) / (2 * STEP_RAD)
        lost, rise = slopes_of(MECHANISM, choice)(beta)
        assert (lost, rise) == pytest.approx(tuple(rough), rel=1e-4, abs=1e-5)
        assert slope_of(MECHANISM, choice)(beta) == lost - rise


def test_potential_slope_is_equation_24() -> None:
    """(24) as printed, which is how (21)'s last term is known to be (m3 g l3 / 2)(1 - cos cos)."""
    m = MECHANISM
    m3 = m.tip_weight_n
    m2 = m.lifted_n - m3
    target = (0.04, 0.35, -0.33)
    checked = 0
    for span, choice in pieces(m, target):
        if choice.case is not CASE_1:
            continue
        beta = (span.lower + span.upper) / 2
        reach = m.l2_m + m.l3_m * math.cos(beta)
        theta = choice.theta(reach)
        sine, cosine = math.sin(theta), math.cos(theta)
        turns = math.tan(theta) * m.l3_m * math.sin(beta) / reach
        printed = (
            -m2 * (m.l2_m / 2 + m.l3_m * math.cos(beta)) * sine * turns
            - m3 * m.l3_m * math.cos(beta) * sine / 2 * turns
            + (-m2 - m3 / 2) * m.l3_m * math.sin(beta) * cosine
        )
        assert slopes_of(m, choice)(beta)[1] == pytest.approx(printed)
        checked += 1
    assert checked
