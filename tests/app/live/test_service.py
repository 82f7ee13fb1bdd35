import concurrent.futures
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import httpx2

from tests.app.conftest import REPOSITORY, Server, assert_problem, running_server, wait_until

Body = dict[str, Any]


def large(body: Body, copies: int) -> Body:
    targets = [
        {**target, "id": f"{copy}-{target['id']}"}
        for copy in range(copies)
        for target in body["targets"]
    ]
    return {**body, "targets": targets, "options": {"method": "ncos", "include": []}}


def test_health_answers_while_solving(server: Server, request_body: Body) -> None:
    with concurrent.futures.ThreadPoolExecutor(1) as executor:
        solving = executor.submit(server.client.post, "/v1/plans", json=large(request_body, 15))
        answered = 0
        while not solving.done():
            assert httpx2.get(f"{server.url}/healthz", trust_env=False).json() == {"status": "ok"}
            answered += 1
            time.sleep(0.02)
        assert solving.result().status_code == 201
    assert answered >= 3, "the plan was solved before health was asked"


def test_killed_workers_are_replaced(tmp_path: Path, request_body: Body) -> None:
    with running_server(tmp_path, PRUNUS_WORKERS="1") as server:
        (worker,) = server.children()
        with concurrent.futures.ThreadPoolExecutor(1) as executor:
            solving = executor.submit(
                server.client.post, "/v1/plans", json=large(request_body, 300)
            )
            time.sleep(0.5)
            assert not solving.done()
            os.kill(worker, signal.SIGKILL)
            problem = assert_problem(solving.result(), 503)
        assert problem["type"].endswith("solver_unavailable")
        assert server.stored_plans() == 0
        assert server.client.post("/v1/plans", json=request_body).status_code == 201

        # One that dies idle is replaced before anybody notices.
        (worker,) = server.children()
        os.kill(worker, signal.SIGKILL)
        time.sleep(0.5)
        assert server.client.post("/v1/plans", json=request_body).status_code == 201
        wait_until(lambda: server.client.get("/readyz").status_code == 200, 60)


def test_no_process_is_left_behind(tmp_path: Path) -> None:
    with running_server(tmp_path / "interrupted", PRUNUS_WORKERS="2") as server:
        workers = server.children()
        assert len(workers) == 2
    wait_until(lambda: not any(map(_lives, workers)), 10)

    with running_server(tmp_path / "killed", PRUNUS_WORKERS="2") as server:
        workers = server.children()
        server.process.kill()
        server.process.wait()
        wait_until(lambda: not any(map(_lives, workers)), 10)


def _lives(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


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
