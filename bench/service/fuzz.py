"""`python -m bench.service.fuzz`: what the API description allows, and what it forbids, is sent.

Schemathesis makes the requests from `/openapi.json` of a live server of its own and runs every
check that it has on every answer. Three of its checks are told what this service means:

- `positive_data_acceptance` takes a 422. A JSON schema cannot say all that a request must be (a
  target beside an unknown robot, a lower limit above the upper one), so data that the schema
  allows may well make no sense.
- `not_a_server_error` takes a 503, as a status; `only_expected_503` then takes only the codes in
  `EXPECTED_503`. They tell the truth here: no robot worker is connected, and the fuzzer fills the
  lines of jobs and comparisons. Every other 5xx, a 507 too, is a finding.
- `use_after_free` is left out for jobs: to delete a job is to cancel it, and what it solved until
  then stays readable. Frames and leases that are deleted are gone, and are held to it.
"""

import argparse
import sys
import time
import urllib.request
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import orjson
from schemathesis import Case, CheckContext, Response, openapi
from schemathesis.checks import CHECKS
from schemathesis.config import SchemathesisConfig
from schemathesis.engine import Status, from_schema
from schemathesis.engine.events import FatalError, NonFatalError, ScenarioFinished
from schemathesis.engine.recorder import ScenarioRecorder

from app.schemas.problem_details import MEDIA_TYPE
from bench.measure import Row, row
from bench.registry import FUZZING
from bench.results import FOLDER, write_and_print
from bench.service.load import live_server
from solver.comparison.machine import machine

EXPECTED_503: Final = ("no_worker", "jobs_full", "comparisons_full")
CASES: Final = 2000
PHASES: Final = ("examples", "coverage", "fuzzing", "stateful")
ANSWER_S: Final = 120.0
UNLIMITED: Final[Mapping[str, str]] = {
    "PRUNUS_RATE_LIMIT_PER_S": "1000000",
    "PRUNUS_RATE_BURST": "1000000",
}
"""Settings of the server: answers of 429 say nothing about the routes."""


@dataclass
class Fuzzed:
    """What came of it.

    Attributes:
        answers: how often each route gave each status, by route ("POST /v1/plans").
        findings: what went wrong, each kind once with a request that shows it.
    """

    answers: dict[str, Counter[int]] = field(default_factory=dict)
    findings: dict[tuple[str, str, str], str] = field(default_factory=dict)


def main() -> int:
    """Prints the answers of each route and writes bench/results/fuzzing.json; 1 on a finding."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=CASES, help="fuzzed requests of a route")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--phases", nargs="+", choices=PHASES, default=PHASES)
    parser.add_argument("--output", type=Path, default=FOLDER)
    given = parser.parse_args()
    about, began = machine(), time.perf_counter()
    with live_server(UNLIMITED) as (_, port):
        url = f"http://127.0.0.1:{port}"
        fuzzed = fuzz(url, given.cases, seed=given.seed, phases=given.phases)
    for route, statuses in sorted(fuzzed.answers.items()):
        print(f"{route}: {statuses.total()} requests, {dict(sorted(statuses.items()))}")
    for (route, check, title), request in fuzzed.findings.items():
        print(f"\nFINDING {route}, {check}: {title}\n{request}")
    rows = [_row(fuzzed, given.cases)]
    quick = given.cases < CASES or set(given.phases) != set(PHASES)
    elapsed_s = time.perf_counter() - began
    return write_and_print(given.output, FUZZING, rows, about, quick=quick, elapsed_s=elapsed_s)


def _row(fuzzed: Fuzzed, cases: int) -> Row:
    total = sum(statuses.total() for statuses in fuzzed.answers.values())
    unavailable = sum(
        count
        for statuses in fuzzed.answers.values()
        for status, count in statuses.items()
        if status == 503
    )
    note = f"{total} requests of {len(fuzzed.answers)} routes, {unavailable} answered with a 503"
    name = f"findings of every check, {cases:,} cases a route"
    return row(name, len(fuzzed.findings), "", at_most=0, note=note)


def fuzz(
    url: str, cases: int, *, seed: int = 1, phases: tuple[str, ...] | list[str] = PHASES
) -> Fuzzed:
    """Fuzzes every route of the service there.

    Args:
        url: of the service, without a path.
        cases: so many requests of each route are made up in the fuzzing phase; the number in
            the others follows from the description.
        seed: the same one makes the same requests.
        phases: of `PHASES`.
    """
    config = SchemathesisConfig.from_dict({**fuzz_config(cases, seed, phases), "base-url": url})
    fuzzed = Fuzzed()
    CHECKS.register(only_expected_503)
    try:
        schema = openapi.from_dict(_description(url), config=config)
        for event in from_schema(schema).execute():
            if isinstance(event, ScenarioFinished):
                _add(fuzzed, event.recorder)
            elif isinstance(event, NonFatalError):
                fuzzed.findings[event.label, "error", type(event.value).__name__] = str(event.value)
            elif isinstance(event, FatalError):
                raise event.exception
    finally:
        CHECKS.unregister(only_expected_503.__name__)
    return fuzzed


def only_expected_503(_: CheckContext, response: Response, case: Case[Any]) -> None:
    """A check of Schemathesis: a 503 is a problem with one of the codes in `EXPECTED_503`."""
    if response.status_code != 503:
        return
    assert response.headers["content-type"] == [MEDIA_TYPE], "the 503 is no problem"
    code = orjson.loads(response.content)["type"].rpartition(":")[2]
    assert code in EXPECTED_503, f"a 503 with the code {code}"


def _description(url: str) -> dict[str, Any]:
    with urllib.request.urlopen(f"{url}/openapi.json") as answer:
        document: dict[str, Any] = orjson.loads(answer.read())
    return document


def fuzz_config(cases: int, seed: int, phases: tuple[str, ...] | list[str]) -> dict[str, Any]:
    """What Schemathesis is told; the module says why."""
    accepted = ["2xx", "3xx", "401", "403", "404", "409", "422", "429", "5xx"]
    return {
        "seed": seed,
        "continue-on-failure": True,
        "request-timeout": ANSWER_S,
        "generation": {"max-examples": cases, "database": "none"},
        "phases": {phase: {"enabled": phase in phases} for phase in PHASES},
        "checks": {
            "positive_data_acceptance": {"expected-statuses": accepted},
            "not_a_server_error": {"expected-statuses": ["2xx", "3xx", "4xx", "503"]},
        },
        "operations": [{"include-tag": "jobs", "checks": {"use_after_free": {"enabled": False}}}],
    }


def _add(fuzzed: Fuzzed, recorder: ScenarioRecorder) -> None:
    for key, interaction in recorder.interactions.items():
        route = recorder.cases[key].value.operation.label
        status = 0 if interaction.response is None else interaction.response.status_code
        fuzzed.answers.setdefault(route, Counter())[status] += 1
    for key, checks in recorder.checks.items():
        route = recorder.cases[key].value.operation.label
        for check in checks:
            if check.status is Status.FAILURE and check.failure_info is not None:
                failure = check.failure_info.failure
                found = f"{failure.message}\n{check.failure_info.code_sample}"
                fuzzed.findings.setdefault((route, check.name, failure.title), found)


if __name__ == "__main__":
    sys.exit(main())
