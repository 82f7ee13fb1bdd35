import concurrent.futures
import contextlib
import json
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import httpx2
import pytest

from app.observation.metrics import Metrics
from app.settings import Settings, SettingsFileUnusable, load_settings
from tests.app.conftest import (
    JOB_S,
    REPOSITORY,
    Server,
    assert_problem,
    running_server,
    wait_until,
)

Body = dict[str, Any]


def connected(server: Server) -> socket.socket:
    parts = urlsplit(server.url)
    return socket.create_connection((parts.hostname or "", parts.port or 0), timeout=60)


def test_request_id_is_kept_or_made(server: Server) -> None:
    kept = server.client.get("/healthz", headers={"X-Request-Id": "vision-7/a"})
    assert kept.headers["x-request-id"] == "vision-7/a"
    for insane in ("x" * 129, "two words"):
        made = server.client.get("/v1/plans/none", headers={"X-Request-Id": insane})
        assert re.fullmatch(r"[0-9a-f]{32}", made.headers["x-request-id"])


def test_infeasible_targets_are_counted(server: Server, request_body: Body) -> None:
    line = 'prunus_targets_total{reason="out_of_reach",status="infeasible"}'

    def counted() -> float:
        text = server.client.get("/metrics").text
        found = [row for row in text.splitlines() if row.startswith(line)]
        return float(found[0].split()[-1]) if found else 0.0

    before = counted()
    far = {"id": "far", "position_m": [2, 0, 0.3], "branch_direction": [0, 1, 0]}
    answer = server.client.post("/v1/plans", json={**request_body, "targets": [far]})
    assert answer.status_code == 201
    assert counted() == before + 1


def test_metrics_are_documented() -> None:
    text = (REPOSITORY / "docs" / "operations.md").read_text()
    documented = set(re.findall(r"^\| `(prunus_\w+)`", text, re.MULTILINE))
    families = [family for family in Metrics("1").registry.collect() if "prunus" in family.name]
    suffix = {"counter": "_total", "info": "_info"}
    assert documented == {family.name + suffix.get(family.type, "") for family in families}


