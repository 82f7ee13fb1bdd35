"""Connections to PostgreSQL that never wait for ever, whatever the server or the network does."""

import time
from collections.abc import Generator
from typing import Any

import psycopg

CONNECT_S = 5
# The server itself gives up a statement, or a lock, after these.
STATEMENT_MS = 10_000
LOCK_MS = 5_000
# What a server that is stopped or cut off does not do, the client does: it closes the connection.
ANSWER_S = 15.0
# How soon the server notices that a client's machine is gone, with all its locks: 25 s.
KEEPALIVE_IDLE_S, KEEPALIVE_INTERVAL_S, KEEPALIVES = 10, 5, 3


class BoundedConnection(psycopg.Connection[Any]):
    """A connection that is closed when the server says nothing for `ANSWER_S` seconds."""

    def wait(self, gen: Any, *args: Any, **kwargs: Any) -> Any:
        """Wait for a generator of the driver, but not for ever."""
        return super().wait(self._bounded(gen), *args, **kwargs)

    def _bounded(self, gen: Any) -> Generator[Any, Any, Any]:
        deadline = time.monotonic() + ANSWER_S
        try:
            awaited = next(gen)
            while True:
                ready = yield awaited
                if not ready and time.monotonic() > deadline:
                    self.close()
                    raise psycopg.OperationalError(f"no answer within {ANSWER_S:g} s")
                awaited = gen.send(ready)
        except StopIteration as end:
            return end.value


def connect_postgresql(_: Any, __: Any, arguments: Any, parameters: dict[str, Any]) -> Any:
    """Make a connection; a listener of SQLAlchemy's event `do_connect`."""
    timeouts = {
        "statement_timeout": STATEMENT_MS,
        "lock_timeout": LOCK_MS,
        "idle_in_transaction_session_timeout": STATEMENT_MS,
        "tcp_keepalives_idle": KEEPALIVE_IDLE_S,
        "tcp_keepalives_interval": KEEPALIVE_INTERVAL_S,
        "tcp_keepalives_count": KEEPALIVES,
    }
    ours = " ".join(f"-c {name}={value}" for name, value in timeouts.items())
    given: dict[str, Any] = {
        "connect_timeout": CONNECT_S,
        "application_name": "prunus",
    } | parameters
    # An operator's own options come last, and so prevail.
    given["options"] = f"{ours} {given.get('options', '')}".strip()
    return BoundedConnection.connect(*arguments, **given)
