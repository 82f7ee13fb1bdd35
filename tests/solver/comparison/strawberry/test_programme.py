import math

import numpy as np
import pytest
from hypothesis import given, settings

from solver.comparison.strawberry import programme
from solver.comparison.strawberry.analytic import solve_as
from solver.comparison.strawberry.index import energy_index
from solver.comparison.strawberry.mechanism import Point, Posture, forward_kinematics
from solver.comparison.strawberry.programme import solve_ncos, solve_ncos_cold, solve_programme
from solver.comparison.strawberry.semi_analytic import solve_ssas
from solver.comparison.strawberry.table_3 import PLANT_CENTRE_M, PLANT_RADIUS_M, Row, table_3
from solver.comparison.strawberry.tolerances import INDEX_ROUNDING_J
from solver.comparison.strawberry.verification import verify_answer
from solver.problem.solution import Reason
from tests.solver.comparison.strawberry.places import MECHANISM, TARGETS, answered, near, reachable

COLUMN_ERROR = 5e-4
"""What Table 3's NCOS column has to be met within, relative."""

FITTED_ERROR = 2.45e-4
"""What is reached with the one constant fitted: z is printed to 0.1 mm, or 2.5 N mm."""

PRINTED_N_MM = 0.06
"""Half the last digit of an index, and rounding of the constant."""


def least_on_a_grid(target: Point) -> float:
    """The least index over a grid of both angles, wherever the slides are inside their limits."""
    m = MECHANISM
    theta, beta = np.meshgrid(np.linspace(*m.theta, 551), np.linspace(*m.beta, 366))
    reach = m.l2_m + m.l3_m * np.cos(beta)
    s10 = target[1] - m.l1_m + m.d_y_m - m.l3_m * np.sin(beta)
    s21 = target[0] - m.d_x_m + reach * np.sin(theta)
    s32 = -target[2] + m.d_z_m - reach * np.cos(theta)
    index = m.friction_n * (s10 + s21 + s32 - sum(m.reset[:3])) + m.lifted_n * (s32 - m.s32.lower)
    index -= (m.lifted_n + m.tip_weight_n) / 2 * m.l2_m * (1 - np.cos(theta))
    index -= m.tip_weight_n * m.l3_m / 2 * (1 - np.cos(beta) * np.cos(theta))
    for slide, (lower, upper) in zip((s10, s21, s32), m.limits[:3], strict=True):
        index[(slide < lower) | (slide > upper)] = np.inf
    return float(index.min())


@pytest.mark.parametrize("row", table_3(), ids=lambda row: row.label)
def test_column_ncos_of_table_3_is_reproduced_in_every_row(row: Row) -> None:
    for method in (solve_ncos, solve_ncos_cold):
        answer = answered(method(MECHANISM, row.target))
        found = verify_answer(MECHANISM, row.target, answer)
        assert found.verification.accepted, found.verification.failures
        error = found.index_j * 1000 / row.index_n_mm["ncos"] - 1
        assert abs(error) < FITTED_ERROR < COLUMN_ERROR


def test_with_z_back_on_the_plant_the_column_is_met_to_its_last_digit() -> None:
    """Up to one constant. It is the unrounded z that the paper's programme had."""
    apart = []
    for row in table_3():
        x, y, _ = row.target
        across = math.hypot(x - PLANT_CENTRE_M[0], y - PLANT_CENTRE_M[1])
        z = PLANT_CENTRE_M[2] + math.sqrt(PLANT_RADIUS_M**2 - across**2)
        answer = answered(solve_ncos(MECHANISM, (x, y, z)))
        apart.append(answer.index_j * 1000 - row.index_n_mm["ncos"])
    assert np.ptp(apart) < 2 * PRINTED_N_MM


