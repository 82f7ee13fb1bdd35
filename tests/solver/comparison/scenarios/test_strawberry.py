import dataclasses
import math

import pytest

from solver.comparison.scenarios.strawberry import METHODS, strawberry_contest
from solver.comparison.strawberry.answer import Answer
from solver.comparison.strawberry.table_3 import table_3
from tests.solver.comparison.strawberry.places import MECHANISM, TARGETS, answered

CONTEST = strawberry_contest()
ROWS = table_3()


def account(name: str, number: int, *, cold: bool = False):  # type: ignore[no-untyped-def]
    (entrant,) = [entry for entry in CONTEST.entrants if entry.name == name]
    solve = entrant.solve_cold if cold else entrant.solve
    assert solve is not None
    return CONTEST.account(name, number, solve(number))


def test_every_target_and_published_figure_of_table_3_is_there() -> None:
    assert CONTEST.scenario == "strawberry"
    assert CONTEST.target_ids == tuple(row.label for row in ROWS)
    assert len(CONTEST.published) == 60
    for row in ROWS:
        for method in ("ncos", "ssas", "as"):
            published = CONTEST.published[row.label, method]
            assert published.index == row.index_n_mm[method]
            assert published.time_s == row.time_s[method]
    assert "i7 920" in CONTEST.published_on
    assert [entry.name for entry in CONTEST.entrants] == list(METHODS)
    assert CONTEST.reference in METHODS


@pytest.mark.parametrize("number", range(20))
def test_accounts_of_a_target_are_solved_and_in_order(number: int) -> None:
    """In N mm, and `ncos` beside its published figure, warm and cold."""
    best, middle, worst = (account(name, number) for name in ("ncos", "ssas", "as"))
    assert best.solved
    assert middle.solved
    assert worst.solved
    assert best.index < middle.index < worst.index
    assert best.index == pytest.approx(ROWS[number].index_n_mm["ncos"], rel=5e-4)
    assert account("ncos", number, cold=True).index == pytest.approx(best.index, abs=1e-4)
    assert best.residuals["position_m"] < 1e-6
    assert best.margin > 0
    assert len(best.joints) == 5


@pytest.mark.parametrize("number", range(20))
def test_printed_rows_fail_or_are_dearer(number: int) -> None:
    refused = account("as_printed", number)
    assert (refused.solved, refused.status) == (False, "out_of_reach")
    missed = account("as_printed_18", number)
    assert (missed.solved, missed.status) == (False, "solver_failed")
    assert "position_m" in missed.detail
    assert missed.index is None
    for name in ("ssas_printed", "ssas_printed_without_30"):
        dearer = account(name, number)
        assert not dearer.solved or dearer.index > account("ssas", number).index


def test_a_broken_method_shows_up_as_failed() -> None:
    """Whatever it claims: a tip off its target, a joint beyond its limit, numbers that are none."""
    right = answered(METHODS["as"](MECHANISM, TARGETS[0]))
    for broken in (
        right.posture._replace(s21_m=right.posture.s21_m + 1e-3),
        right.posture._replace(beta_rad=-0.1),
        right.posture._replace(s32_m=math.nan),
    ):
        found = CONTEST.account("as", 0, Answer(broken, right.index_j))
        assert not found.solved
        assert found.index is None
        assert "refused by the verifier" in found.detail
    cheap = dataclasses.replace(right, index_j=0.0)
    assert not CONTEST.account("as", 0, cheap).solved
    assert CONTEST.account("as", 0, right).solved
