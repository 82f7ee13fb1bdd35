"""The engine: SQLite made durable and safe for many processes, or PostgreSQL by URL."""

import contextlib
import threading
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Any

from alembic import command
from alembic.config import Config
from sqlalchemy import URL, Connection, Engine, create_engine, event

from app.store.failures import StoreBusy
from app.store.postgresql import connect_postgresql

# A writing transaction lasts milliseconds; one that waits longer than this waits for something
# that does not end by itself, and its client is better told so.
BUSY_TIMEOUT_MS = 5_000
# After a burst under many readers the write-ahead log is cut back to this.
WAL_KEPT_BYTES = 64 * 1024 * 1024
# As many as `app.services.store_calls` lets wait in the database, and a few for the rest.
POOL_SIZE = 16
POOL_WAIT_S = 5.0


def open_engine(url: URL) -> Engine:
    """An engine with the schema at its newest version.

    Raises:
        sqlalchemy.exc.SQLAlchemyError: the database cannot be used now.
        alembic.util.CommandError: it was made by a newer Prunus.
        OSError: its folder cannot be made.
    """
    engine = create_store_engine(url)
    try:
        with writing(engine) as connection:
            migrate(connection)
    except BaseException:
        engine.dispose()
        raise
    return engine


def create_store_engine(url: URL) -> Engine:
    """An engine for a database as it stands."""
    sqlite = url.get_backend_name() == "sqlite"
    if sqlite and url.database:
        Path(url.database).parent.mkdir(parents=True, exist_ok=True)
    engine = create_engine(
        url,
        pool_pre_ping=not sqlite,
        pool_size=POOL_SIZE,
        max_overflow=0,
        pool_timeout=POOL_WAIT_S,
        hide_parameters=True,  # plans and hashes of tokens do not belong in a log
    )
    if sqlite:
        engine.update_execution_options(prunus_turn=threading.Lock())
        event.listen(engine, "connect", _configure_sqlite)
        event.listen(engine, "begin", _begin_sqlite)
    else:
        event.listen(engine, "do_connect", connect_postgresql)
    return engine


@contextlib.contextmanager
def writing(engine: Engine) -> Iterator[Connection]:
    """A transaction that writes; it is durable when the block ends, and undone when that raises.

    SQLite lets one write at a time, and has the others ask again after sleeps of up to 100 ms. So
    those of one engine take turns before they ask; other processes are left to SQLite.

    Raises:
        StoreBusy: it did not come to its turn; nothing was begun.
    """
    turn: threading.Lock | None = engine.get_execution_options().get("prunus_turn")
    if turn is not None and not turn.acquire(timeout=BUSY_TIMEOUT_MS / 1e3):
        raise StoreBusy(f"others have been waiting to write for {BUSY_TIMEOUT_MS} ms")
    try:
        with engine.execution_options(prunus_writes=True).begin() as connection:
            yield connection
    finally:
        if turn is not None:
            turn.release()


def _configure_sqlite(connection: Any, _: Any) -> None:
    # The driver's own BEGIN comes too late and only before some statements; see _begin_sqlite.
    connection.isolation_level = None
    cursor = connection.cursor()
    cursor.execute(f"PRAGMA busy_timeout = {BUSY_TIMEOUT_MS}")
    cursor.execute("PRAGMA journal_mode = WAL")
    cursor.execute(f"PRAGMA journal_size_limit = {WAL_KEPT_BYTES}")
    cursor.execute("PRAGMA synchronous = FULL")
    cursor.execute("PRAGMA foreign_keys = ON")
    cursor.close()


def _begin_sqlite(connection: Connection) -> None:
    # A deferred transaction that turns into a writing one fails at once when another writes.
    writes = connection.get_execution_options().get("prunus_writes", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")


def migrate(connection: Connection, revision: str = "head") -> None:
    """Bring the database up to a version of the schema."""
    config = Config()
    config.set_main_option("path_separator", "os")
    with resources.as_file(resources.files("app.store") / "migrations") as folder:
        config.set_main_option("script_location", str(folder).replace("%", "%%"))
        config.attributes["connection"] = connection
        command.upgrade(config, revision)
