"""A lost, locked or hung database: clear answers, and recovery without help."""

import concurrent.futures
import contextlib
import os
import re
import resource
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from bench.service.postgresql import PostgresqlServer
from tests.app.conftest import (
    JOB_S,
    REPOSITORY,
    Server,
    assert_problem,
    running_server,
    wait_until,
)

Body = dict[str, Any]
ID = "0" * 32


def assert_unavailable(answer: Any) -> None:
    problem = assert_problem(answer, 503)
    assert problem["type"].endswith("store_unavailable")
    assert int(answer.headers["retry-after"]) > 0


def serve(data_dir: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "app", "serve", "--port", "0", "--data-dir", str(data_dir)]
    return subprocess.run(
        command, cwd=REPOSITORY, env={**os.environ, **environment}, capture_output=True, text=True,
        timeout=60, check=False,
    )  # fmt: skip


@pytest.fixture(scope="module")
def on_sqlite(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with running_server(tmp_path_factory.mktemp("failing")) as it:
        yield it


def test_locked_and_taken_sqlite(on_sqlite: Server, request_body: Body) -> None:
    server = on_sqlite
    second = serve(server.data_dir)
    assert second.returncode == 1
    assert len(second.stderr.splitlines()) == 1
    assert "another service" in second.stderr
    path = server.data_dir / "prunus.sqlite3"
    with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as other:
        other.execute("BEGIN EXCLUSIVE")
        with concurrent.futures.ThreadPoolExecutor(3) as executor:
            # One waits for the other program, two for their turn behind it.
            posting = [
                executor.submit(server.client.post, "/v1/plans", json=request_body)
                for _ in range(3)
            ]
            for one in posting:
                assert_unavailable(one.result())
        assert server.client.get("/healthz").status_code == 200
        other.execute("ROLLBACK")
    failures = re.search(
        r"^prunus_store_errors_total (\S+)", server.client.get("/metrics").text, re.MULTILINE
    )
    assert failures is not None
    assert float(failures[1]) >= 3
    assert server.stored_plans() == 0
    assert server.client.post("/v1/plans", json=request_body).status_code == 201
    assert server.stored_plans() == 1


def test_a_full_disk(on_sqlite: Server, request_body: Body) -> None:
    server = on_sqlite
    plan = server.client.post("/v1/plans", json=request_body)
    stored = server.stored_plans()
    more = [{**target, "id": f"{k}"} for k in range(400) for target in request_body["targets"][:1]]
    long = {**request_body, "targets": more, "options": {"method": "ncos", "include": ["path"]}}
    job = server.client.post("/v1/plans", json=long, headers={"Prefer": "respond-async"})
    assert job.status_code == 202
    unlimited = (resource.RLIM_INFINITY, resource.RLIM_INFINITY)
    full = (4096, resource.RLIM_INFINITY)  # nothing is written behind that in any file
    resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, full)
    try:
        for method, path, body in (
            ("POST", "/v1/plans", request_body),
            ("PUT", "/v1/frames/new", {"position_m": [0, 0, 0], "quaternion_xyzw": [0, 0, 0, 1]}),
            ("DELETE", job.headers["location"], None),
        ):
            problem = assert_problem(server.client.request(method, path, json=body), 507)
            assert problem["type"].endswith("storage_full")
        assert server.client.get(plan.headers["location"]).content == plan.content
        assert server.client.get("/healthz").status_code == 200
        assert server.client.get("/v1/frames").json() == {"frames": []}
        assert server.stored_plans() == stored
    finally:
        resource.prlimit(server.process.pid, resource.RLIMIT_FSIZE, unlimited)
    assert server.client.post("/v1/plans", json=request_body).status_code == 201

    def status() -> str:
        told: str = server.client.get(job.headers["location"]).json()["status"]
        return told

    # It waited for the room, and lost nothing.
    wait_until(lambda: status() == "completed", JOB_S)
    done = server.client.get(job.headers["location"].replace("jobs", "plans")).json()
    assert [entry["target_id"] for entry in done["approaches"]] == [f"{k}" for k in range(400)]


def test_lost_postgresql(
    tmp_path: Path, postgresql: PostgresqlServer, postgresql_url: str, request_body: Body
) -> None:
    with running_server(tmp_path, PRUNUS_DATABASE_URL=postgresql_url) as server:
        plan = server.client.post("/v1/plans", json=request_body)
        assert plan.status_code == 201, plan.text
        location = plan.headers["location"]
        assert "another service" in serve(tmp_path, PRUNUS_DATABASE_URL=postgresql_url).stderr
        postgresql.stop()
        try:
            assert_unavailable(server.client.post("/v1/plans", json=request_body))
            assert_unavailable(server.client.get(location))
            assert_unavailable(server.client.get("/v1/executions"))
            assert_problem(server.client.get("/readyz"), 503)
            assert server.client.get("/healthz").status_code == 200
        finally:
            postgresql.start()
        wait_until(lambda: server.client.get("/readyz").status_code == 200, 30)
        assert server.client.get(location).content == plan.content
        assert server.client.post("/v1/plans", json=request_body).status_code == 201
        # The lock went with the connection, and is taken again.
        locks = "SELECT count(*) FROM pg_locks WHERE locktype = 'advisory' AND granted"
        database = postgresql_url.rpartition("/")[2]
        wait_until(lambda: postgresql.execute(locks, database) == [(1,)], 30)
        assert server.client.get("/v1/executions?robot=%00").json() == {"executions": []}
        # PostgreSQL's texts take no NUL, JSON's do.
        request_body["targets"][0]["id"] = "a\0b"
        answer = server.client.post("/v1/plans", json=request_body)
        assert answer.json()["approaches"][0]["target_id"] == "a\0b"
        assert server.client.get(answer.headers["location"]).content == answer.content


def test_a_database_that_is_not_there_is_one_line(
    tmp_path: Path, postgresql: PostgresqlServer
) -> None:
    finished = serve(tmp_path, PRUNUS_DATABASE_URL=postgresql.url("nothing"))
    assert finished.returncode == 1
    assert len(finished.stderr.splitlines()) == 1, finished.stderr
    assert "database" in finished.stderr
