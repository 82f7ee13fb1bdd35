"""Comparisons in one process: which contest is meant, and the whole run as bytes."""

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import orjson

from app.reports.html import comparison_to_html
from app.reports.json_values import comparison_to_wire
from app.services.plans.wire import parse_request, problem_from_wire
from solver import UnknownScenario
from solver.comparison.contest import Contest
from solver.comparison.registry import SCENARIOS, find_scenario
from solver.comparison.run import run_contest
from solver.comparison.scenarios.own_request import request_contest

REQUEST_SUFFIX = ".json"


@dataclass(frozen=True)
class ComparisonOrder:
    """What a comparison was asked for, made to be sent to another process.

    Attributes:
        scenario: a name of the registry.
        methods: the entrants, or None for the scenario's own choice.
        repeats: see `solver.comparison.run.run_contest`.
        progress_file: where the process tells how far it is; see `read_progress`.
    """

    scenario: str
    methods: tuple[str, ...] | None
    repeats: int | None
    progress_file: Path


def prepare(scenario: str, methods: Sequence[str] | None) -> Contest:
    """The contest of a name in the registry, or of a file with the body of POST /v1/plans.

    Raises:
        UnknownScenario: neither.
        UnknownEntrant: a method is none of the contest's.
        OSError: the file cannot be read.
        pydantic.ValidationError: it is not JSON, or not the schema's structure.
        InvalidProblem: it makes no sense.
    """
    if scenario in SCENARIOS:
        return find_scenario(scenario).contest(methods)
    file = Path(scenario)
    if file.suffix.lower() == REQUEST_SUFFIX or file.is_file():
        problem = problem_from_wire(parse_request(file.read_bytes()))
        return request_contest(problem, file.stem, methods)
    raise UnknownScenario(scenario, known=tuple(SCENARIOS))


def compare_to_bytes(order: ComparisonOrder) -> tuple[bytes, str]:
    """The comparison as JSON and as an HTML page; runs in a solver process."""
    from app.reports.pictures import draw_pictures

    contest = prepare(order.scenario, order.methods)
    comparison = run_contest(
        contest,
        repeats=order.repeats,
        progress=lambda done, total: _tell(order.progress_file, done, total),
    )
    page = comparison_to_html(comparison, draw_pictures(contest, comparison))
    return orjson.dumps(comparison_to_wire(comparison)), page


def _tell(file: Path, done: int, total: int) -> None:
    # A comparison must not fail because nobody can see how far it is.
    with contextlib.suppress(OSError):
        written = file.with_suffix(".new")
        written.write_text(f"{done} {total}", encoding="utf-8")
        written.replace(file)


def read_progress(file: Path) -> tuple[int, int] | None:
    """How many rows of how many a running comparison has; None before the first."""
    try:
        done, total = file.read_text(encoding="utf-8").split()
    except OSError:
        return None
    return int(done), int(total)
