"""What docs/jobs.md tells people to send is sent, and what it says of the service is so."""

import json
import re
import subprocess

import pytest

from app.settings import Settings
from solver.methods.registry import METHODS
from tests.app.conftest import JOB_S, Server, wait_until
from tests.docs.test_documents import ROOT, fences

DOCUMENT = "docs/jobs.md"
ADDRESS = "http://127.0.0.1:8000"


def test_its_command_begins_a_job(server: Server) -> None:
    (command,) = fences(DOCUMENT, "sh")
    run = subprocess.run(
        command.replace(ADDRESS, server.url),
        shell=True, capture_output=True, text=True, check=True, cwd=ROOT,
    )  # fmt: skip
    head, _, body = run.stdout.replace("\r", "").partition("\n\n")
    assert re.match(r"HTTP/1\.1 202 ", head)
    location = re.search(r"(?mi)^location: (/v1/jobs/\w+)$", head)
    assert location is not None
    path = location[1]
    assert path.endswith(json.loads(body)["id"])
    wait_until(lambda: server.client.get(path).json()["status"] == "completed", JOB_S)
    plan = server.client.get(path.replace("jobs", "plans")).json()
    assert plan["summary"]["planned"] == 5


@pytest.mark.parametrize(
    "fact",
    [
        "{ncos} targets with `ncos`, {ssas} with `ssas`".format(
            **{name: row.targets_in_a_part for name, row in METHODS.items()}
        ),
        f"targets ({Settings().sync_targets_limit:,})",
    ],
)
def test_its_facts_are_the_codes(fact: str) -> None:
    text = re.sub(r"\s+", " ", (ROOT / DOCUMENT).read_text(encoding="utf-8"))
    assert fact in text
