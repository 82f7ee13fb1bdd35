"""What the documents say is compared with the code, and what they tell people to type is run."""

import dataclasses
import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from app.commands.demo import MOST_ERROR_M
from app.commands.plan_table import HEADINGS, MEASURED_HEADINGS, plan_rows
from app.errors import STATUSES
from app.guards.access import REVOKED
from app.routers.link import SERVICE_FAULT
from app.schemas.demo_request import demo_request
from app.services.plans.selecting import selection_to_json
from app.services.plans.wire import parse_request, plan_to_wire, problem_from_wire
from app.services.robots import links
from app.services.robots.execution_record import EXECUTION_ERROR_CODES
from app.settings import Settings
from bench.page import PAGE, PICTURE_FOLDER, page
from bench.pictures import PICTURES
from bench.results import read
from hardware import exceptions
from solver import Options, solve
from solver.comparison.registry import SCENARIOS
from solver.methods.registry import METHODS
from solver.problem.options import RANGES
from solver.problem.solution import REASON_CODES

ROOT = Path(__file__).parents[2]
DOCUMENTS = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]


def rows(document: str, section: str = "") -> list[list[str]]:
    """The cells of every table row in a document, or in a section of it, without code marks."""
    text = (ROOT / document).read_text(encoding="utf-8")
    if section:
        text = text.partition(f"## {section}\n")[2].partition("\n## ")[0]
        assert text, section
    lines = text.splitlines()
    tables = [line for line in lines if line.startswith("| ")]
    return [[cell.strip().strip("`") for cell in line.strip("|").split("|")] for line in tables]


def fences(document: str, language: str) -> list[str]:
    text = (ROOT / document).read_text(encoding="utf-8")
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_somewhere(document: Path) -> None:
    for link in re.findall(r"\]\(([^)#]+)", document.read_text(encoding="utf-8")):
        if not link.startswith("http"):
            assert (document.parent / link).exists(), link


def test_options_are_documented_with_their_defaults_and_ranges() -> None:
    table = {row[0]: row for row in rows("docs/options.md")[2:]}
    assert list(table) == [field.name for field in dataclasses.fields(Options)]
    for field in dataclasses.fields(Options):
        default, written = table[field.name][1:3]
        if field.default is not None:
            assert default == str(field.default).lower(), field.name
        if field.name in RANGES:
            lowest, highest = RANGES[field.name]
            assert written == f"{lowest:g} to {highest:g}", field.name


def test_methods_are_documented() -> None:
    documented = {row[0] for row in rows("docs/task_definition.md")}
    assert set(METHODS) <= documented


def test_scenarios_are_documented() -> None:
    table = [row[:2] for row in rows("docs/scenarios.md", "Scenarios")[2:]]
    assert table == [[row.name, row.title] for row in SCENARIOS.values()]


def test_planned_share_of_the_model_tree_is_documented() -> None:
    contest = SCENARIOS["kac-v"].contest(["ssas"])
    (ssas,) = contest.entrants
    count = len(contest.target_ids)
    planned = sum(contest.account("ssas", k, ssas.solve(k)).solved for k in range(count))
    text = " ".join((ROOT / "docs/scenarios.md").read_text(encoding="utf-8").split())
    assert f"{planned} of {count} targets within twice the reach" in text
    assert f"planned, {100 * planned / count:.0f} %" in text


def test_example_of_the_5_8_pattern_is_a_request_with_an_answer() -> None:
    (example,) = fences("docs/task_definition.md", "json")
    assert json.loads(selection_to_json(example.encode()))["targets"]


def test_reason_codes_are_documented() -> None:
    documented = [row[0] for row in rows("docs/errors.md", "Reasons of infeasible targets")]
    assert documented[2:] == list(REASON_CODES)


def test_execution_error_codes_are_documented() -> None:
    documented = [row[0] for row in rows("docs/errors.md", "Execution errors")]
    assert set(EXECUTION_ERROR_CODES) <= set(documented)


