import json
from pathlib import Path
from typing import Any

import pytest

from app.commands import demo
from app.commands.demo import is_reached, run_demo
from app.schemas.demo_request import demo_request

Body = dict[str, Any]
PNG = b"\x89PNG\r\n"


# Robot time does not wait for a busy machine.
pytestmark = pytest.mark.alone


def test_demo_plans_executes_measures_and_writes_where_it_says(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_demo(tmp_path / "demo") == 0
    printed = capsys.readouterr().out
    for name in ("arm.png", "effort.png", "plan.json", "execution.json", "table.md"):
        assert name in printed
        assert (tmp_path / "demo" / name).exists()
    assert (tmp_path / "demo" / "arm.png").read_bytes().startswith(PNG)
    assert (tmp_path / "demo" / "effort.png").read_bytes().startswith(PNG)
    plan = json.loads((tmp_path / "demo" / "plan.json").read_text())
    assert plan["summary"]["planned"] == 5
    assert "5 of 5 targets planned and verified" in printed
    assert "5 of 5 targets reached within 3 mm" in printed
    execution = json.loads((tmp_path / "demo" / "execution.json").read_text())
    assert execution["status"] == "completed"
    assert execution["plan_id"] == plan["id"]
    table = (tmp_path / "demo" / "table.md").read_text()
    for target in execution["targets"]:
        assert f"| {target['target_error_m'] * 1000:.2f} |" in table


def test_demo_fails_when_a_target_is_not_planned(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    request = demo_request()
    reachable, far = request["targets"][:2]
    request["targets"] = [reachable, {**far, "position_m": [0.0, 2.0, 0.1]}]
    monkeypatch.setattr(demo, "demo_request", lambda: request)
    assert run_demo(tmp_path) == 1
    printed = capsys.readouterr().out
    assert "1 of 2 targets planned" in printed
    assert "1 of 2 targets reached" in printed


@pytest.mark.parametrize(
    "change",
    [
        {"target_error_m": 0.0031},
        {"standby_error_m": 0.0031},
        {"status": "skipped"},
        {"target_error_m": None},
    ],
)
def test_a_target_is_reached_only_when_it_was_measured_to_be(change: Body) -> None:
    target: Body = {"status": "done", "standby_error_m": 0.003, "target_error_m": 0.001}
    assert is_reached(target)
    assert not is_reached({k: v for k, v in (target | change).items() if v is not None})


def test_demo_says_why_it_cannot_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PRUNUS_DATABASE_URL", "sqlite:////proc/none/here.sqlite3")
    assert run_demo(tmp_path) == 1
    assert "the demonstration failed" in capsys.readouterr().out
    (tmp_path / "file").write_text("")
    assert run_demo(tmp_path / "file") == 1
