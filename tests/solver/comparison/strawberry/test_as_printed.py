"""Each misprint of S on its own, as as_printed.py shows it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solver.comparison.strawberry.analytic import outside_box, solve_as
from solver.comparison.strawberry.as_printed import (
    printed_box,
    solve_as_printed,
    solve_as_printed_18,
    solve_ssas_printed,
    solve_ssas_printed_without_30,
)
from solver.comparison.strawberry.index import energy_index, printed_index
from solver.comparison.strawberry.mechanism import Point, posture_at
from solver.comparison.strawberry.semi_analytic import solve_ssas
from solver.comparison.strawberry.verification import verify_answer
from solver.problem.solution import Reason
from tests.solver.comparison.strawberry.places import MECHANISM, TARGETS, answered


@pytest.mark.parametrize("target", TARGETS)
def test_step_1_as_printed_refuses_every_target(target: Point) -> None:
    assert outside_box(MECHANISM, target) is None
    reason = solve_as_printed(MECHANISM, target)
    assert isinstance(reason, Reason)
    assert reason.code == "out_of_reach"
    assert "z is not between" in reason.detail


def test_the_printed_box_is_empty_whatever_the_offsets_are() -> None:
    """Both ends along z move with d_z."""
    _, _, z = printed_box(MECHANISM)
    assert z.lower > z.upper


@pytest.mark.parametrize("target", TARGETS)
def test_equation_18_as_printed_misses_by_twice_d_z(target: Point) -> None:
    answer = answered(solve_as_printed_18(MECHANISM, target))
    found = verify_answer(MECHANISM, target, answer)
    assert not found.verification.accepted
    assert "position_m" in [entry.name for entry in found.verification.failures]
    off = found.verification.residuals[0].value
    assert off == pytest.approx(2 * abs(MECHANISM.d_z_m))
    corrected = answered(solve_as(MECHANISM, target)).posture
    assert answer.posture._replace(s32_m=corrected.s32_m) == corrected


def test_equality_30_fixes_beta_at_45_degrees_or_leaves_nothing() -> None:
    refused = []
    for target in TARGETS:
        answer = solve_ssas_printed(MECHANISM, target)
        if isinstance(answer, Reason):
            assert answer.code == "solver_failed"
            refused.append(target[1])
            continue
        assert math.degrees(answer.posture.beta_rad) == pytest.approx(45.0, abs=1e-6)
        found = verify_answer(MECHANISM, target, answer)
        assert found.verification.accepted
        # Dearer than the closed form that it is meant to improve on.
        assert found.index_j > answered(solve_as(MECHANISM, target)).index_j
        assert found.index_j > answered(solve_ssas(MECHANISM, target)).index_j
    # The targets nearest to the reset along y, where s10 would have to be below its limit.
    assert sorted(refused) == pytest.approx([0.270, 0.280, 0.280])


@pytest.mark.parametrize("target", TARGETS)
def test_p1_with_the_printed_sign_lands_on_the_maximum(target: Point) -> None:
    """Of the very index that it is meant to minimise."""
    answer = answered(solve_ssas_printed_without_30(MECHANISM, target))
    along = [
        printed_index(MECHANISM, posture)
        for beta in np.linspace(*MECHANISM.beta, 200).tolist()
        if (posture := posture_at(MECHANISM, target, 0.0, beta)).s10_m >= MECHANISM.s10.lower
    ]
    assert printed_index(MECHANISM, answer.posture) == pytest.approx(max(along))
    assert max(along) - min(along) > 0.1
    assert energy_index(MECHANISM, answer.posture) > answered(solve_ssas(MECHANISM, target)).index_j


@pytest.mark.parametrize(("tip_weight_n", "beta_deg"), [(0.0, 0.0), (9.8, 0.0), (9.82, 73.0)])
def test_on_which_end_p1_lands_depends_on_an_unknown(tip_weight_n: float, beta_deg: float) -> None:
    """With theta = 0, dJ/ds10 = 9.81 + (9.81 - m3 g) tan(beta) / 2 [N] has no root in the range."""
    mechanism = replace(MECHANISM, tip_weight_n=tip_weight_n)
    answer = answered(solve_ssas_printed_without_30(mechanism, TARGETS[0]))
    assert math.degrees(answer.posture.beta_rad) == pytest.approx(beta_deg, abs=1e-9)
