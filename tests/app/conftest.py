import contextlib
import json
import os
import selectors
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import httpx2
import pytest
from sqlalchemy import URL, Engine, make_url

from app.settings import Settings
from app.store import open_engine

REPOSITORY = Path(__file__).parents[2]
EXAMPLE = REPOSITORY / "openapi" / "examples" / "data_set_3.json"
ANNOUNCEMENT = "Prunus listens on "
BODY_LIMIT_BYTES = 8_000_000  # of the session's server, in tests/conftest.py
START_S = 60
READY_S = 600  # the first start compiles every kernel
JOB_S = 600  # jobs take what is left of the processors, which beside other tests is little


@dataclass(frozen=True)
class Server:
    process: subprocess.Popen[str]
    url: str
    data_dir: Path
    client: httpx2.Client

    def stored_plans(self) -> int:
        with contextlib.closing(sqlite3.connect(self.data_dir / "prunus.sqlite3")) as database:
            count: int = database.execute("SELECT count(*) FROM plans").fetchone()[0]
            return count

    def children(self) -> list[int]:
        """Processes that the service started, without Python's resource tracker."""
        found = []
        for entry in Path("/proc").iterdir():
            if not entry.name.isdigit():
                continue
            with contextlib.suppress(OSError):
                parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
                command = (entry / "cmdline").read_bytes()
                if parent == self.process.pid and b"resource_tracker" not in command:
                    found.append(int(entry.name))
        return found


def wait_until(condition: Callable[[], bool], timeout_s: float, poll_s: float = 0.05) -> None:
    deadline = time.monotonic() + timeout_s
    while not condition():
        assert time.monotonic() < deadline, "it did not happen in time"
        time.sleep(poll_s)


def lives(pid: int) -> bool:
    """Whether a process runs; one that has ended with all its threads, but is not fetched, not."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
        threads = len(os.listdir(f"/proc/{pid}/task"))
    except OSError:
        return False
    return state != "Z" or threads > 1


def is_solving(server: Server) -> bool:
    """Whether one of its solver processes has a problem."""
    return "prunus_solver_running 1.0" in server.client.get("/metrics").text


def _first_line(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ)
        assert selector.select(START_S), "the service said nothing"
    return process.stdout.readline()


@contextlib.contextmanager
def running_server(
    data_dir: Path, port: str = "0", *, stderr: IO[str] | None = None, **environment: str
) -> Iterator[Server]:
    command = [sys.executable, "-m", "app", "serve", "--port", port, "--data-dir", str(data_dir)]
    with subprocess.Popen(
        command,
        cwd=REPOSITORY,
        # One solver process is enough, and half the start-up.
        env={"PRUNUS_WORKERS": "1", **os.environ, **environment},
        stdout=subprocess.PIPE,
        stderr=stderr,
        text=True,
    ) as process:
        try:
            line = _first_line(process)
            assert line.startswith(ANNOUNCEMENT), line
            url = line.removeprefix(ANNOUNCEMENT).strip()
            with httpx2.Client(base_url=url, timeout=120, trust_env=False) as client:
                wait_until(lambda: client.get("/readyz").status_code == 200, READY_S)
                yield Server(process, url, data_dir, client)
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                raise


@pytest.fixture(params=["sqlite", "postgresql"])
def store_url(request: pytest.FixtureRequest, tmp_path: Path) -> URL:
    """An empty database of each kind that the service takes."""
    if request.param == "sqlite":
        return make_url(f"sqlite:///{tmp_path / 'prunus.sqlite3'}")
    given: str = request.getfixturevalue("postgresql_url")
    return Settings(database_url=given).resolved_database_url


@pytest.fixture
def engine(store_url: URL) -> Iterator[Engine]:
    """An engine for a new database with the newest schema."""
    opened = open_engine(store_url)
    yield opened
    opened.dispose()


@pytest.fixture
def request_body() -> dict[str, Any]:
    """Data set 3, solved by the fastest of the methods."""
    body: dict[str, Any] = json.loads(EXAMPLE.read_text())
    body["options"]["method"] = "ssas"
    return body


def assert_problem(
    answer: httpx2.Response, status: int, pointer: str | None = None
) -> dict[str, Any]:
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem: dict[str, Any] = answer.json()
    assert set(problem) == {"type", "title", "status", "detail", "errors"}
    assert problem["status"] == status
    if pointer is not None:
        assert pointer in {error["pointer"] for error in problem["errors"]}, problem
    return problem
