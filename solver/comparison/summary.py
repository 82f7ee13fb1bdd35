"""What a method's rows come to. Maximum and quantiles, never a minimum; failures are charged."""

import math
from collections.abc import Iterable, Sequence
from typing import Final

from solver.comparison.contest import Entrant
from solver.comparison.result import MethodSummary, Row, Spread

# As in the PAR10 score of algorithm selection, with the longest time in place of a time limit,
# which a comparison does not have.
FAILURE_CHARGE: Final = 10.0


def charged_time(row: Row, longest_s: float) -> float:
    """The time that a row counts with: its own, or FAILURE_CHARGE times the longest [s].

    Args:
        row: of any method.
        longest_s: the longest time of any method at any target of the comparison.
    """
    return row.time_s if row.solved else FAILURE_CHARGE * longest_s


def summaries(
    entrants: Iterable[Entrant], rows: Sequence[Row], reference: str
) -> list[MethodSummary]:
    """One summary an entrant, in their order."""
    longest = max(row.time_s for row in rows)
    answered = {row.target_id for row in rows if row.method == reference and row.solved}
    return [
        _summary(entrant, [row for row in rows if row.method == entrant.name], longest,
                 None if entrant.name == reference else answered)
        for entrant in entrants
    ]  # fmt: skip


def _summary(
    entrant: Entrant, rows: Sequence[Row], longest_s: float, answered: set[str] | None
) -> MethodSummary:
    solved = [row for row in rows if row.solved]
    cold = [row.cold_time_s for row in rows if row.cold_time_s is not None]
    iterations = [float(row.iterations) for row in rows if row.iterations is not None]
    compared = [row for row in rows if answered is not None and row.target_id in answered]
    names = dict.fromkeys(name for row in solved for name in row.residuals)
    return MethodSummary(
        method=entrant.name,
        summary=entrant.summary,
        targets=len(rows),
        solved=len(solved),
        solved_share=len(solved) / len(rows),
        time_s=spread([row.time_s for row in rows]),
        charged_time_s=sum(charged_time(row, longest_s) for row in rows) / len(rows),
        cold_time_s=spread(cold) if cold else None,
        cold_solved=sum(bool(row.cold_solved) for row in rows) if cold else None,
        gap=spread(_charged((row, row.gap) for row in rows)),
        increase_percent=(
            spread(_charged((row, row.increase_percent) for row in compared)) if compared else None
        ),
        not_compared=0 if answered is None else len(rows) - len(compared),
        time_reduction_percent=_median(row.time_reduction_percent for row in compared),
        published_time_s=_median(row.published_time_s for row in rows),
        published_increase_percent=_median(row.published_increase_percent for row in rows),
        published_time_reduction_percent=_median(
            row.published_time_reduction_percent for row in rows
        ),
        smallest_margin=min((row.margin for row in solved if row.margin is not None), default=None),
        iterations=spread(iterations) if iterations else None,
        largest_residuals={
            name: max(row.residuals[name] for row in solved if name in row.residuals)
            for name in names
        },
        largest_published_difference_percent=max(
            (
                abs(row.published_difference_percent)
                for row in solved
                if row.published_difference_percent is not None
            ),
            default=None,
        ),
    )


def _median(values: Iterable[float | None]) -> float | None:
    return quantile([value for value in values if value is not None], 0.5)


def _charged(pairs: Iterable[tuple[Row, float | None]]) -> list[float]:
    """The figures of the rows, infinite for failures; what is undefined otherwise is left out."""
    values = []
    for row, value in pairs:
        if not row.solved:
            values.append(math.inf)
        elif value is not None:
            values.append(value)
    return values


def spread(values: Sequence[float]) -> Spread:
    """Median, 95 % quantile and maximum; infinite ones are those of failures."""
    return Spread(*(quantile(values, level) for level in (0.5, 0.95, 1.0)))


def quantile(values: Sequence[float], level: float) -> float | None:
    """The quantile, linear between values; None without values or where it touches infinity."""
    if not values:
        return None
    ordered = sorted(values)
    place = level * (len(ordered) - 1)
    below = math.floor(place)
    low, high = ordered[below], ordered[min(below + 1, len(ordered) - 1)]
    share = place - below
    if share == 0:
        high = low
    return low + share * (high - low) if math.isfinite(high) else None