def test_worker_codes_are_documented() -> None:
    documented = [row[0] for row in rows("docs/errors.md", "Faults and errors of the worker")]
    classes = [entry for entry in vars(exceptions).values() if isinstance(entry, type)]
    codes = {entry.code for entry in classes if issubclass(entry, exceptions.HardwareError)}
    assert len(codes) > 15
    assert set(documented[2:]) == codes - {exceptions.HardwareError.code}


def test_http_errors_are_documented() -> None:
    documented = {(row[0], row[1]) for row in rows("docs/errors.md", "HTTP errors")[2:]}
    raised = {
        found
        for file in (ROOT / "app").rglob("*.py")
        for found in re.findall(
            r'(?:ProblemError|problem_response)\(\s*(\d{3}),\s*"(\w+)"', file.read_text()
        )
    }
    raised |= {
        (str(status), code)
        for refusal, status in STATUSES.items()
        for file in (ROOT / "app").rglob("*.py")
        for code in re.findall(rf'\b{refusal.__name__}\(\s*"(\w+)"', file.read_text())
    }
    assert len(raised) >= 20
    assert raised <= documented


def test_close_codes_are_documented() -> None:
    documented = {row[0] for row in rows("docs/errors.md", "Close codes of the robot link")[2:]}
    used = {
        links.NOT_A_MESSAGE, links.UNKNOWN_ROBOT, links.SILENT, links.HAS_A_WORKER,
        links.WRONG_WORKER, SERVICE_FAULT, REVOKED,
    }  # fmt: skip
    assert documented == set(map(str, used))


def test_settings_are_documented_with_their_defaults() -> None:
    documented = {row[0]: row[1] for row in rows("docs/settings.md")[2:]}
    assert documented == {
        f"PRUNUS_{name.upper()}": str(field.default)
        for name, field in Settings.model_fields.items()
    }


def test_python_example_of_the_readme_plans_its_target() -> None:
    (example,) = [text for text in fences("README.md", "python") if "from solver" in text]
    command = [sys.executable, "-c", example]
    printed = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout
    assert printed.startswith("1 planned 0.128")


def test_command_line_of_the_readme_plans_data_set_3(tmp_path: Path) -> None:
    (line,) = [text for text in fences("README.md", "sh") if "prunus plan" in text]
    words = shlex.split(line)
    assert words[0] == ".venv/bin/prunus"
    arguments = [str(tmp_path / "plan.json") if word == "plan.json" else word for word in words[1:]]
    subprocess.run([sys.executable, "-m", "app", *arguments], check=True, cwd=ROOT)
    assert json.loads((tmp_path / "plan.json").read_text())["summary"]["planned"] == 5


def test_curl_body_of_the_readme_is_a_request_that_is_planned() -> None:
    (line,) = [text for text in fences("README.md", "sh") if text.startswith("curl")]
    body = shlex.split(line)[-1]
    assert solve(problem_from_wire(parse_request(body.encode()))).planned == 1


def test_table_of_the_readme_is_what_the_demo_computes() -> None:
    """To the digits printed; the measured errors only by their size."""
    problem = problem_from_wire(parse_request(json.dumps(demo_request()).encode()))
    computed = plan_rows(plan_to_wire(solve(problem), "0"))
    headings = [*HEADINGS, *MEASURED_HEADINGS]
    printed = [row for row in rows("README.md") if len(row) == len(headings)]
    assert printed[0] == headings
    for row in printed[2:]:
        for error_mm in row[len(HEADINGS) :]:
            assert 0 < float(error_mm) < MOST_ERROR_M * 1000
    assert [row[: len(HEADINGS)] for row in printed[2:]] == list(map(list, computed))
    assert printed == rows("docs/pictures/table.md")


def test_demo_request_is_the_example() -> None:
    example = json.loads((ROOT / "openapi/examples/data_set_3.json").read_text())
    assert example == demo_request()


def test_page_of_the_benchmarks_is_that_of_the_results() -> None:
    results = read()
    assert results
    text = page(results)
    assert PAGE.read_text(encoding="utf-8") == text
    shown = {picture.file for picture in PICTURES if picture.file in text}
    assert shown == {file.name for file in PICTURE_FOLDER.glob("bench_*.png")}
