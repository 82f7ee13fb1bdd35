"""Time against effort: one marker a method, failures at the edge."""

from collections.abc import Sequence
from typing import Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from app.reports.drawings.contest_style import method_style
from app.reports.drawings.labels import plain_text
from solver.comparison.result import Comparison, Row

FAILED_MARKER: Final = "x"
# Gaps below this are rounding: everything there is drawn as the best [%].
SMALLEST_GAP_PERCENT: Final = 1e-4
FAILED_HEIGHT: Final = 0.94  # in shares of the panel


def draw_times(comparison: Comparison) -> Figure:
    """The index on the left, what it is above the best known on the right, over time."""
    figure = Figure(figsize=(12, 5.2), facecolor="white", layout="constrained")
    left, right = figure.subplots(1, 2)
    for summary in comparison.summaries:
        rows = [row for row in comparison.rows if row.method == summary.method]
        _scatter(left, comparison, rows, [row.index for row in rows])
        gaps = [
            None if row.gap is None else max(100 * row.gap, SMALLEST_GAP_PERCENT) for row in rows
        ]
        _scatter(right, comparison, rows, gaps)
    left.set_ylabel(comparison.index_name.replace("$", r"\$"))
    right.set_ylabel("above the best known [%]")
    right.set_yscale("log")
    low, high = right.get_ylim()
    right.yaxis.set_major_formatter("{x:g}")
    right.set_ylim(min(low, SMALLEST_GAP_PERCENT / 2), max(high * 20, 10))
    left.margins(y=0.25)
    times = [1000 * row.time_s for row in comparison.rows]
    for axes in (left, right):
        axes.set_xscale("log")
        # Failures are placed by the edge and not by the data, so the limits do not know them.
        axes.set_xlim(min(times) / 1.5, max(times) * 1.5)
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_xlabel("time a target, median of the calls [ms]")
        axes.grid(alpha=0.25)
    right.axhline(SMALLEST_GAP_PERCENT, color="grey", linewidth=0.8, linestyle="--")
    right.text(
        0.99, SMALLEST_GAP_PERCENT, "the best, to a part in a million", fontsize=8, color="grey",
        ha="right", va="bottom", transform=right.get_yaxis_transform(),
    )  # fmt: skip
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", frameon=False,
                  fontsize=9, ncols=5)  # fmt: skip
    return figure


def _scatter(
    axes: Axes, comparison: Comparison, rows: Sequence[Row], heights: Sequence[float | None]
) -> None:
    style = method_style(comparison, rows[0].method)
    points = [
        (1000 * row.time_s, height)
        for row, height in zip(rows, heights, strict=True)
        if height is not None
    ]
    failures = [1000 * row.time_s for row in rows if not row.solved]
    label = plain_text(rows[0].method)
    if points:
        times, values = zip(*points, strict=True)
        axes.scatter(times, values, s=36, alpha=0.8, linewidths=0, label=label, **style)
    if failures:
        axes.scatter(
            failures,
            [FAILED_HEIGHT] * len(failures),
            s=50,
            color=style["color"],
            marker=FAILED_MARKER,
            transform=axes.get_xaxis_transform(),
            label=f"{label}, no answer ({len(failures)})",
        )
