"""One service a database: two would both take up its jobs and executions."""

import fcntl
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final, Protocol

from sqlalchemy import URL, Connection, NullPool, create_engine, event, text
from sqlalchemy.exc import SQLAlchemyError

from app.store.postgresql import connect_postgresql

# "prunus" in ASCII: nobody else's advisory lock in the same database.
LOCK_KEY: Final = 0x7072756E7573
LOCK_SUFFIX: Final = ".lock"
CHECK_S: Final = 1.0


class DatabaseInUse(Exception):
    """Another service has this database."""


class Hold(Protocol):
    """That this service has its database to itself."""

    def release(self) -> None:
        """Give it up."""


def hold_database(url: URL, on_lost: Callable[[], None]) -> Hold:
    """Take a database for this service alone, until it is released or the process ends.

    Args:
        url: the database's.
        on_lost: called from another thread when another service has it now.

    Raises:
        DatabaseInUse: another service has it.
        OSError: the lock file cannot be made.
        sqlalchemy.exc.SQLAlchemyError: PostgreSQL cannot be reached.
    """
    if url.get_backend_name() == "sqlite":
        return _FileHold(Path(f"{url.database}{LOCK_SUFFIX}"))
    return _AdvisoryHold(url, on_lost)


class _FileHold:
    """A lock on a file, which the system drops when the process ends, however it ends."""

    def __init__(self, path: Path) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = path.open("a")
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self._file.close()
            raise DatabaseInUse("another service has this data folder") from None

    def release(self) -> None:
        # The file stays: whoever deletes it may delete another's.
        self._file.close()


class _AdvisoryHold:
    """An advisory lock of PostgreSQL, which lasts as long as a connection.

    A connection that is lost takes the lock with it, so it is looked at every second, and the lock
    taken again as soon as the database is back. Until then this service could not write either.
    """

    def __init__(self, url: URL, on_lost: Callable[[], None]) -> None:
        self._engine = create_engine(url, poolclass=NullPool, isolation_level="AUTOCOMMIT")
        event.listen(self._engine, "do_connect", connect_postgresql)
        self._on_lost = on_lost
        self._released = threading.Event()
        self._connection: Connection | None = self._take()
        self._watcher = threading.Thread(target=self._watch, name="database-hold", daemon=True)
        self._watcher.start()

    def _take(self) -> Connection:
        connection = self._engine.connect()
        taken: Any = connection.scalar(text("SELECT pg_try_advisory_lock(:key)"), {"key": LOCK_KEY})
        if not taken:
            connection.close()
            raise DatabaseInUse("another service has this database")
        return connection

    def _watch(self) -> None:
        while not self._released.wait(CHECK_S):
            try:
                if self._connection is None:
                    self._connection = self._take()
                else:
                    self._connection.scalar(text("SELECT 1"))
            except SQLAlchemyError:
                self._drop()
            except DatabaseInUse:
                self._on_lost()
                return

    def _drop(self) -> None:
        connection, self._connection = self._connection, None
        if connection is not None:
            connection.invalidate()
            connection.close()

    def release(self) -> None:
        self._released.set()
        self._watcher.join()
        self._drop()
        self._engine.dispose()
