"""docs/comparisons.md and the example reports against the code."""

import json
import shlex
from dataclasses import fields
from pathlib import Path

import pytest
import typer.main
from pydantic import TypeAdapter

from app.commands.cli import cli
from app.reports.folder import OWN_FILES
from app.reports.tables import ROW_COLUMNS
from app.schemas.comparison_results import ComparisonResultAnswer
from app.schemas.comparisons import ComparisonRequest
from solver.comparison.registry import SCENARIOS
from solver.comparison.result import Comparison, MethodSummary, Row
from solver.comparison.run import MOST_REPEATS
from solver.comparison.summary import FAILURE_CHARGE
from tests.docs.test_documents import ROOT, fences, rows

DOCUMENT = "docs/comparisons.md"
TEXT = " ".join((ROOT / DOCUMENT).read_text(encoding="utf-8").split())
REPORTS = ("strawberry", "data-set-3")


def test_every_field_of_a_row_is_explained_with_its_heading() -> None:
    table = rows(DOCUMENT, "Rows")[2:]
    assert [cells[0] for cells in table] == [entry.name for entry in fields(Row)]
    headings = {name: column.heading for column in ROW_COLUMNS for name in column.fields}
    assert {cells[0]: cells[1] for cells in table} == {
        entry.name: headings.get(entry.name, "") for entry in fields(Row)
    }
    assert all(cells[2] for cells in table)


def test_every_field_of_a_summary_is_explained() -> None:
    table = rows(DOCUMENT, "Summaries")[2:]
    assert [cells[0] for cells in table] == [entry.name for entry in fields(MethodSummary)]


def test_every_field_of_a_comparison_is_named() -> None:
    for entry in fields(Comparison):
        assert f"`{entry.name}`" in TEXT, entry.name


def test_numbers_in_words_are_the_codes() -> None:
    assert f"{MOST_REPEATS} at most" in TEXT
    assert f"costs {FAILURE_CHARGE:g} times the longest time" in TEXT


def test_options_of_the_command_are_documented() -> None:
    command = typer.main.get_command(cli).commands["compare"]  # type: ignore[attr-defined]
    written = {name.strip(" `") for cells in rows(DOCUMENT)[2:7] for name in cells[0].split(",")}
    options = {name for parameter in command.params for name in parameter.opts} - {"--help"}
    assert written == {"SCENARIO", *options} - {"scenario"}


def test_commands_and_bodies_in_the_documents_are_good_ones() -> None:
    lines = [
        line
        for document in (DOCUMENT, "README.md")
        for fence in fences(document, "sh")
        for line in fence.splitlines()
        if "prunus compare" in line
    ]
    assert len(lines) == 3
    for line in lines:
        scenario = shlex.split(line)[2]
        assert scenario in SCENARIOS or (ROOT / scenario).is_file()
    (curl,) = [line for line in fences(DOCUMENT, "sh") if line.startswith("curl")]
    body = ComparisonRequest.model_validate_json(shlex.split(curl)[-1])
    assert body.scenario in SCENARIOS


@pytest.mark.parametrize("name", REPORTS)
def test_example_reports_are_whole_and_have_todays_form(name: str) -> None:
    folder = ROOT / "docs" / "reports" / name
    written = {entry.name for entry in folder.iterdir()}
    assert written <= set(OWN_FILES)
    assert {"report.html", "report.md", "report.csv", "report.json", "poses.png"} <= written
    body = (folder / "report.json").read_bytes()
    TypeAdapter(ComparisonResultAnswer).validate_json(body, strict=True)
    document = json.loads(body)
    assert document["scenario"] == name
    contest = SCENARIOS[name].contest(None)
    assert list(dict.fromkeys(row["target_id"] for row in document["rows"])) == list(
        contest.target_ids
    )
    assert [summary["method"] for summary in document["summaries"]] == [
        entrant.name for entrant in contest.entrants
    ]


def test_make_reports_makes_the_reports_that_are_there() -> None:
    lines = [
        line for line in (ROOT / "Makefile").read_text().splitlines() if "prunus compare" in line
    ]
    assert {Path(shlex.split(line)[-1]).name for line in lines} == set(REPORTS)
    assert {entry.name for entry in (ROOT / "docs" / "reports").iterdir()} == set(REPORTS)
