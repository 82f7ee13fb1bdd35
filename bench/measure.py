"""Measuring: several runs, ratios within one run, median and quantiles. Never a minimum."""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

QUANTILES = {"median": 0.5, "q90": 0.9, "q99": 0.99, "max": 1.0}


@dataclass(frozen=True)
class Row:
    """One line of a report.

    Attributes:
        name: what was measured.
        value: the figure; None where there is none, which `note` explains.
        unit: of value and spread.
        runs: how often it was measured: runs of a timing, targets or batches of a distribution.
        wanted: the figure wanted, as in "<= 0.6"; empty where the figure is only reported.
        reached: whether the value is as wanted; None where nothing is wanted.
        spread: median and quantiles, by name.
        note: a sentence more.
    """

    name: str
    value: float | None
    unit: str
    runs: int
    wanted: str = ""
    reached: bool | None = None
    spread: Mapping[str, float] | None = None
    note: str = ""


def row(
    name: str,
    value: float | Sequence[float],
    unit: str,
    *,
    runs: int | None = None,
    at_most: float | None = None,
    at_least: float | None = None,
    note: str = "",
) -> Row:
    """A line from one figure or from many, whose median counts.

    Args:
        name: what was measured.
        value: a figure, or one for each run.
        unit: of it.
        runs: how many runs a single figure comes from.
        at_most: the figure wanted, if smaller is better.
        at_least: the figure wanted, if larger is better.
        note: a sentence more.
    """
    spread = None
    if not isinstance(value, int | float):
        runs, spread = len(value), spread_of(value)
        value = spread.get("median", math.nan)
    value = float(value)
    known = math.isfinite(value)
    wanted, reached = "", None
    if at_most is not None:
        wanted, reached = f"<= {at_most:g}", known and value <= at_most
    if at_least is not None:
        wanted, reached = f">= {at_least:g}", known and value >= at_least
    figure = value if known else None
    return Row(name, figure, unit, runs or 1, wanted, reached, spread or None, note)


def failed(name: str, unit: str, why: str, wanted: str = "") -> Row:
    """A line for what could not be measured; it stays in the table."""
    return Row(name, None, unit, 0, wanted, False if wanted else None, None, why)


def spread_of(values: Sequence[float]) -> dict[str, float]:
    """Median, quantiles and maximum, by name; empty for no values or where one is not finite."""
    if len(values) == 0 or not all(math.isfinite(value) for value in values):
        return {}
    levels = np.quantile(values, list(QUANTILES.values()))
    return {name: float(level) for name, level in zip(QUANTILES, levels, strict=True)}


def times_of(action: Callable[[], object], runs: int) -> list[float]:
    """Durations of an action [s], after one that is not counted."""
    return alternating({"": action}, runs)[""]


def alternating(actions: Mapping[str, Callable[[], object]], runs: int) -> dict[str, list[float]]:
    """Durations of several actions [s], turn and turn about, so that a slow spell hits them all."""
    times: dict[str, list[float]] = {name: [] for name in actions}
    for count in range(runs + 1):
        for name, action in actions.items():
            began = time.perf_counter()
            action()
            elapsed = time.perf_counter() - began
            if count:
                times[name].append(elapsed)
    return times


def scaled(times: Sequence[float], by: float) -> list[float]:
    """Durations in another unit or for one of many: each times `by`."""
    return [value * by for value in times]


def ratios(slow: Sequence[float], fast: Sequence[float]) -> list[float]:
    """How many times faster, run by run."""
    return [a / b for a, b in zip(slow, fast, strict=True)]
