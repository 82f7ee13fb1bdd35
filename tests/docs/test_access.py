"""docs/access.md: its table against the code, its commands against a service."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import typer.main

from app.commands.cli import cli
from app.services.access.scopes import SCOPES
from tests.app.conftest import running_server
from tests.docs.test_documents import ROOT, fences, rows

DOCUMENT = "docs/access.md"
MAKE, SERVE, LOOK, WORKER, LEASE = range(5)


def test_scopes_are_documented() -> None:
    assert {row[0]: row[1] for row in rows(DOCUMENT, "Scopes")[2:]} == SCOPES


def test_options_in_the_commands_exist() -> None:
    commands = typer.main.get_command(cli).commands  # type: ignore[attr-defined]
    blocks = fences(DOCUMENT, "sh")
    for name, block in (("serve", SERVE), ("worker", WORKER)):
        known = {option for parameter in commands[name].params for option in parameter.opts}
        words = blocks[block].split()
        assert words[:2] == [".venv/bin/prunus", name]
        assert {word for word in words if word.startswith("--")} <= known


def test_commands_do_what_the_document_says(tmp_path: Path) -> None:
    blocks = fences(DOCUMENT, "sh")
    data_dir = tmp_path / "data"

    def run(script: str, url: str = "") -> str:
        script = script.replace(".venv/bin/prunus", f"{sys.executable} -m app")
        environment = {
            **os.environ, "PRUNUS_DATA_DIR": str(data_dir), "PYTHONPATH": str(ROOT),
        }  # fmt: skip
        return subprocess.run(
            ["sh", "-ec", script.replace("http://arm.example:8000", url)],
            cwd=tmp_path, env=environment, capture_output=True, text=True, check=True, timeout=60,
        ).stdout  # fmt: skip

    listed = run(blocks[MAKE])
    assert [line.split()[-1] for line in listed.splitlines()] == ["detector", "operator"]
    assert (tmp_path / "detector.token").read_text().startswith("prunus_")
    with running_server(data_dir, PRUNUS_HOST="0.0.0.0", PRUNUS_WORKERS="1") as server:
        url = server.url.replace("0.0.0.0", "127.0.0.1")
        assert json.loads(run(blocks[LOOK], url))["robots"]
        lease = json.loads(run(blocks[LEASE], url))
        assert lease["holder"] == "row 3"
        assert lease["lease_id"]


@pytest.mark.parametrize("code", ["token_required", "invalid_token", "insufficient_scope"])
def test_refusals_are_explained(code: str) -> None:
    assert any(code in row[0] for row in rows(DOCUMENT, "Tokens"))
