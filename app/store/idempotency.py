"""The table of idempotency keys: what was created under which key, and how it was answered."""

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Final

from sqlalchemy import Connection, Engine, insert, select
from sqlalchemy.exc import IntegrityError

from app.store.tables import IDEMPOTENCY_KEYS

CREATED: Final = 201
"""The status of the answer to a request that has created something."""

ACCEPTED: Final = 202
"""The same, for what is still to be done."""


class KeyTaken(Exception):
    """Something was created under this key before; nothing was stored now."""


@dataclass(frozen=True)
class KeyedAnswer:
    """What a request with a key is answered, now and whenever it comes again.

    Attributes:
        status: the HTTP status.
        location: path of what was created.
        body: JSON; None where what is stored under `location` is the body.
    """

    status: int
    location: str
    body: str | None = None


@dataclass(frozen=True)
class NewKey:
    """A key under which nothing has been created yet.

    Attributes:
        scope: within which a key means one request: method, path and client.
        digest: SHA-256 of the request's body, hexadecimal.
    """

    scope: str
    key: str
    digest: str


@dataclass(frozen=True)
class NewEntry:
    """A key with its answer, to be stored with what was created and never without it."""

    key: NewKey
    answer: KeyedAnswer


def new_entry(
    key: NewKey | None, status: int, location: str, body: str | None = None
) -> NewEntry | None:
    """The entry for what is being created under a key, see `KeyedAnswer`; None without a key."""
    return None if key is None else NewEntry(key, KeyedAnswer(status, location, body))


@dataclass(frozen=True)
class StoredEntry:
    """What is stored under a key; `digest` is that of the body it was created from."""

    digest: str
    answer: KeyedAnswer


def insert_key(connection: Connection, entry: NewEntry | None) -> None:
    """Add a key to the transaction that creates what it stands for; None adds nothing.

    It goes first: whoever is second then learns that it is a duplicate, and not that, say, the
    robot is busy with the first.

    Raises:
        KeyTaken: another service on this database was first; the transaction must be given up.
    """
    if entry is None:
        return
    row = {
        "scope": entry.key.scope,
        "key": entry.key.key,
        "digest": entry.key.digest,
        "created_at": datetime.now(UTC),
        "status": entry.answer.status,
        "location": entry.answer.location,
        "body": entry.answer.body,
    }
    try:
        connection.execute(insert(IDEMPOTENCY_KEYS), row)
    except IntegrityError as error:
        raise KeyTaken from error


class IdempotencyStore:
    """Keys that were used. Its calls block: keep them off the event loop."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def find(self, scope: str, key: str) -> StoredEntry | None:
        """What is stored under a key, or None."""
        table = IDEMPOTENCY_KEYS.c
        query = select(table.digest, table.status, table.location, table.body).where(
            table.scope == scope, table.key == key
        )
        with self._engine.connect() as connection:
            row = connection.execute(query).one_or_none()
        if row is None:
            return None
        return StoredEntry(row.digest, KeyedAnswer(row.status, row.location, row.body))
