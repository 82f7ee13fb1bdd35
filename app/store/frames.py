"""The table of frames."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from sqlalchemy import Engine, delete, func, insert, select, update
from sqlalchemy.exc import IntegrityError

from app.store.database import writing
from app.store.idempotency import CREATED, NewKey, insert_key, new_entry
from app.store.instants import utc
from app.store.tables import FRAMES

MOST_FRAMES = 1000
"""Frames that are kept; a farm has a few cameras, and a list must stay readable."""


class FramesFull(Exception):
    """MOST_FRAMES are stored; nothing was added."""


@dataclass(frozen=True)
class StoredFrame:
    """A frame as it was stored just now.

    Attributes:
        document: the JSON that clients get.
        is_new: whether nothing was stored under its name before.
    """

    document: str
    is_new: bool


class FrameStore:
    """Frames by name. Its calls block: keep them off the event loop."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def put(
        self,
        name: str,
        document: Callable[[datetime, datetime], str],
        key: NewKey | None = None,
        location: str = "",
    ) -> StoredFrame:
        """Store a frame in place of what had its name; it is durable when this returns.

        Args:
            name: of the frame.
            document: makes the JSON from when the name was created and when this was stored, UTC.
            key: that it was asked for under, stored with it; the answer is 201 with the document.
            location: of the frame, for that answer.

        Raises:
            KeyTaken: something was created under the key before; nothing was stored.
            FramesFull: the name is new, and there are too many.
        """
        try:
            return self._put(name, document, key, location)
        except IntegrityError:
            # Somebody else was first to add it, so this time it is there to be replaced.
            return self._put(name, document, key, location)

    def _put(
        self,
        name: str,
        document: Callable[[datetime, datetime], str],
        key: NewKey | None,
        location: str,
    ) -> StoredFrame:
        now = datetime.now(UTC)
        there = select(FRAMES.c.created_at).where(FRAMES.c.name == name).with_for_update()
        with writing(self._engine) as connection:
            created_at = connection.execute(there).scalar_one_or_none()
            if created_at is not None:
                text = document(utc(created_at), now)
                insert_key(connection, new_entry(key, CREATED, location, text))
                changes = update(FRAMES).where(FRAMES.c.name == name)
                connection.execute(changes.values(updated_at=now, document=text))
                return StoredFrame(text, is_new=False)
            count = connection.execute(select(func.count()).select_from(FRAMES)).scalar_one()
            if count >= MOST_FRAMES:
                raise FramesFull
            text = document(now, now)
            insert_key(connection, new_entry(key, CREATED, location, text))
            row = {"name": name, "created_at": now, "updated_at": now, "document": text}
            connection.execute(insert(FRAMES), row)
            return StoredFrame(text, is_new=True)

    def document(self, name: str) -> str | None:
        """The document of that name, or None."""
        query = select(FRAMES.c.document).where(FRAMES.c.name == name)
        with self._engine.connect() as connection:
            return connection.execute(query).scalar_one_or_none()

    def documents(self) -> Sequence[str]:
        """Every document, by name."""
        query = select(FRAMES.c.name, FRAMES.c.document)
        with self._engine.connect() as connection:
            # Sorted here: how databases sort text depends on how they were set up.
            rows = sorted((row.name, row.document) for row in connection.execute(query))
        return [document for _, document in rows]

    def remove(self, name: str) -> bool:
        """Whether there was a frame of that name; now there is none."""
        with writing(self._engine) as connection:
            return connection.execute(delete(FRAMES).where(FRAMES.c.name == name)).rowcount > 0
