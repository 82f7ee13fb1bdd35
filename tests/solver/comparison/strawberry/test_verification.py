import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.comparison.strawberry.analytic import solve_as
from solver.comparison.strawberry.answer import Answer
from solver.comparison.strawberry.index import energy_index
from solver.comparison.strawberry.mechanism import JOINT_NAMES, Point, Posture, forward_kinematics
from solver.comparison.strawberry.programme import solve_ncos
from solver.comparison.strawberry.semi_analytic import solve_ssas
from solver.comparison.strawberry.verification import verify_answer
from tests.solver.comparison.strawberry.places import MECHANISM, TARGETS, answered, postures

RIGHT = answered(solve_as(MECHANISM, TARGETS[0]))


def failures(answer: Answer, target: Point = TARGETS[0]) -> list[str]:
    return [entry.name for entry in verify_answer(MECHANISM, target, answer).verification.failures]


def claimed(posture: Posture) -> Answer:
    return Answer(posture, energy_index(MECHANISM, posture))


@pytest.mark.parametrize("solve", [solve_as, solve_ssas, solve_ncos])
@pytest.mark.parametrize("target", TARGETS)
def test_all_three_methods_are_accepted(solve, target: Point) -> None:  # type: ignore[no-untyped-def]
    answer = answered(solve(MECHANISM, target))
    found = verify_answer(MECHANISM, target, answer)
    assert found.verification.failures == ()
    assert found.margin > 0
    assert len(found.verification.residuals) == 7


@given(st.sampled_from(range(5)), st.sampled_from((-1.0, 1.0)), st.floats(1e-4, 0.1))
def test_a_joint_that_is_off_is_seen(joint: int, sign: float, by: float) -> None:
    values = list(RIGHT.posture)
    values[joint] += sign * by
    assert "position_m" in failures(claimed(Posture(*values)))


@given(postures, st.sampled_from(range(5)), st.booleans())
def test_a_joint_beyond_its_limit_is_seen(posture: Posture, joint: int, above: bool) -> None:
    span = MECHANISM.limits[joint]
    values = list(posture)
    values[joint] = span.upper + 1e-6 if above else span.lower - 1e-6
    wrong = Posture(*values)
    unit = "m" if joint < 3 else "rad"
    assert failures(claimed(wrong), forward_kinematics(MECHANISM, wrong)) == [
        f"{JOINT_NAMES[joint]}_excess_{unit}"
    ]
    found = verify_answer(MECHANISM, TARGETS[0], claimed(wrong))
    assert found.margin == pytest.approx(-1e-6)


def test_another_claimed_index_is_seen() -> None:
    assert failures(replace(RIGHT, index_j=RIGHT.index_j * (1 - 1e-6))) == ["index_error_j"]
    assert failures(replace(RIGHT, index_j=math.nan)) == ["index_error_j"]


def test_numbers_that_are_none_are_not_accepted() -> None:
    assert "position_m" in failures(Answer(Posture(*[math.nan] * 5), RIGHT.index_j))
