"""Plots of the results; each is None where its figures are missing."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from matplotlib.figure import Figure

from bench.results import rows_of

OURS, OTHERS, PUBLISHED = "#e0457b", "#7a8ca3", "#c9b458"

Results = Mapping[str, dict[str, Any]]

# subject, row, label, colour, milliseconds for the row's unit
_TIMES: Final = (
    ("thesis", "thesis, a target", "thesis (2012), a target", PUBLISHED, 1.0),
    ("thesis", "thesis, 50 angles", "thesis (2012), 50 angles", PUBLISHED, 1.0),
    ("cold_starts", "ipopt from 8 random starts", "IPOPT, 8 random starts", OTHERS, 1.0),
    ("cold_starts", "ipopt from 1 random start", "IPOPT, 1 random start", OTHERS, 1.0),
    ("ssas", "eaik, 360 angles", "EAIK, 360 angles, no cut-in", OTHERS, 1e-3),
    ("ssas", "eaik, 50 angles", "EAIK, 50 angles, no cut-in", OTHERS, 1e-3),
    ("ssas", "py-opw-kinematics, 360 angles", "py-opw, 360 angles, no cut-in", OTHERS, 1e-3),
    ("ssas", "py-opw-kinematics, 50 angles", "py-opw, 50 angles, no cut-in", OTHERS, 1e-3),
    ("thesis", "floating_z, path, transfer and trajectory", "floating_z, timed motion", OURS, 1.0),
    ("thesis", "ncos, path, transfer and trajectory", "ncos, timed motion", OURS, 1.0),
    ("ncos", "ncos by ipopt, warm start included", "ncos by IPOPT", OURS, 1.0),
    ("ncos", "ncos by sqp, warm start included", "ncos by SQP", OURS, 1.0),
    (
        "ssas",
        "verified plan by ssas, with refused targets explained",
        "ssas, verified plan, batch",
        OURS,
        1e-3,
    ),
    ("ssas", "ssas, target with its 20 cut-in postures", "ssas with its cut-in, batch", OURS, 1e-3),
)


@dataclass(frozen=True)
class Picture:
    """A plot: its file in docs/pictures, its caption and how it is drawn."""

    file: str
    caption: str
    draw: Callable[[Results], Figure | None]


def number(value: float) -> str:
    """A figure for people: three digits, or whole."""
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:,.0f}"


def values_of(results: Results, subject: str) -> dict[str, float]:
    """The figures of a subject by name, without those that failed."""
    if subject not in results:
        return {}
    rows = rows_of(results[subject])
    return {row.name: row.value for row in rows if row.value is not None}


def draw_times(results: Results) -> Figure | None:
    """Time a target on a logarithmic axis, ours, the peers' and what the thesis claims."""
    bars = [
        (label, by * values_of(results, subject)[name], colour)
        for subject, name, label, colour, by in _TIMES
        if name in values_of(results, subject)
    ]
    if len(bars) < 3:
        return None
    bars.sort(key=lambda bar: bar[1])
    labels, heights, colours = zip(*bars, strict=True)
    figure = Figure(figsize=(9, 1.2 + 0.36 * len(bars)), layout="constrained")
    axes = figure.subplots()
    drawn = axes.barh(labels, heights, color=colours)
    axes.bar_label(drawn, [f"{number(value)} ms" for value in heights], padding=4, fontsize=9)
    axes.set_xscale("log")
    axes.set_xlim(min(heights) / 3, max(heights) * 12)
    axes.set_xlabel("time a target [ms], median")
    axes.grid(axis="x", alpha=0.25)
    return figure


def draw_large_batch(results: Results) -> Figure | None:
    """Time a target and peak memory against the size of the batch."""
    values = values_of(results, "large_batch")
    alone = [name.removesuffix(" targets") for name in values if name.endswith(" targets")]
    sizes = sorted(int(name) for name in alone if name.isdigit())
    sizes = [size for size in sizes if f"{size} targets, peak memory" in values]
    if len(sizes) < 2:
        return None
    figure = Figure(figsize=(9, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(sizes, [values[f"{size} targets"] for size in sizes], "o-", color=OURS)
    left.set_ylabel("time a target [µs]")
    right.plot(sizes, [values[f"{size} targets, peak memory"] for size in sizes], "o-", color=OURS)
    right.set_ylabel("peak memory [MiB], answer included")
    for axes in (left, right):
        axes.set_xscale("log")
        axes.set_ylim(bottom=0)
        axes.set_xlabel("targets in the batch")
        axes.grid(alpha=0.25)
    return figure


def draw_starts(results: Results) -> Figure | None:
    """Share of targets solved against time, cold by number of starts, and from the warm start."""
    values = values_of(results, "cold_starts")
    warm = values.get("ncos, warm start by ssas, verified plan")
    points = [
        (name.removesuffix(", solved"), values[name.removesuffix(", solved")], value)
        for name, value in values.items()
        if name.endswith(", solved") and name.removesuffix(", solved") in values
    ]
    if warm is None or not points:
        return None
    figure = Figure(figsize=(7, 3.6), layout="constrained")
    axes = figure.subplots()
    for label, time_ms, share in [*points, ("warm start by ssas", warm, 100.0)]:
        axes.plot(time_ms, share, "o", color=OURS if "ssas" in label else OTHERS)
        axes.annotate(label, (time_ms, share), textcoords="offset points", xytext=(6, -12))
    axes.set_xscale("log")
    axes.set_ylim(-5, 108)
    axes.set_xlabel("time a target [ms], median")
    axes.set_ylabel("targets solved [%]")
    axes.margins(x=0.3)
    axes.grid(alpha=0.25)
    return figure


def draw_savings(results: Results) -> Figure | None:
    """Effort saved by planning batches as a whole, by the order and by a symmetric tool."""
    values = values_of(results, "savings")
    if not values:
        return None
    figure = Figure(figsize=(9, 1.2 + 0.36 * len(values)), layout="constrained")
    axes = figure.subplots()
    drawn = axes.barh(list(values)[::-1], list(values.values())[::-1], color=OURS)
    axes.bar_label(drawn, fmt="%.3g %%", padding=4, fontsize=9)
    axes.set_xlabel("effort saved [%], median of the batches")
    axes.margins(x=0.15)
    axes.grid(axis="x", alpha=0.25)
    return figure


PICTURES: Final = (
    Picture("bench_times.png", "Time a target on a logarithmic axis", draw_times),
    Picture("bench_large_batch.png", "Time a target and memory by size of batch", draw_large_batch),
    Picture("bench_starts.png", "Targets solved against time, cold and warm", draw_starts),
    Picture("bench_savings.png", "Effort saved", draw_savings),
)
