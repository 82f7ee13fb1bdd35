"""The command `prunus compare`."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from app.commands.failing import fail

if TYPE_CHECKING:
    from solver.comparison.contest import Contest
    from solver.comparison.result import Comparison

DEFAULT_FOLDER = Path("prunus-compare")
MOST_FAULTS_SHOWN = 5
SHOWN_HEADINGS = (
    "method", "solved", "time median", "cold median", "increase % median", "increase % max",
)  # fmt: skip


def compare(
    scenario: Annotated[
        str,
        typer.Argument(
            metavar="SCENARIO", help="A scenario's name, or a file with the body of POST /v1/plans."
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="FOLDER", help="Where the report goes [prunus-compare/NAME]."
        ),
    ] = None,
    methods: Annotated[
        str | None,
        typer.Option(metavar="A,B,...", help="Which methods; default: the scenario's own choice."),
    ] = None,
    repeats: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=1000,
            help="Timed calls of each method at each target; default: as many as fit into a "
            "minute, 25 at most.",
        ),
    ] = None,
    as_json: Annotated[
        bool,
        typer.Option(
            "--json", help="Print one JSON object and nothing else; no report without --output."
        ),
    ] = False,
) -> None:
    """Compare methods on a scenario: report.html, .md, .csv, .json and pictures in a folder.

    Scenarios: data-set-1 and others; an unknown name is answered with all of them. Exits with 0
    when there is a report, failed methods or not, and with 2 on bad input, before anything is run.
    """
    contest = _prepared(scenario, methods)
    folder = output
    if folder is None and not as_json:
        folder = DEFAULT_FOLDER / contest.scenario
    if folder is not None:
        _check(folder)
    comparison = _run(contest, repeats, quiet=as_json)
    if folder is not None:
        _write(folder, contest, comparison)
    if as_json:
        import orjson

        from app.reports.json_values import comparison_to_wire

        sys.stdout.write(orjson.dumps(comparison_to_wire(comparison)).decode() + "\n")
    else:
        _print(comparison)
        typer.echo(f"{folder}/report.html")


def _prepared(scenario: str, methods: str | None) -> "Contest":
    from pydantic import ValidationError

    from app.schemas.faults import structural_faults
    from app.services.comparisons.running import prepare
    from solver import InvalidProblem, SolverError

    names = None if methods is None else [name.strip() for name in methods.split(",")]
    try:
        return prepare(scenario, names)
    except OSError as error:
        fail(f"{error.filename}: {error.strerror}")
    except ValidationError as error:
        faults = [f"{fault.pointer}: {fault.detail}" for fault in structural_faults(error)]
        fail(_one_line(scenario, faults))
    except InvalidProblem as error:
        fail(_one_line(scenario, [f"{fault.pointer}: {fault.detail}" for fault in error.faults]))
    except SolverError as error:
        fail(str(error))


def _one_line(file: str, faults: list[str]) -> str:
    shown = "; ".join(faults[:MOST_FAULTS_SHOWN])
    more = len(faults) - MOST_FAULTS_SHOWN
    return f"{file}: {shown}" + (f"; and {more} more" if more > 0 else "")


def _check(folder: Path) -> None:
    from app.reports.folder import check_folder

    try:
        check_folder(folder)
    except OSError as error:
        fail(f"{folder}: {error.strerror}")


def _write(folder: Path, contest: "Contest", comparison: "Comparison") -> None:
    from app.reports.folder import report_files, write_report

    files = report_files(contest, comparison)
    try:
        write_report(folder, files)
    except OSError as error:
        fail(f"{folder}: {error.strerror}")


def _run(contest: "Contest", repeats: int | None, *, quiet: bool) -> "Comparison":
    from solver.comparison.run import run_contest

    with _progress_bar(contest.scenario, quiet=quiet) as progress:
        return run_contest(contest, repeats=repeats, progress=progress)


@contextmanager
def _progress_bar(name: str, *, quiet: bool) -> Iterator[Callable[[int, int], None] | None]:
    """A bar on standard error; none where nobody would see it move."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(escape(name), total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)


def _print(comparison: "Comparison") -> None:
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    from app.reports.tables import answer_table, time_table

    table = Table(box=SIMPLE_HEAD, title=Text(comparison.title))
    for place, heading in enumerate(SHOWN_HEADINGS):
        justify: Literal["left", "right"] = "right" if place else "left"
        table.add_column(Text(heading), justify=justify, no_wrap=not place)
    answers, times = answer_table(comparison), time_table(comparison)
    for answer, cost in zip(answers.rows, times.rows, strict=True):
        cells = dict(zip(times.headings, cost, strict=True))
        cells |= dict(zip(answers.headings, answer, strict=True))
        table.add_row(*(Text(cells.get(heading, "")) for heading in SHOWN_HEADINGS))
    console = Console()
    console.print(table)
    for finding in comparison.findings:
        console.print(Text(finding))
