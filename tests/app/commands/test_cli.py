import json
import math
import subprocess
import sys
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest

from tests.app.conftest import EXAMPLE, REPOSITORY

Body = dict[str, Any]


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "app", *arguments],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def test_help_names_the_commands() -> None:
    finished = run("--help")
    assert finished.returncode == 0
    for command in (
        "serve",
        "plan",
        "compare",
        "demo",
        "worker",
        "calibrate",
        "servo-bus",
        "export-openapi",
    ):
        assert command in finished.stdout


def test_version() -> None:
    assert run("--version").stdout.strip() == metadata.version("prunus")


def test_plan_prints_a_table_and_writes_only_when_asked(tmp_path: Path) -> None:
    finished = run("plan", str(EXAMPLE))
    assert finished.returncode == 0, finished.stderr
    assert finished.stdout.strip()
    written = tmp_path / "plan.json"
    assert run("plan", str(EXAMPLE), "-o", str(written)).returncode == 0
    assert json.loads(written.read_text())["summary"]["planned"] == 5


def test_start_joints_in_degrees(tmp_path: Path) -> None:
    body: Body = json.loads(EXAMPLE.read_text())
    body["start_joints"] = [math.degrees(value) for value in body["start_joints"]]
    request, written = tmp_path / "request.json", tmp_path / "plan.json"
    request.write_text(json.dumps(body))
    finished = run("plan", str(request), "-o", str(written), "--degrees")
    assert finished.returncode == 0, finished.stderr
    plan = json.loads(written.read_text())
    assert plan["start_joints"] == pytest.approx([0, math.pi / 2, -1.5757, 0, 1.5757, 0])
    assert run("plan", str(request)).returncode == 2


def test_infeasible_targets_are_no_failure(tmp_path: Path) -> None:
    body: Body = json.loads(EXAMPLE.read_text())
    body["targets"] = [{"id": "far", "position_m": [2, 0, 0.3], "branch_direction": [0, 1, 0]}]
    request = tmp_path / "request.json"
    request.write_text(json.dumps(body))
    finished = run("plan", str(request))
    assert finished.returncode == 0, finished.stderr


@pytest.mark.parametrize(
    ("content", "pointer"),
    [
        ('{"robot": "tabletop", "targets": []}', "#/targets: "),
        ('{"robot": "tabletop"}', "#/targets: "),
        ("not JSON", "#: "),
        ("", "#: "),
    ],
)
def test_bad_request(content: str, pointer: str, tmp_path: Path) -> None:
    request, written = tmp_path / "request.json", tmp_path / "plan.json"
    request.write_text(content)
    finished = run("plan", str(request), "-o", str(written))
    assert finished.returncode == 2
    assert finished.stderr.startswith(pointer)
    assert len(finished.stderr.splitlines()) == 1
    assert not written.exists()


def test_unreadable_file(tmp_path: Path) -> None:
    finished = run("plan", str(tmp_path / "absent.json"))
    assert finished.returncode == 2
    assert len(finished.stderr.splitlines()) == 1
