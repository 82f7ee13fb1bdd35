"""Services of their own that are killed, stopped, or lose what they need."""

import contextlib
import os
import signal
import sqlite3
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed

from app.server.serving import LONGEST_MESSAGE_BYTES
from hardware.link.messages import ExecutionAccount, Welcome
from tests.app.conftest import Server, running_server
from tests.app.execution_requests import (
    executing,
    get,
    large_plan,
    make_plan,
    start,
    wait_for_status,
)
from tests.app.fake_worker import (
    MEASURED,
    WAIT_S,
    FakeWorker,
    closed,
    hello,
    link,
    wait_for,
    worker,
)

# Robot time does not wait for a busy machine.
pytestmark = pytest.mark.alone


def test_a_service_that_is_killed_sends_nothing_again(tmp_path: Path) -> None:
    with running_server(tmp_path, PRUNUS_WORKERS="1") as first:
        plan = make_plan(first)
        with link(first) as connection:
            fake = FakeWorker(connection)
            fake.say(hello())
            fake.expect(Welcome)
            fake.start()
            execution = executing(first, fake, plan)
            first.process.kill()
            first.process.wait()
            fake.silence()
    with running_server(tmp_path, PRUNUS_WORKERS="1") as second:
        over = get(second, execution)
        assert (over["status"], over["error"]["code"]) == ("failed", "service_restarted")
        assert over["targets"][0]["status"] == "unknown"
        assert over["ended_at"] >= over["started_at"]
        with worker(second) as fake:
            fake.say(ExecutionAccount(execution["id"], "failed", (MEASURED,)))
            wait_for(lambda: get(second, execution)["targets"][0]["status"] == "done")
            merged = get(second, execution)
            assert merged["error"] == over["error"]
            assert merged["targets"][0]["standby_error_m"] == 0.001
            following = start(second, plan)
            assert fake.order()[0].execution_id == following["id"]
        wait_for_status(second, following, "failed")


def test_a_service_that_is_stopped_ends_what_is_executing(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    with running_server(tmp_path, PRUNUS_WORKERS="1") as first:
        plan = make_plan(first)
        with link(first) as connection:
            fake = FakeWorker(connection)
            fake.say(hello())
            fake.expect(Welcome)
            fake.start()
            execution = executing(first, fake, plan)
            first.process.terminate()
            first.process.wait(20)
            fake.silence()
    with running_server(tmp_path, PRUNUS_WORKERS="1") as second:
        assert get(second, execution)["error"]["code"] == "service_restarted"
        for first_words in ("qq7z", b"\xff"):
            with link(second) as connection:
                connection.send(first_words)
                closed(connection)
        with link(second) as connection:
            # It may not even be read to its end.
            with contextlib.suppress(ConnectionClosed):
                connection.send("x" * (LONGEST_MESSAGE_BYTES + 1))
            with pytest.raises(ConnectionClosed):
                connection.recv(timeout=WAIT_S)
        with worker(second) as fake:
            fake.connection.send("qq7z\n")
            closed(fake.connection)
    assert "Traceback" not in capfd.readouterr().err


def test_a_solver_that_dies_fails_the_execution_it_prepares(tmp_path: Path) -> None:
    with running_server(tmp_path, PRUNUS_WORKERS="1") as server:
        large, plan = large_plan(server), make_plan(server)
        (solver,) = server.children()
        with worker(server) as fake:
            execution = start(server, large)
            os.kill(solver, signal.SIGKILL)
            over = wait_for_status(server, execution, "failed")
            assert over["error"]["code"] == "solver_failed"
            following = start(server, plan)
            assert fake.order()[0].execution_id == following["id"]
        wait_for_status(server, following, "failed")


def test_a_worker_is_sent_away_when_its_accounts_cannot_be_stored(tmp_path: Path) -> None:
    """It comes back and says it again; nothing is taken as told that is not stored."""
    with running_server(tmp_path, PRUNUS_WORKERS="1") as server:
        plan = make_plan(server)
        with worker(server) as fake:
            execution = executing(server, fake, plan)
            rename(server, "executions", "elsewhere")
            fake.account(execution["id"], "completed", **{"1": "done"})
            assert closed(fake.connection)[0] == 1011
        rename(server, "elsewhere", "executions")
        assert get(server, execution)["status"] == "executing"
        with worker(server) as fake:
            fake.account(execution["id"], "completed", **{"1": "done"})
            wait_for_status(server, execution, "completed")


def rename(server: Server, table: str, name: str) -> None:
    with contextlib.closing(sqlite3.connect(server.data_dir / "prunus.sqlite3")) as database:
        database.execute(f"ALTER TABLE {table} RENAME TO {name}")
        database.commit()
