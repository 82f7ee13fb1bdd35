import dataclasses
import math
from typing import Any

import pytest

from solver.comparison.contest import Account, Contest, Entrant, with_entrants
from solver.comparison.result import Comparison, Row
from solver.comparison.run import MOST_REPEATS, run_contest
from solver.exceptions import UnknownEntrant
from tests.solver.comparison.contests import (
    BEST,
    HALF,
    RAISES,
    TARGETS,
    WORSE,
    WRONG,
    account,
    off_by,
    small_contest,
)


def run(*entrants: Entrant, **changes: Any) -> Comparison:
    return run_contest(dataclasses.replace(small_contest(*entrants), **changes), repeats=2)


def row_of(comparison: Comparison, target_id: str, method: str) -> Row:
    (row,) = [row for row in comparison.rows if (row.target_id, row.method) == (target_id, method)]
    return row


def test_every_method_has_a_row_at_every_target_in_order() -> None:
    comparison = run()
    methods = [entrant.name for entrant in small_contest().entrants]
    assert [(row.target_id, row.method) for row in comparison.rows] == [
        (target_id, method) for target_id in ("1", "2", "3") for method in methods
    ]
    assert [summary.method for summary in comparison.summaries] == methods


def test_index_gap_and_increase_are_those_of_the_account() -> None:
    comparison = run(BEST, WORSE)
    for target_id in ("1", "2", "3"):
        best, worse = (row_of(comparison, target_id, name) for name in ("ncos", "as"))
        assert (best.index, best.gap, best.iterations) == (1.0, 0.0, 1)
        assert worse.index == pytest.approx(1.25)
        assert worse.gap == pytest.approx(0.25)
        assert worse.increase_percent == pytest.approx(25)
        assert worse.time_reduction_percent == pytest.approx(100 * (1 - worse.time_s / best.time_s))
        assert best.increase_percent is None
        assert best.time_reduction_percent is None


def test_cold_starts_are_apart() -> None:
    comparison = run(BEST, WORSE)
    best, worse = (row_of(comparison, "1", name) for name in ("ncos", "as"))
    assert best.cold_solved
    assert best.cold_index == pytest.approx(1.01)
    assert best.index == 1.0
    assert worse.cold_time_s is None
    assert worse.cold_solved is None


def test_published_figures_stand_beside_the_measured_ones() -> None:
    comparison = run(BEST, WORSE)
    first, second = (row_of(comparison, target_id, "as") for target_id in ("1", "2"))
    assert (first.published_index, first.published_time_s) == (1.5, 0.1)
    assert first.published_increase_percent == pytest.approx(50)
    assert first.published_time_reduction_percent == pytest.approx(80)
    assert first.published_difference_percent == pytest.approx(100 * (1.25 - 1.5) / 1.5)
    # Nothing is printed of the reference there.
    assert second.published_index == 2.0
    assert second.published_increase_percent is None


def test_a_wrong_posture_is_a_failure_with_its_residual() -> None:
    row = row_of(run(BEST, WRONG), "1", "wrong")
    assert not row.solved
    assert (row.status, row.detail) == ("joint_limit", "x is beyond 5")
    assert row.residuals == {"excess_m": pytest.approx(5.0)}
    assert row.index is None
    assert row.gap is None
    assert row.increase_percent is None
    assert row.time_reduction_percent is None


def test_a_method_that_raises_is_a_failure_and_not_the_end() -> None:
    comparison = run(RAISES, BEST)
    row = row_of(comparison, "3", "raises")
    assert (row.solved, row.status) == (False, "solver_failed")
    assert "RuntimeError: no idea about 2" in row.detail
    assert row.time_s > 0
    assert all(row_of(comparison, target_id, "ncos").solved for target_id in ("1", "2", "3"))


def test_a_method_that_raises_only_when_asked_again_is_a_failure() -> None:
    asked: list[int] = []

    def solve(number: int) -> tuple[float, int]:
        asked.append(number)
        if asked.count(number) > 1:
            raise RuntimeError("once is enough")
        return TARGETS[number], 1

    row = row_of(run(Entrant("moody", "", solve), BEST), "1", "moody")
    assert not row.solved
    assert "once is enough" in row.detail


def test_a_cold_start_that_raises_leaves_the_warm_answer() -> None:
    def raises(number: int) -> Any:
        raise ValueError("too cold")

    row = row_of(run(dataclasses.replace(BEST, solve_cold=raises)), "1", "ncos")
    assert row.solved
    assert row.cold_solved is False
    assert "too cold" in row.cold_detail


