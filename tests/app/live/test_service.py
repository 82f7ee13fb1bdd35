import concurrent.futures
import contextlib
import json
import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx2
import pytest

from tests.app.conftest import (
    REPOSITORY,
    Server,
    assert_problem,
    is_solving,
    lives,
    running_server,
    wait_until,
)

Body = dict[str, Any]


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with running_server(tmp_path_factory.mktemp("own")) as it:
        yield it


@contextlib.contextmanager
def asked_of_a_worker_that_stands_still(
    server: Server, body: Body
) -> Iterator[concurrent.futures.Future[httpx2.Response]]:
    """A plan that is being solved for as long as the test wants, or until it kills the worker."""
    (worker,) = server.children()
    os.kill(worker, signal.SIGSTOP)
    with concurrent.futures.ThreadPoolExecutor(1) as executor:
        solving = executor.submit(server.client.post, "/v1/plans", json=body)
        try:
            wait_until(lambda: is_solving(server), 60)
            yield solving
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.kill(worker, signal.SIGCONT)


def test_health_answers_while_solving(own: Server, request_body: Body) -> None:
    with asked_of_a_worker_that_stands_still(own, request_body) as solving:
        for _ in range(3):
            assert own.client.get("/healthz").json() == {"status": "ok"}
        assert not solving.done()
    assert solving.result().status_code == 201


def test_killed_workers_are_replaced(own: Server, request_body: Body) -> None:
    stored = own.stored_plans()
    with asked_of_a_worker_that_stands_still(own, request_body) as solving:
        (worker,) = own.children()
        os.kill(worker, signal.SIGKILL)
        problem = assert_problem(solving.result(), 503)
    assert problem["type"].endswith("solver_unavailable")
    assert own.stored_plans() == stored
    assert own.client.post("/v1/plans", json=request_body).status_code == 201

    # One that dies idle is replaced before anybody notices.
    (worker,) = own.children()
    os.kill(worker, signal.SIGKILL)
    wait_until(lambda: not lives(worker), 10)
    assert own.client.post("/v1/plans", json=request_body).status_code == 201
    wait_until(lambda: own.client.get("/readyz").status_code == 200, 60)


def test_no_process_is_left_behind(tmp_path: Path) -> None:
    with running_server(tmp_path / "interrupted", PRUNUS_WORKERS="2") as server:
        workers = server.children()
        assert len(workers) == 2
    wait_until(lambda: not any(map(lives, workers)), 10)

    with running_server(tmp_path / "killed") as server:
        workers = server.children()
        server.process.kill()
        server.process.wait()
        wait_until(lambda: not any(map(lives, workers)), 10)


def test_taken_port_is_one_line(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        finished = _run("serve", "--port", str(port), "--data-dir", str(tmp_path))
    assert finished.returncode == 1
    assert len(finished.stderr.splitlines()) == 1
    assert f"127.0.0.1:{port}" in finished.stderr
    assert finished.stdout == ""


def test_openapi_document_is_the_exported_one(server: Server) -> None:
    exported = (REPOSITORY / "openapi" / "openapi.json").read_text(encoding="utf-8")
    assert _run("export-openapi").stdout == exported, "run: prunus export-openapi"
    document = server.client.get("/openapi.json").json()
    assert document == json.loads(exported)
    text = json.dumps(document)
    for absent in ('"null"', "anyOf", "oneOf", "prefixItems", "HTTPValidationError"):
        assert absent not in text
    for method in (method for path in document["paths"].values() for method in path.values()):
        assert re.fullmatch(r"[a-z]+(_[a-z]+)+", method["operationId"])


def _run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "app", *arguments],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
