"""What people read of a comparison: text in tables, for Markdown, HTML and the terminal alike."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from solver.comparison.result import Comparison, MethodSummary, Row, Spread
from solver.comparison.run import SOLVER_FAILED
from solver.comparison.summary import FAILURE_CHARGE

FAILED, NONE = "failed", "-"


@dataclass(frozen=True)
class TextTable:
    """A table of text; `failed` has the numbers of the rows that are failures."""

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    failed: frozenset[int] = frozenset()


@dataclass(frozen=True)
class Column:
    """A column for people, and the fields of the row that it shows."""

    heading: str
    fields: tuple[str, ...]
    cell: Callable[[Row], str]


def _figure(name: str, write: Callable[[float], str]) -> Callable[[Row], str]:
    def cell(row: Row) -> str:
        value: float | None = getattr(row, name)
        if value is not None:
            return write(value)
        needs_answer = name in ("index", "gap", "increase_percent", "time_reduction_percent")
        return FAILED if needs_answer and not row.solved else NONE

    return cell


def number(value: float, digits: int = 6) -> str:
    """A figure for people."""
    return f"{value:.{digits}g}"


def seconds(value: float) -> str:
    """A duration for people, in the unit that suits it."""
    for unit, size in (("µs", 1e-6), ("ms", 1e-3)):
        if value < 1000 * size * 0.9995:
            return f"{value / size:.3g} {unit}"
    return f"{value:.3g} s"


def _percent(value: float) -> str:
    return f"{value:.4g}" if abs(value) >= 5e-7 else "0"


def _solved(row: Row) -> str:
    return "yes" if row.solved else f"no: {row.status}"


def _cold_solved(row: Row) -> str:
    return {True: "yes", False: "no", None: NONE}[row.cold_solved]


ROW_COLUMNS: Final = (
    Column("target", ("target_id",), lambda row: row.target_id),
    Column("method", ("method",), lambda row: row.method),
    Column("solved", ("solved", "status"), _solved),
    Column("index", ("index",), _figure("index", number)),
    Column("published", ("published_index",), _figure("published_index", number)),
    Column(
        "difference %",
        ("published_difference_percent",),
        _figure("published_difference_percent", _percent),
    ),
    Column("increase %", ("increase_percent",), _figure("increase_percent", _percent)),
    Column(
        "published increase %",
        ("published_increase_percent",),
        _figure("published_increase_percent", _percent),
    ),
    Column("above best %", ("gap",), _figure("gap", lambda value: _percent(100 * value))),
    Column("time", ("time_s",), _figure("time_s", seconds)),
    Column("published time", ("published_time_s",), _figure("published_time_s", seconds)),
    Column("time less %", ("time_reduction_percent",), _figure("time_reduction_percent", _percent)),
    Column(
        "published time less %",
        ("published_time_reduction_percent",),
        _figure("published_time_reduction_percent", _percent),
    ),
    Column("cold time", ("cold_time_s",), _figure("cold_time_s", seconds)),
    Column("cold solved", ("cold_solved",), _cold_solved),
    Column("margin", ("margin",), _figure("margin", lambda value: number(value, 3))),
    Column("iterations", ("iterations",), _figure("iterations", lambda value: str(int(value)))),
    Column("detail", ("detail",), lambda row: row.detail),
)


def row_table(comparison: Comparison) -> TextTable:
    """A line a target and method; columns that no row has anything in are left out."""
    rows = comparison.rows
    columns = [
        column
        for column in ROW_COLUMNS
        if any(getattr(row, name) not in (None, "") for row in rows for name in column.fields)
    ]
    return TextTable(
        tuple(column.heading for column in columns),
        tuple(tuple(column.cell(row) for column in columns) for row in rows),
        frozenset(k for k, row in enumerate(rows) if not row.solved),
    )


def residual_table(comparison: Comparison) -> TextTable:
    """What the verifier recomputed of every answer."""
    rows = [row for row in comparison.rows if row.residuals]
    names = tuple(dict.fromkeys(name for row in rows for name in row.residuals))
    return TextTable(
        ("target", "method", *names),
        tuple(
            (
                row.target_id,
                row.method,
                *(
                    number(row.residuals[name], 3) if name in row.residuals else NONE
                    for name in names
                ),
            )
            for row in rows
        ),
        frozenset(k for k, row in enumerate(rows) if not row.solved),
    )


def _spread(spread: Spread | None, write: Callable[[float], str]) -> tuple[str, str, str]:
    if spread is None:
        return NONE, NONE, NONE
    median, q95, top = (
        FAILED if value is None else write(value)
        for value in (spread.median, spread.q95, spread.max)
    )
    return median, q95, top


ANSWER_HEADINGS: Final = (
    "method", "what", "solved", "increase % median", "increase % 95 %", "increase % max",
    "published increase %", "above best % median", "above best % 95 %", "above best % max",
    "largest difference to published %", "smallest margin", "iterations max",
)  # fmt: skip
TIME_HEADINGS: Final = (
    "method", "solved", "time median", "time 95 %", "time max", "time charged", "published time",
    "time less %", "published time less %", "cold median", "cold max", "cold solved",
)  # fmt: skip


def _answer_cells(summary: MethodSummary) -> tuple[str, ...]:
    return (
        summary.method,
        summary.summary,
        f"{summary.solved} of {summary.targets}",
        *_spread(summary.increase_percent, _percent),
        _optional(summary.published_increase_percent, _percent),
        *_spread(summary.gap, lambda value: _percent(100 * value)),
        _optional(summary.largest_published_difference_percent, _percent),
        _optional(summary.smallest_margin, lambda value: number(value, 3)),
        _spread(summary.iterations, lambda value: f"{value:g}")[2],
    )


def _time_cells(summary: MethodSummary) -> tuple[str, ...]:
    cold, cold_solved = _spread(summary.cold_time_s, seconds), summary.cold_solved
    return (
        summary.method,
        f"{summary.solved} of {summary.targets}",
        *_spread(summary.time_s, seconds),
        seconds(summary.charged_time_s),
        _optional(summary.published_time_s, seconds),
        _optional(summary.time_reduction_percent, _percent),
        _optional(summary.published_time_reduction_percent, _percent),
        cold[0],
        cold[2],
        NONE if cold_solved is None else f"{cold_solved} of {summary.targets}",
    )


def _optional(value: float | None, write: Callable[[float], str]) -> str:
    return NONE if value is None else write(value)


def answer_table(comparison: Comparison) -> TextTable:
    """What a method's answers come to, a line a method."""
    return _kept(ANSWER_HEADINGS, [_answer_cells(summary) for summary in comparison.summaries])