@pytest.mark.parametrize("answer", [None, "text", (1.0,)])
def test_an_answer_that_cannot_be_judged_is_a_failure(answer: Any) -> None:
    row = row_of(run(Entrant("odd", "", lambda _: answer), BEST), "1", "odd")
    assert (row.solved, row.status) == (False, "solver_failed")
    assert "could not be judged" in row.detail


@pytest.mark.parametrize(
    "broken",
    [
        Account(True, "planned", index=math.nan),
        Account(True, "planned", index=1.0, margin=math.inf),
        Account(True, "planned", index=1.0, residuals={"position_m": math.nan}),
        Account(True, "planned", index=1.0, joints=(0.0, math.nan)),
        Account(True, "planned"),
    ],
)
def test_an_account_without_finite_numbers_is_a_failure(broken: Account) -> None:
    row = row_of(run(BEST, account=lambda *_: broken), "1", "ncos")
    assert (row.solved, row.status, row.index) == (False, "solver_failed", None)
    assert row.detail


def test_the_best_known_is_the_best_of_what_holds() -> None:
    """An answer that does not hold sets no mark, however low it claims to be."""
    liar = Entrant("liar", "", lambda number: (9.0, 1))
    comparison = run(WORSE, liar)
    assert row_of(comparison, "1", "as").gap == 0.0


def test_figures_are_numbers_of_python() -> None:
    numpy = pytest.importorskip("numpy")

    def with_numpy(name: str, number: int, answer: Any) -> Account:
        found = account(name, number, answer)
        return dataclasses.replace(
            found, index=numpy.float64(found.index), iterations=numpy.int64(3)
        )

    row = row_of(run(BEST, account=with_numpy), "1", "ncos")
    assert type(row.index) is float
    assert type(row.iterations) is int


def test_repeats_are_as_asked_or_within_the_budget() -> None:
    assert {row.repeats for row in run(BEST, WORSE).rows} == {2}
    by_itself = run_contest(small_contest(BEST, WORSE))
    assert {row.repeats for row in by_itself.rows} == {MOST_REPEATS}


def test_progress_is_told_row_by_row() -> None:
    told: list[tuple[int, int]] = []
    run_contest(small_contest(BEST, RAISES), repeats=1, progress=lambda *now: told.append(now))
    assert told == [(k, 6) for k in range(1, 7)]


def test_findings_are_made_from_the_accounts() -> None:
    def findings(accounts: Any) -> tuple[str, ...]:
        solved = sum(found.solved for found in accounts.values())
        return (f"{solved} of {len(accounts)}", accounts["1", "wrong"].status)

    assert run(BEST, WRONG, findings=findings).findings == ("3 of 6", "joint_limit")
    assert run(BEST).findings == ()


def test_machine_versions_and_seeds_are_there() -> None:
    comparison = run(BEST)
    assert comparison.seeds == (7,)
    assert comparison.machine["processor"]
    assert "numpy" in comparison.machine["versions"]


def empty(contest: Contest) -> Contest:
    return dataclasses.replace(contest, target_ids=())


def test_nothing_to_compare_is_misuse() -> None:
    with pytest.raises(ValueError, match="targets"):
        run_contest(empty(small_contest(BEST)))
    with pytest.raises(ValueError, match="repeat"):
        run_contest(small_contest(BEST), repeats=0)


def test_entrants_by_name() -> None:
    contest = small_contest(BEST, WORSE, HALF)
    assert with_entrants(contest, None) is contest
    kept = with_entrants(contest, ("half", "ncos"))
    assert [entrant.name for entrant in kept.entrants] == ["ncos", "half"]
    with pytest.raises(UnknownEntrant) as raised:
        with_entrants(contest, ("ncos", "nobody"))
    assert (raised.value.name, raised.value.known) == ("nobody", ("ncos", "as", "half"))


def test_without_the_reference_nothing_is_compared_with_it() -> None:
    comparison = run(WORSE, Entrant("far", "", off_by(-0.7)))
    assert all(row.increase_percent is None for row in comparison.rows)
    assert all(summary.increase_percent is None for summary in comparison.summaries)
    assert row_of(comparison, "1", "far").gap == pytest.approx(1.49 / 1.25 - 1)
