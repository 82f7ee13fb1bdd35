"""What it means when the database fails: it is not there now, it is full, or it is a defect."""

import errno
import os
import sqlite3
from enum import Enum
from typing import Final

import psycopg
from sqlalchemy.exc import DBAPIError, SQLAlchemyError, TimeoutError

# The class of SQLSTATE, by its first two characters, of what passes: lost connections,
# authentication, no resources, an operator's intervention, trouble outside, an object in use.
PASSING_CLASSES: Final = frozenset({"08", "28", "53", "57", "58", "55", "40"})
DISK_FULL: Final = "53100"
READ_ONLY: Final = "25006"
# A database that is being restored, or made by another, is not there yet.
NO_SUCH_DATABASE: Final = "3D000"
PASSING_SQLITE: Final = frozenset(
    {
        sqlite3.SQLITE_BUSY,
        sqlite3.SQLITE_LOCKED,
        sqlite3.SQLITE_IOERR,
        sqlite3.SQLITE_READONLY,
        sqlite3.SQLITE_CANTOPEN,
        sqlite3.SQLITE_PERM,
        sqlite3.SQLITE_PROTOCOL,
        sqlite3.SQLITE_NOMEM,
        sqlite3.SQLITE_CORRUPT,
        sqlite3.SQLITE_NOTADB,
    }
)
_PRIMARY_CODE: Final = 0xFF
# With a limit on a file's size, or a quota, SQLite's answer to a write is an I/O error.
_FULL_IO: Final = frozenset({sqlite3.SQLITE_IOERR_WRITE})


class StoreFailure(Enum):
    """What a client can make of it."""

    UNAVAILABLE = "unavailable"
    FULL = "full"
    DEFECT = "defect"


class StoreBusy(SQLAlchemyError):
    """All that may wait for the database are waiting already."""


def failure_of(error: SQLAlchemyError) -> StoreFailure:
    """What has failed."""
    if isinstance(error, StoreBusy | TimeoutError):
        return StoreFailure.UNAVAILABLE
    if not isinstance(error, DBAPIError):
        return StoreFailure.DEFECT
    cause = error.orig
    if isinstance(cause, sqlite3.Error):
        return _of_sqlite(cause)
    if isinstance(cause, psycopg.Error):
        return _of_postgresql(cause, lost=error.connection_invalidated)
    return StoreFailure.DEFECT


def cause_of(error: SQLAlchemyError) -> str:
    """In a line, for the log or an operator, without the statement."""
    cause = error.orig if isinstance(error, DBAPIError) else error
    return " ".join(str(cause).split())


def _of_sqlite(cause: sqlite3.Error) -> StoreFailure:
    code = getattr(cause, "sqlite_errorcode", 0)
    if code & _PRIMARY_CODE == sqlite3.SQLITE_FULL or code in _FULL_IO:
        return StoreFailure.FULL
    passing = code & _PRIMARY_CODE in PASSING_SQLITE
    return StoreFailure.UNAVAILABLE if passing else StoreFailure.DEFECT


def _of_postgresql(cause: psycopg.Error, *, lost: bool) -> StoreFailure:
    state = cause.sqlstate or ""
    if state == DISK_FULL or (state.startswith("58") and _says_full(str(cause))):
        return StoreFailure.FULL
    if state[:2] in PASSING_CLASSES or state in (READ_ONLY, NO_SUCH_DATABASE) or lost:
        return StoreFailure.UNAVAILABLE
    # Without a state it is the driver's own: no server, or it went away.
    no_server = not state and isinstance(cause, psycopg.OperationalError | psycopg.InterfaceError)
    return StoreFailure.UNAVAILABLE if no_server else StoreFailure.DEFECT


def _says_full(text: str) -> bool:
    # PostgreSQL passes the operating system's words on.
    full = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
    return any(os.strerror(number) in text for number in full)