@pytest.mark.parametrize("target", TARGETS)
def test_three_methods_are_in_order_at_the_targets_of_table_3(target: Point) -> None:
    best, middle, worst = (
        answered(solve(MECHANISM, target)).index_j for solve in (solve_ncos, solve_ssas, solve_as)
    )
    assert best < middle < worst
    cold = answered(solve_ncos_cold(MECHANISM, target)).index_j
    assert cold == pytest.approx(best, abs=INDEX_ROUNDING_J)


@pytest.mark.parametrize("target", TARGETS[::4])
def test_no_angles_of_a_grid_are_better(target: Point) -> None:
    answer = answered(solve_ncos(MECHANISM, target))
    grid = least_on_a_grid(target)
    assert answer.index_j <= grid + INDEX_ROUNDING_J
    assert answer.index_j == pytest.approx(grid, abs=1e-4)


@settings(max_examples=60)
@given(near | reachable)
def test_methods_are_in_order_and_verified_anywhere(target: Point) -> None:
    """A failure of `ssas` need not be one of `ncos`, whose theta is free; never the reverse."""
    middle = solve_ssas(MECHANISM, target)
    if isinstance(middle, Reason):
        return
    answer = answered(solve_ncos(MECHANISM, target))
    found = verify_answer(MECHANISM, target, answer)
    assert found.verification.accepted, found.verification.failures
    assert found.index_j <= middle.index_j + INDEX_ROUNDING_J


def test_reachable_targets_are_reached_from_the_reset() -> None:
    """S warns that its start does not guarantee a solution; all but a few of 200 have one."""
    random = np.random.default_rng(0)
    solved = 0
    for _ in range(200):
        posture = Posture(*(float(random.uniform(*span)) for span in MECHANISM.limits))
        target = forward_kinematics(MECHANISM, posture)
        answer = solve_ncos_cold(MECHANISM, target)
        if isinstance(answer, Reason):
            assert answer.code == "solver_failed"
            continue
        found = verify_answer(MECHANISM, target, answer)
        assert found.verification.accepted, found.verification.failures
        assert found.index_j <= energy_index(MECHANISM, posture) + INDEX_ROUNDING_J
        solved += 1
    assert solved >= 195


@pytest.mark.parametrize("worse", [Reason("solver_failed", "IPOPT: no"), None])
def test_a_programme_that_fails_or_ends_higher_leaves_its_start(
    worse: Reason | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    start = answered(solve_ssas(MECHANISM, TARGETS[0]))
    found = worse or answered(solve_as(MECHANISM, TARGETS[0]))
    monkeypatch.setattr(programme, "solve_programme", lambda *_: found)
    answer = answered(solve_ncos(MECHANISM, TARGETS[0]))
    assert answer.posture == start.posture
    assert answer.status == "kept its start"


def test_the_programme_itself_is_right_where_limits_hold_it() -> None:
    """Warm starts would hide a programme that never succeeds: here it must beat its start."""
    improved = 0
    for target in TARGETS:
        start = answered(solve_ssas(MECHANISM, target))
        found = answered(solve_programme(MECHANISM, target, start.posture))
        assert found.index_j == pytest.approx(energy_index(MECHANISM, found.posture))
        improved += found.index_j < start.index_j
    assert improved == len(TARGETS)


def test_targets_without_a_posture_are_refused() -> None:
    for solve in (solve_ncos, solve_ncos_cold):
        reason = solve(MECHANISM, (2.0, 0.35, -0.33))
        assert isinstance(reason, Reason)
        assert reason.code == "out_of_reach"
    # In the box, but its corners are not reached: both angles cannot be extreme at once.
    corner = (-0.04, 0.78, -0.43)
    reason = solve_ncos(MECHANISM, corner)
    assert isinstance(reason, Reason)
    assert reason.code == "solver_failed"
    assert reason.detail.startswith("IPOPT")


def test_starts_that_are_no_numbers_are_an_answer() -> None:
    start = Posture(math.nan, 0.1, 0.1, 0.0, 0.0)
    assert isinstance(solve_programme(MECHANISM, TARGETS[0], start), Reason)