def time_table(comparison: Comparison) -> TextTable:
    """What they cost, a line a method."""
    return _kept(TIME_HEADINGS, [_time_cells(summary) for summary in comparison.summaries])


def _kept(headings: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> TextTable:
    """The table without the columns that no row has anything in."""
    kept = [k for k in range(len(headings)) if any(row[k] not in ("", NONE) for row in rows)]
    return TextTable(_picked(headings, kept), tuple(_picked(row, kept) for row in rows))


def _picked(cells: Sequence[str], places: Iterable[int]) -> tuple[str, ...]:
    return tuple(cells[k] for k in places)


def reading_notes(comparison: Comparison) -> tuple[str, ...]:
    """How the tables count, a sentence each."""
    notes = [
        "Index, margin and residuals are recomputed from the posture by the verifier, outside the "
        "time that is measured; no method's own figures are believed.",
        f"Time is the median of at most {comparison.repeats} timed calls of a method at a target, "
        "after one that is not counted.",
        "A failure stays in every table and is charged: it counts against the solved share, ranks "
        "behind every answer in the quantiles of above best and increase (they read "
        f"“{FAILED}” where they fall on one), and “time charged”, a mean, takes it for "
        f"{FAILURE_CHARGE:g} times the longest time of any method at any target.",
        "Above best: how far the index is above the least of any method at the same target.",
    ]
    if any(row.method == comparison.reference for row in comparison.rows):
        notes.append(
            "Increase and time less: against "
            f"{comparison.reference} at the same target, in per cent; without a value for "
            f"{comparison.reference} itself and where it has no answer to compare with."
        )
    missing = max((summary.not_compared for summary in comparison.summaries), default=0)
    if missing:
        notes.append(f"{comparison.reference} has no answer at {missing} targets.")
    if any(row.status == SOLVER_FAILED for row in comparison.rows):
        notes.append(f"{SOLVER_FAILED}: the method raised, or its answer does not hold.")
    return tuple(notes)


def machine_lines(comparison: Comparison) -> tuple[tuple[str, str], ...]:
    """On what and with what it was measured: name and text."""
    about = comparison.machine
    versions = ", ".join(f"{name} {version}" for name, version in about["versions"].items())
    lines = [
        ("machine", f"{about['processor']}, {about['cores']} cores, {about['memory_gib']} GiB"),
        ("system", f"{about['system']}, load at the start {about['load_average']}"),
        ("versions", f"Python {about['python']}, {versions}"),
        ("seeds", ", ".join(map(str, comparison.seeds)) or "none: nothing is random"),
        ("date", str(about["date"])),
    ]
    if comparison.published_on:
        lines.append(("published figures", comparison.published_on))
    return tuple(lines)
