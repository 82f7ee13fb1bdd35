import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.comparison.result import MethodSummary
from solver.comparison.run import run_contest
from solver.comparison.summary import FAILURE_CHARGE, quantile, spread
from tests.solver.comparison.contests import BEST, HALF, RAISES, WORSE, WRONG, small_contest

finite = st.floats(-1e6, 1e6)


def summary_of(method: str) -> tuple[MethodSummary, float]:
    """A method's summary in the small contest, and the longest time of any row."""
    comparison = run_contest(small_contest(), repeats=2)
    (summary,) = [entry for entry in comparison.summaries if entry.method == method]
    return summary, max(row.time_s for row in comparison.rows)


@given(st.lists(finite, min_size=1, max_size=30), st.sampled_from([0.0, 0.5, 0.95, 1.0]))
def test_quantiles_are_numpys(values: list[float], level: float) -> None:
    found = quantile(values, level)
    assert found == pytest.approx(float(np.quantile(values, level)), rel=1e-9, abs=1e-6)


@given(st.lists(finite, min_size=1, max_size=20), st.integers(1, 20))
def test_failures_rank_behind_every_answer(values: list[float], failures: int) -> None:
    charged = spread([*values, *[math.inf] * failures])
    assert charged.max is None
    if failures > len(values):
        assert charged.median is None
    elif charged.median is not None:
        assert charged.median >= float(np.median(values)) - 1e-6


def test_no_values_have_no_quantile() -> None:
    assert spread([]) == spread([math.inf])


def test_a_method_that_fails_everywhere_is_charged_and_stays() -> None:
    for method in ("wrong", "raises"):
        summary, longest = summary_of(method)
        assert (summary.targets, summary.solved, summary.solved_share) == (3, 0, 0.0)
        assert summary.charged_time_s == pytest.approx(FAILURE_CHARGE * longest)
        assert summary.charged_time_s > longest
        assert summary.time_s.max is not None
        for charged in (summary.gap, summary.increase_percent):
            assert charged == spread([math.inf])
        assert summary.time_reduction_percent is None
        assert summary.smallest_margin is None


def test_a_method_that_fails_once_is_charged_once() -> None:
    summary, longest = summary_of("half")
    assert (summary.solved, summary.targets) == (2, 3)
    assert summary.gap.median == pytest.approx(4.0)
    assert summary.gap.max is None
    assert FAILURE_CHARGE * longest / 3 < summary.charged_time_s < FAILURE_CHARGE * longest
    assert summary.smallest_margin == pytest.approx(1.0)
    assert summary.largest_residuals == {"excess_m": 0.0}


def test_a_method_without_failures_is_charged_its_own_time() -> None:
    comparison = run_contest(small_contest(BEST, WORSE), repeats=2)
    for summary in comparison.summaries:
        times = [row.time_s for row in comparison.rows if row.method == summary.method]
        assert summary.charged_time_s == pytest.approx(float(np.mean(times)))
        assert summary.time_s.median == pytest.approx(float(np.median(times)))


def test_where_the_reference_fails_nothing_is_compared_and_it_is_said() -> None:
    comparison = run_contest(small_contest(BEST, HALF, WORSE, WRONG, RAISES), repeats=1)
    by_half = run_contest(
        # As its reference, the method that fails at one target of three.
        dataclasses.replace(small_contest(BEST, HALF, WORSE, WRONG, RAISES), reference="half"),
        repeats=1,
    )
    assert all(summary.not_compared == 0 for summary in comparison.summaries)
    worse = {summary.method: summary for summary in by_half.summaries}["as"]
    assert worse.not_compared == 1
    assert worse.increase_percent is not None
    assert worse.increase_percent.max == pytest.approx(-75)
