"""The commands of docs/frames.md are run as written, and answer what it prints."""

import json
import re
import shlex
import subprocess
from pathlib import Path
from typing import Any

import pytest

from app.store.frames import MOST_FRAMES
from solver.frames import tolerances
from tests.app.conftest import Server
from tests.docs.test_documents import ROOT, fences, rows

DOCUMENT = "docs/frames.md"


def assert_printed(found: Any, printed: Any) -> None:
    """All that is printed is found, numbers to the digits printed."""
    if isinstance(printed, dict):
        for name, value in printed.items():
            assert_printed(found[name], value)
    elif isinstance(printed, list):
        for one, value in zip(found, printed, strict=True):
            assert_printed(one, value)
    elif isinstance(printed, float):
        assert found == pytest.approx(printed, abs=5.1e-5)
    else:
        assert found == printed


def test_commands_answer_what_is_printed(server: Server) -> None:
    commands, answers = fences(DOCUMENT, "sh"), fences(DOCUMENT, "json")
    assert len(commands) == len(answers) == 4
    for command, printed in zip(commands, answers, strict=True):
        words = shlex.split(command.replace("http://127.0.0.1:8000", server.url))
        assert words[0] == "curl"
        options = ["--silent", "--show-error", "--fail-with-body", "--noproxy", "*"]
        finished = subprocess.run(
            [*words, *options], capture_output=True, text=True, timeout=60, check=False
        )
        assert finished.returncode == 0, finished.stdout + finished.stderr
        assert_printed(json.loads(finished.stdout), json.loads(printed))


def test_warnings_are_documented() -> None:
    used = {
        code
        for file in (ROOT / "solver/frames").glob("*.py")
        for code in re.findall(r'FrameWarning\(\s*"(\w+)"', file.read_text(encoding="utf-8"))
    }
    assert len(used) >= 8
    assert {row[0] for row in rows(DOCUMENT, "Warnings")[2:]} == used
    described = (ROOT / "app/schemas/frames.py").read_text(encoding="utf-8")
    assert all(code in described for code in used)


def test_limits_are_those_of_the_code() -> None:
    text = " ".join(Path(ROOT / DOCUMENT).read_text(encoding="utf-8").split())
    assert f"more than {tolerances.MOST_PAIRS:,}" in text
    assert f"less than {100 * tolerances.COLLINEAR:g} % of their spread" in text
    assert f"or within {1000 * tolerances.SAME_PLACE_M:g} mm" in text
    assert f"{MOST_FRAMES:,} are kept" in text
    assert f"more than {1000 * tolerances.LARGE_RESIDUAL_M:g} mm off" in text
    assert f"known to {tolerances.MOST_ROTATION_STD_RAD:g} rad only" in text
    assert f"known to {1000 * tolerances.POOR_ROTATION_STD_RAD:g} mrad only" in text
