import json
from pathlib import Path

import pytest

from app import demo
from app.demo import run_demo
from app.demo_request import demo_request

PNG = b"\x89PNG\r\n"


def test_demo_plans_all_and_writes_where_it_says(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_demo(tmp_path / "demo") == 0
    printed = capsys.readouterr().out
    for name in ("arm.png", "effort.png", "plan.json", "table.md"):
        assert str(tmp_path / "demo" / name) in printed
    assert (tmp_path / "demo" / "arm.png").read_bytes().startswith(PNG)
    assert (tmp_path / "demo" / "effort.png").read_bytes().startswith(PNG)
    plan = json.loads((tmp_path / "demo" / "plan.json").read_text())
    assert plan["summary"]["planned"] == 5
    assert "5 of 5 targets planned and verified" in printed


def test_demo_fails_when_a_target_is_not_planned(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    request = demo_request()
    request["targets"][4]["position_m"] = [0.0, 2.0, 0.1]
    monkeypatch.setattr(demo, "demo_request", lambda: request)
    assert run_demo(tmp_path) == 1
    assert "4 of 5 targets" in capsys.readouterr().out


def test_demo_says_why_it_cannot_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PRUNUS_DATABASE_URL", "sqlite:////proc/none/here.sqlite3")
    assert run_demo(tmp_path) == 1
    assert "the demonstration failed" in capsys.readouterr().out
    (tmp_path / "file").write_text("")
    assert run_demo(tmp_path / "file") == 1
