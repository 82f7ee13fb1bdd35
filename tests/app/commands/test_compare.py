"""`prunus compare`: reports of scenarios and of one's own requests, and what it refuses."""

import csv
import io
import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from app.commands import compare as compare_command
from app.commands.cli import cli
from app.reports.folder import OWN_FILES
from solver.comparison.contest import Contest, Entrant
from tests.app.commands.test_cli import run
from tests.app.conftest import EXAMPLE
from tests.solver.comparison.contests import BEST, RAISES, WRONG, small_contest

QUICK = ("--repeats", "1")


def invoke(*arguments: str) -> Result:
    return CliRunner().invoke(cli, ["compare", *arguments])


@pytest.fixture
def contests(monkeypatch: pytest.MonkeyPatch) -> list[Contest]:
    """The small contest in place of every scenario; empty it, and nothing may be run."""
    made = [small_contest(BEST, WRONG, RAISES)]
    monkeypatch.setattr(compare_command, "_prepared", lambda *_: made[0])
    return made


def test_json_is_one_object_on_standard_output_and_nothing_else(tmp_path: Path) -> None:
    finished = run("compare", "strawberry", "--json", "--methods", "as,ncos", *QUICK)
    assert finished.returncode == 0, finished.stderr
    assert finished.stderr == ""
    document = json.loads(finished.stdout)
    assert finished.stdout.count("\n") == 1
    assert document["scenario"] == "strawberry"
    assert len(document["rows"]) == 2 * 20
    first = document["rows"][0]
    assert {"target_id", "method", "solved", "index", "time_s", "published_index"} <= set(first)
    assert first["method"] == "as"


def test_report_of_a_request_of_ones_own(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    finished = run("compare", str(EXAMPLE), "-o", str(folder), "--methods", "as,ncos", *QUICK)
    assert finished.returncode == 0, finished.stderr
    assert {entry.name for entry in folder.iterdir()} == set(OWN_FILES)
    assert {entry.name for entry in tmp_path.iterdir()} == {"out"}
    assert finished.stdout.splitlines()[-1] == f"{folder}/report.html"
    document = json.loads((folder / "report.json").read_text())
    assert document["scenario"] == EXAMPLE.stem
    assert all(row["solved"] for row in document["rows"])
    lines = list(csv.DictReader(io.StringIO((folder / "report.csv").read_text())))
    assert [line["target_id"] for line in lines[::2]] == ["1", "2", "3", "4", "5"]


def test_broken_methods_are_in_the_report_as_failed(
    contests: list[Contest], tmp_path: Path
) -> None:
    finished = invoke("parabola", "-o", str(tmp_path / "out"), *QUICK)
    assert finished.exit_code == 0, finished.output
    document = json.loads((tmp_path / "out" / "report.json").read_text())
    solved = {summary["method"]: summary["solved"] for summary in document["summaries"]}
    assert solved == {"ncos": 3, "wrong": 0, "raises": 0}
    for method in ("wrong", "raises"):
        (line,) = [text for text in finished.stdout.splitlines() if text.split()[:1] == [method]]
        assert "0 of 3" in line
        assert "failed" in line
    page = (tmp_path / "out" / "report.html").read_text()
    assert "no: joint_limit" in page
    assert "no idea about 1" in page


def test_default_folder_is_named_after_the_scenario(
    contests: list[Contest], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert invoke("parabola", *QUICK).exit_code == 0
    assert (tmp_path / "prunus-compare" / "parabola" / "report.html").is_file()


def test_json_without_a_folder_writes_nothing(
    contests: list[Contest], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert invoke("parabola", "--json", *QUICK).exit_code == 0
    assert list(tmp_path.iterdir()) == []


def refused(*arguments: str) -> str:
    """The one line with which the command refuses."""
    finished = invoke(*arguments)
    assert finished.exit_code == 2, finished.output
    assert finished.stdout == ""
    (line,) = finished.stderr.splitlines()
    return line


def request(tmp_path: Path, body: Any) -> str:
    file = tmp_path / "request.json"
    file.write_text(body if isinstance(body, str) else json.dumps(body))
    return str(file)


def test_unknown_scenarios_and_methods_are_answered_with_those_there_are() -> None:
    assert "strawberry" in refused("nowhere")
    assert "data-set-3" in refused("nowhere")
    assert "floating_z" in refused("data-set-3", "--methods", "ncos,magic")
    assert "as_printed" in refused("strawberry", "--methods", "")


def test_mistakes_of_a_request_are_named_in_one_line(tmp_path: Path) -> None:
    target = {"id": "", "position_m": [1], "branch_direction": [0, 0, 0]}
    line = refused(request(tmp_path, {"robot": "tabletop", "targets": [target]}))
    for pointer in ("#/targets/0/id", "#/targets/0/position_m", "#/targets/0/branch_direction"):
        assert pointer in line
    assert "#: " in refused(request(tmp_path, "not JSON"))
    assert "#/targets" in refused(request(tmp_path, {"robot": "tabletop"}))
    many = {"robot": "tabletop", "targets": [target] * 40}
    assert "more" in refused(request(tmp_path, many))
    assert "absent.json" in refused(str(tmp_path / "absent.json"))
    assert "magic" in refused(str(EXAMPLE), "--methods", "magic")


def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_run(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def solve(number: int) -> Any:
        raise AssertionError("it was run")

    contest = small_contest(Entrant("never", "", solve))
    monkeypatch.setattr(compare_command, "_prepared", lambda *_: contest)
    monkeypatch.setattr(compare_command, "_run", lambda *_, **__: solve(0))
    file = tmp_path / "file"
    file.write_bytes(b"")
    assert str(file) in refused("parabola", "-o", str(file))
    assert "below" in refused("parabola", "-o", str(file / "below"))


def test_no_bar_where_nobody_sees_it() -> None:
    with compare_command._progress_bar("x", quiet=False) as progress:
        assert progress is None