def test_settings_file_is_below_environment_and_options(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "prunus.toml"
    file.write_text("workers = 3\nport = 1\ngrace_s = 7.5\n")
    monkeypatch.setenv("PRUNUS_WORKERS", "4")
    settings = load_settings(file, {"port": 5})
    assert (settings.workers, settings.port, settings.grace_s) == (4, 5, 7.5)
    assert settings.body_limit_bytes == Settings().body_limit_bytes
    with pytest.raises(SettingsFileUnusable):
        load_settings(tmp_path / "none.toml", {})


@pytest.mark.parametrize("text", ["workrs = 3", "workers = 0", "workers ="])
def test_bad_settings_file_is_one_line(tmp_path: Path, text: str) -> None:
    file = tmp_path / "prunus.toml"
    file.write_text(text)
    finished = command("settings", "--settings", str(file))
    assert finished.returncode == 1
    assert len(finished.stderr.splitlines()) == 1


def test_a_misspelt_variable_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("PRUNUS_ROBOTS_DIR", "PRUNUS_URL", "prunus_grace_s", "PRUNUSES"):
        monkeypatch.setenv(name, "1")
    assert command("settings").returncode == 0
    monkeypatch.setenv("PRUNUS_REQUIRE_TOKENS", "hush")
    finished = command("settings")
    assert finished.returncode == 1
    assert len(finished.stderr.splitlines()) == 1
    assert "PRUNUS_REQUIRE_TOKENS" in finished.stderr
    assert "hush" not in finished.stderr


def test_shown_settings_hide_the_password(tmp_path: Path) -> None:
    file = tmp_path / "prunus.toml"
    file.write_text('database_url = "postgresql+psycopg://me:hush@db/prunus"')
    finished = command("settings", "--settings", str(file))
    assert finished.returncode == 0, finished.stderr
    assert "hush" not in finished.stdout
    assert "db/prunus" in finished.stdout


def command(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "app", *arguments],
        cwd=REPOSITORY, capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip


def test_slow_clients_are_dropped(tmp_path: Path, request_body: Body) -> None:
    limits = {"HEAD_TIMEOUT_S": "1", "BODY_IDLE_TIMEOUT_S": "1", "BODY_TIMEOUT_S": "2"}
    limits |= {"WRITE_TIMEOUT_S": "1", "WORKERS": "1"}
    environment: dict[str, Any] = {f"PRUNUS_{name}": value for name, value in limits.items()}
    with running_server(tmp_path, **environment) as server:
        head = b"POST /v1/plans HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9000\r\n\r\n"
        for sent, drip in ((b"", b""), (b"", b"G"), (head, b" "), (head, b"")):
            with connected(server) as client:
                client.sendall(sent)
                answer = drained(client, drip)
            if sent:
                assert answer.startswith(b"HTTP/1.1 408"), answer
                assert b"request_timeout" in answer
            else:
                assert answer == b""
        # One that never reads: many answers pile up until nothing more can be written.
        plan = server.client.post("/v1/plans", json=request_body).headers["location"]
        with connected(server) as client:
            client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            client.settimeout(0.5)
            line = f"GET {plan} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode()
            deadline = time.monotonic() + 60
            with contextlib.suppress(ConnectionError):
                while time.monotonic() < deadline:
                    with contextlib.suppress(TimeoutError):
                        client.sendall(line * 50)
                pytest.fail("a client that never reads was kept")
        assert server.client.get("/healthz").status_code == 200


def drained(client: socket.socket, drip: bytes) -> bytes:
    """All that comes until the server closes, sending a byte now and then."""
    answer, deadline = b"", time.monotonic() + 30
    client.settimeout(0.2)
    while time.monotonic() < deadline:
        with contextlib.suppress(TimeoutError):
            try:
                piece = client.recv(65536)
            except ConnectionError:
                return answer
            if not piece:
                return answer
            answer += piece
        with contextlib.suppress(ConnectionError):
            client.sendall(drip)
    raise AssertionError("the server kept the connection")


def test_stop_under_load_cuts_nothing(tmp_path: Path, request_body: Body) -> None:
    targets = request_body["targets"]
    body = {**request_body, "options": {"method": "ncos", "include": []}}
    body["targets"] = [
        {**target, "id": f"{copy}-{target['id']}"} for copy in range(20) for target in targets
    ]
    codes: list[int] = []
    begun = threading.Event()
    # A grace that four such plans fit in on a machine that does much else.
    with running_server(tmp_path, PRUNUS_GRACE_S="600") as server:

        def post_until_refused() -> None:
            with httpx2.Client(base_url=server.url, timeout=JOB_S, trust_env=False) as client:
                while True:
                    begun.set()
                    try:
                        answer = client.post("/v1/plans", json=body)
                    except httpx2.ConnectError:
                        return  # it listens no more
                    codes.append(answer.status_code)
                    if answer.status_code == 503:
                        assert answer.json()["type"].endswith("stopping")
                        assert "retry-after" in answer.headers
                        return

        with concurrent.futures.ThreadPoolExecutor(4) as executor:
            posting = [executor.submit(post_until_refused) for _ in range(4)]
            begun.wait()
            wait_until(lambda: 201 in codes, JOB_S)
            server.process.send_signal(signal.SIGTERM)
            for one in posting:
                one.result()
        assert server.process.wait(30) == 0
        assert codes.count(201) == server.stored_plans()
        assert set(codes) <= {201, 503}


def slow(body: Body) -> Body:
    """A batch that takes seconds."""
    targets = [
        {**target, "id": f"{copy}-{target['id']}"}
        for copy in range(300)
        for target in body["targets"]
    ]
    return {**body, "targets": targets, "options": {"method": "ncos", "include": []}}


def test_what_takes_longer_than_a_stop_is_told_so(tmp_path: Path, request_body: Body) -> None:
    with (
        running_server(tmp_path, PRUNUS_GRACE_S="0.5") as server,
        concurrent.futures.ThreadPoolExecutor(8) as executor,
    ):
        # One solver process: the last of them would have to wait for half a minute.
        body = slow(request_body)
        posting = [executor.submit(server.client.post, "/v1/plans", json=body) for _ in range(8)]
        wait_until(lambda: b"prunus_solver_queue_depth 7.0" in metrics(server), 30)
        server.process.send_signal(signal.SIGTERM)
        answers = [one.result() for one in posting]
        assert server.process.wait(30) == 0
        refused = [answer for answer in answers if answer.status_code != 201]
        assert refused
        for answer in refused:
            problem = assert_problem(answer, 503)
            assert problem["type"].endswith("solver_unavailable")
        assert server.stored_plans() == len(answers) - len(refused)


def test_readiness_while_stopping(tmp_path: Path, request_body: Body) -> None:
    body = slow(request_body)
    with running_server(tmp_path) as server, concurrent.futures.ThreadPoolExecutor(1) as executor:
        solving = executor.submit(server.client.post, "/v1/plans", json=body)
        wait_until(lambda: b"prunus_solver_running 1.0" in metrics(server), 30)
        server.process.send_signal(signal.SIGTERM)
        wait_until(lambda: get(server, "/readyz").status_code == 503, 5)
        problem = assert_problem(get(server, "/readyz"), 503)
        assert problem["type"].endswith("stopping")
        assert get(server, "/healthz").status_code == 200
        server.process.send_signal(signal.SIGTERM)  # the second ends it at once
        assert server.process.wait(15) == 0
        with contextlib.suppress(httpx2.HTTPError):
            assert solving.result().status_code == 503


def get(server: Server, path: str) -> httpx2.Response:
    return httpx2.get(f"{server.url}{path}", trust_env=False)


def metrics(server: Server) -> bytes:
    return get(server, "/metrics").content


def test_log_is_json_with_request_ids_and_no_query(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "app", "serve", "--port", "0", "--data-dir", str(tmp_path)],
        cwd=REPOSITORY, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    with process:
        assert process.stdout is not None
        url = process.stdout.readline().split()[-1]
        path = f"{url}/v1/executions?robot=hush"
        headers = {"X-Request-Id": "mine"}
        httpx2.get(path, headers=headers, trust_env=False)
        httpx2.get(path, headers={"Authorization": "Bearer hush"}, trust_env=False)
        process.terminate()
        _, errors = process.communicate(timeout=30)
    assert "hush" not in errors
    line, refused = [entry for entry in map(json.loads, errors.splitlines()) if "route" in entry]
    assert refused["status"] == 401
    assert line["request_id"] == "mine"
    assert line["route"] == "/v1/executions"
    assert line["status"] == 200
