"""What docs/idempotency.md tells people to send is sent."""

import re
import shlex
import subprocess
import sys

import httpx2
import pytest

from app.routers.idempotency_key import HEADER, LONGEST_KEY, REPLAYED
from tests.app.conftest import Server
from tests.docs.test_documents import ROOT, fences

DOCUMENT = "docs/idempotency.md"
ADDRESS = "http://127.0.0.1:8000"


def test_its_commands_are_good_ones(server: Server) -> None:
    (line,) = fences(DOCUMENT, "sh")
    (example,) = fences(DOCUMENT, "python")
    before = server.stored_plans()
    words = shlex.split(line.replace(ADDRESS, server.url))
    headers = dict(words[k + 1].split(": ", 1) for k, word in enumerate(words) if word == "-H")
    assert HEADER in headers
    answers = [
        httpx2.post(words[2], content=words[-1], headers=headers, timeout=60, trust_env=False)
        for _ in range(2)
    ]
    assert [answer.status_code for answer in answers] == [201, 201]
    assert [REPLAYED in answer.headers for answer in answers] == [False, True]
    assert answers[0].content == answers[1].content
    command = [sys.executable, "-c", example.replace(ADDRESS, server.url)]
    run = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    status, location = run.stdout.split()
    assert status == "201"
    assert server.client.get(location).json()["summary"]["planned"] == 5
    assert server.stored_plans() == before + 2


@pytest.mark.parametrize("fact", [f"longer than {LONGEST_KEY} characters", REPLAYED, HEADER])
def test_its_facts_are_the_codes(fact: str) -> None:
    text = re.sub(r"\s+", " ", (ROOT / DOCUMENT).read_text(encoding="utf-8"))
    assert fact in text
