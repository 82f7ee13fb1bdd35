"""What a comparison found: a row a target and method, and a summary a method. All frozen.

A figure that does not exist is None: that of a failure, or one with nothing to compare it to.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Row:
    """One method at one target.

    Attributes:
        target_id: the target.
        method: the method.
        solved: whether the verifier accepts the answer.
        status: "planned", or the code of the reason why there is no answer.
        detail: a sentence for people; empty when there is nothing to say.
        index: effort or index J, recomputed from the posture, in the comparison's unit.
        time_s: median of the timed calls with the warm start, where the method has one [s].
        repeats: how many calls that median is of.
        cold_time_s: the same without the warm start [s]; None where the method has none.
        cold_repeats: how many calls that median is of.
        cold_solved: whether the verifier accepts the answer of the cold start.
        cold_index: its index.
        cold_detail: a sentence about it; empty when there is nothing to say.
        iterations: what the method says it spent.
        residuals: what the verifier recomputed, by name with its unit.
        margin: smallest distance of a joint to its limit [rad, or m where that joint slides].
        joints: the posture at the target [rad or m].
        gap: (index - best) / |best|, the best being the least index of any method at this target.
        increase_percent: 100 (index - reference's) / |reference's|; None for the reference itself.
        time_reduction_percent: 100 (1 - time / reference's); None for the reference itself.
        published_index: what the document prints.
        published_time_s: what the document prints [s].
        published_difference_percent: 100 (index - published index) / |published index|.
        published_increase_percent: `increase_percent` from the document's figures.
        published_time_reduction_percent: `time_reduction_percent` from the document's figures.
    """

    target_id: str
    method: str
    solved: bool
    status: str
    time_s: float
    repeats: int
    detail: str = ""
    index: float | None = None
    cold_time_s: float | None = None
    cold_repeats: int | None = None
    cold_solved: bool | None = None
    cold_index: float | None = None
    cold_detail: str = ""
    iterations: int | None = None
    residuals: Mapping[str, float] = field(default_factory=dict)
    margin: float | None = None
    joints: tuple[float, ...] | None = None
    gap: float | None = None
    increase_percent: float | None = None
    time_reduction_percent: float | None = None
    published_index: float | None = None
    published_time_s: float | None = None
    published_difference_percent: float | None = None
    published_increase_percent: float | None = None
    published_time_reduction_percent: float | None = None


@dataclass(frozen=True)
class Spread:
    """Median, 95 % quantile and maximum over targets; None where it falls on a failure."""

    median: float | None
    q95: float | None
    max: float | None


@dataclass(frozen=True)
class MethodSummary:
    """One method over all targets.

    Attributes:
        method: the method.
        summary: a line for people.
        targets: how many there are.
        solved: how many of them the verifier accepts.
        solved_share: solved / targets.
        time_s: over all targets, failures with the time they took [s].
        charged_time_s: mean time with every failure charged as in `charged_time` [s].
        cold_time_s: of cold starts, over all targets [s]; None where the method has none.
        cold_solved: how many cold starts the verifier accepts.
        gap: over all targets, a failure being worse than every other.
        increase_percent: the same, over targets that the reference solves.
        not_compared: how many targets the reference does not solve.
        time_reduction_percent: median over targets that the method and the reference solve.
        published_time_s: median of what the document prints [s].
        published_increase_percent: the same of its increases.
        published_time_reduction_percent: the same of its time reductions.
        smallest_margin: of the solved targets [rad, or m where that joint slides].
        iterations: over all targets where the method says them; None where it never does.
        largest_residuals: of the solved targets, by name with its unit.
        largest_published_difference_percent: largest |published_difference_percent|.
    """

    method: str
    summary: str
    targets: int
    solved: int
    solved_share: float
    time_s: Spread
    charged_time_s: float
    cold_time_s: Spread | None
    cold_solved: int | None
    gap: Spread
    increase_percent: Spread | None
    not_compared: int
    time_reduction_percent: float | None
    published_time_s: float | None
    published_increase_percent: float | None
    published_time_reduction_percent: float | None
    smallest_margin: float | None
    iterations: Spread | None
    largest_residuals: Mapping[str, float]
    largest_published_difference_percent: float | None


@dataclass(frozen=True)
class Comparison:
    """A contest that was run.

    Attributes:
        scenario, title, origin, index_name, notes, published_on, reference, seeds: the contest's.
        machine: processor, system, versions, load and date; see `solver.comparison.machine`.
        repeats: the most timed calls of one method at one target.
        findings: what the answers say about the scenario's question, a sentence each.
        rows: target by target, the methods of each in the contest's order.
        summaries: one a method, in the contest's order.
    """

    scenario: str
    title: str
    origin: str
    index_name: str
    notes: tuple[str, ...]
    published_on: str
    reference: str
    seeds: tuple[int, ...]
    machine: Mapping[str, Any]
    repeats: int
    findings: tuple[str, ...]
    rows: tuple[Row, ...]
    summaries: tuple[MethodSummary, ...]


def percent_above(value: float | None, base: float | None) -> float | None:
    """100 (value - base) / |base|; None where one is missing or the base is zero."""
    if value is None or base is None or base == 0:
        return None
    return 100 * (value - base) / abs(base)


def percent_less(time_s: float | None, base_s: float | None) -> float | None:
    """How much less time, in per cent of the base's; None where one is missing or zero."""
    above = percent_above(time_s, base_s)
    return None if above is None else -above
