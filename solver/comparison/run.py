"""Runs a contest: every method at every target, timed, judged and set beside what is published.

A method that fails stays in the table; see `solver.comparison.summary` for what it is charged.
"""

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from solver.comparison.contest import Account, Contest, Entrant, Published
from solver.comparison.machine import machine
from solver.comparison.result import (
    Comparison,
    Row,
    percent_above,
    percent_less,
)
from solver.comparison.summary import summaries

# A median of that many calls no longer moves by more than the machine does.
MOST_REPEATS: Final = 25
MAXIMUM_REPEATS: Final = 1000
# How long a person waits [s]; shared evenly, so that slow methods get fewer repeats.
TIMING_BUDGET_S: Final = 40.0

SOLVER_FAILED: Final = "solver_failed"

# How many rows of how many there are.
Progress = Callable[[int, int], None]


def run_contest(
    contest: Contest, *, repeats: int | None = None, progress: Progress | None = None
) -> Comparison:
    """Every method at every target.

    Args:
        contest: what to run; its entrants' exceptions become rows that failed.
        repeats: timed calls of each method at each target, 1 or more. By default as many as its
            share of TIMING_BUDGET_S allows, 1 to MOST_REPEATS; only times depend on that.
        progress: told after every row.

    Raises:
        ValueError: the contest has no targets or no entrants, or `repeats` is below 1.
    """
    total = len(contest.target_ids) * len(contest.entrants)
    if total == 0 or (repeats is not None and repeats < 1):
        raise ValueError("a comparison needs targets, methods and at least one repeat")
    about = machine()
    starts = total + len(contest.target_ids) * sum(
        entrant.solve_cold is not None for entrant in contest.entrants
    )
    timing = _Timing(repeats, TIMING_BUDGET_S / starts)
    rows: list[Row] = []
    accounts: dict[tuple[str, str], Account] = {}
    for number in range(len(contest.target_ids)):
        for entrant in contest.entrants:
            row, account = _row(contest, entrant, number, timing)
            rows.append(row)
            accounts[row.target_id, row.method] = account
            if progress is not None:
                progress(len(rows), total)
    rows = _compared(rows, contest.reference)
    return Comparison(
        scenario=contest.scenario,
        title=contest.title,
        origin=contest.origin,
        index_name=contest.index_name,
        notes=contest.notes,
        published_on=contest.published_on,
        reference=contest.reference,
        seeds=contest.seeds,
        machine=about,
        repeats=repeats or MOST_REPEATS,
        findings=() if contest.findings is None else contest.findings(accounts),
        rows=tuple(rows),
        summaries=tuple(summaries(contest.entrants, rows, contest.reference)),
    )


@dataclass(frozen=True)
class _Timing:
    """How often one method is timed at one target: `repeats` times, or within `budget_s`."""

    repeats: int | None
    budget_s: float

    def again(self, times_s: Sequence[float]) -> bool:
        if self.repeats is not None:
            return len(times_s) < self.repeats
        return not times_s or (len(times_s) < MOST_REPEATS and sum(times_s) < self.budget_s)


def _row(contest: Contest, entrant: Entrant, number: int, timing: _Timing) -> tuple[Row, Account]:
    """The row of an entrant at a target, and the account of its warm answer."""
    target_id = contest.target_ids[number]
    account, times = _measured(contest, entrant.name, entrant.solve, number, timing)
    published = contest.published.get((target_id, entrant.name), Published())
    row = Row(
        target_id=target_id,
        method=entrant.name,
        solved=account.solved,
        status=account.status,
        time_s=statistics.median(times),
        repeats=len(times),
        detail=account.detail,
        index=account.index,
        iterations=account.iterations,
        residuals=account.residuals,
        margin=account.margin,
        joints=account.joints,
        published_index=published.index,
        published_time_s=published.time_s,
    )
    if entrant.solve_cold is None:
        return row, account
    cold, times = _measured(contest, entrant.name, entrant.solve_cold, number, timing)
    row = replace(
        row,
        cold_time_s=statistics.median(times),
        cold_repeats=len(times),
        cold_solved=cold.solved,
        cold_index=cold.index,
        cold_detail=cold.detail,
    )
    return row, account


