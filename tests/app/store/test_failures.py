"""What failures of a database mean."""

import os
import signal
from pathlib import Path

import pytest
from sqlalchemy import make_url
from sqlalchemy.exc import SQLAlchemyError

from app.settings import Settings
from app.store import ExecutionStore, PlanStore, open_engine
from app.store import postgresql as postgresql_connections
from app.store.failures import StoreFailure, failure_of
from bench.service.postgresql import PostgresqlServer

ID = "0" * 32


def test_a_hung_server_is_given_up(
    postgresql: PostgresqlServer, postgresql_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    url = Settings(database_url=postgresql_url).resolved_database_url
    engine = open_engine(url)
    store = PlanStore(engine)
    store.check()
    backends = [
        pid
        for (pid,) in postgresql.execute(
            f"SELECT pid FROM pg_stat_activity WHERE datname = '{url.database}'"
        )
    ]
    assert backends
    monkeypatch.setattr(postgresql_connections, "ANSWER_S", 0.5)
    try:
        for pid in backends:
            os.kill(pid, signal.SIGSTOP)
        # The stopped connection is given up by the pool's ping, the new one over its statement.
        with pytest.raises(SQLAlchemyError) as raised, engine.connect() as connection:
            connection.exec_driver_sql("SELECT pg_sleep(60)")
        assert failure_of(raised.value) is StoreFailure.UNAVAILABLE
    finally:
        for pid in backends:
            os.kill(pid, signal.SIGCONT)
    store.check()
    engine.dispose()


def test_a_full_sqlite_is_full(tmp_path: Path) -> None:
    engine = open_engine(make_url(f"sqlite:///{tmp_path / 'prunus.sqlite3'}"))
    with engine.connect() as connection:
        connection.exec_driver_sql("PRAGMA max_page_count = 1")
    with pytest.raises(SQLAlchemyError) as raised:
        PlanStore(engine).add(ID, robot="tabletop", request="{}", answer="x" * 10_000_000)
    assert failure_of(raised.value) is StoreFailure.FULL
    assert ExecutionStore(engine).active() == []
    assert PlanStore(engine).plan(ID) is None
    engine.dispose()
