"""`prunus robot`: an arm out, in again, and planned for under its new name."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.commands.cli import cli
from solver import load_robot

BASE_AND_TIP = ("--base", "base_link", "--tip", "tool_centre_point")


def run(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(cli, [*arguments])
    return result.exit_code, result.output


def test_out_in_and_planned(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    urdf, model, request = tmp_path / "arm.urdf", tmp_path / "mine.toml", tmp_path / "request.json"
    assert run("robot", "export", "puma560", "-o", str(urdf)) == (0, "")
    code, output = run(
        "robot", "import", str(urdf), *BASE_AND_TIP, "-o", str(model), "--acceleration-rad-s2", "3"
    )
    assert code == 0, output
    assert output == "mine: 6 joints, closed form: every method, masses\n"
    assert load_robot(model).lower.tolist() == load_robot("puma560").lower.tolist()
    monkeypatch.setenv("PRUNUS_ROBOTS_DIR", str(tmp_path))
    target = {"id": "1", "position_m": [0.6, -0.15, 1.0], "branch_direction": [0, 1, 0]}
    request.write_text(
        json.dumps({"robot": "mine", "targets": [target], "options": {"method": "floating_z"}})
    )
    code, output = run("plan", str(request), "-o", str(tmp_path / "plan.json"))
    assert code == 0, output
    plan = json.loads((tmp_path / "plan.json").read_text())
    assert (plan["robot"], plan["summary"]["planned"]) == ("mine", 1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("export", "nowhere"), "unknown robot"),
        (("export", "puma560", "--tool", "saw"), "unknown tool; known: forks"),
        (("import", "missing.urdf"), "No such file"),
        (("import", "pyproject.toml"), "cannot be read"),
    ],
)
def test_refusals(tmp_path: Path, arguments: tuple[str, ...], message: str) -> None:
    options = ["-o", str(tmp_path / "out")]
    if arguments[0] == "import":
        options += [*BASE_AND_TIP, "--acceleration-rad-s2", "3"]
    code, output = run("robot", *arguments, *options)
    assert code == 2
    assert message in output
    assert not (tmp_path / "out").exists()


def test_a_broken_model_file_stops_plan_with_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "mine.toml").write_text("name = 3")
    monkeypatch.setenv("PRUNUS_ROBOTS_DIR", str(tmp_path))
    (tmp_path / "request.json").write_text(
        json.dumps(
            {
                "robot": "mine",
                "targets": [{"id": "1", "position_m": [0, 0, 1], "branch_direction": [0, 1, 0]}],
            }
        )
    )
    code, output = run("plan", str(tmp_path / "request.json"))
    assert code == 2
    assert "the model file cannot be read" in output