def _measured(
    contest: Contest, name: str, solve: Callable[[int], Any], number: int, timing: _Timing
) -> tuple[Account, list[float]]:
    """The account of the first answer, and the times of the calls after it.

    The first call builds and compiles what later ones find there, so it is not timed, unless it
    raises: then it is the only one.
    """
    began = time.perf_counter()
    try:
        answer = solve(number)
    except Exception as error:  # whatever a method raises is its failure
        return _failure("raised", error), [time.perf_counter() - began]
    times: list[float] = []
    while timing.again(times):
        began = time.perf_counter()
        try:
            solve(number)
        except Exception as error:
            times.append(time.perf_counter() - began)
            return _failure("raised when it was asked again", error), times
        times.append(time.perf_counter() - began)
    try:
        return _finite(contest.account(name, number, answer)), times
    except Exception as error:  # an answer that cannot even be judged
        return _failure("gave an answer that could not be judged", error), times


def _failure(what: str, error: Exception) -> Account:
    return Account(False, SOLVER_FAILED, f"the method {what}: {type(error).__name__}: {error}")


def _finite(account: Account) -> Account:
    """The account if it is consistent and finite; else a failure that says what is not."""
    account = _plain(account)
    numbers = {
        "index": account.index,
        "margin": account.margin,
        **{f"residual {name}": value for name, value in account.residuals.items()},
        **{f"joint {k}": value for k, value in enumerate(account.joints or (), 1)},
    }
    broken = [
        name for name, value in numbers.items() if value is not None and not math.isfinite(value)
    ]
    if broken:
        detail = f"{account.detail} Not finite: {', '.join(broken)}.".strip()
        status = SOLVER_FAILED if account.solved else account.status
        return Account(False, status, detail, iterations=account.iterations)
    if not account.solved:
        return replace(account, index=None)
    if account.index is None:
        return replace(account, solved=False, status=SOLVER_FAILED, detail="It has no index.")
    return account


def _plain(account: Account) -> Account:
    """The account with Python's own numbers, which go into JSON, in place of NumPy's."""
    return replace(
        account,
        solved=bool(account.solved),
        index=None if account.index is None else float(account.index),
        residuals={name: float(value) for name, value in account.residuals.items()},
        margin=None if account.margin is None else float(account.margin),
        joints=None if account.joints is None else tuple(map(float, account.joints)),
        iterations=None if account.iterations is None else int(account.iterations),
    )


def _compared(rows: Sequence[Row], reference: str) -> list[Row]:
    """The rows with the gap to the best and the comparison with the reference."""
    best: dict[str, float] = {}
    for row in rows:
        if row.index is not None:
            best[row.target_id] = min(row.index, best.get(row.target_id, math.inf))
    others = {row.target_id: row for row in rows if row.method == reference}
    return [_beside(row, best.get(row.target_id), others.get(row.target_id)) for row in rows]


def _beside(row: Row, best: float | None, reference: Row | None) -> Row:
    above = percent_above(row.index, best)
    if above is None and row.index is not None and row.index == best:
        above = 0.0  # the best itself, being zero
    row = replace(
        row,
        gap=None if above is None else above / 100,
        published_difference_percent=percent_above(row.index, row.published_index),
    )
    if reference is None or row.method == reference.method:
        return row
    row = replace(
        row,
        published_increase_percent=percent_above(row.published_index, reference.published_index),
        published_time_reduction_percent=percent_less(
            row.published_time_s, reference.published_time_s
        ),
    )
    if not (row.solved and reference.solved):
        return row
    return replace(
        row,
        increase_percent=percent_above(row.index, reference.index),
        time_reduction_percent=percent_less(row.time_s, reference.time_s),
    )
