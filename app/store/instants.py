"""Instants as databases give them back."""

from datetime import UTC, datetime
from typing import overload


@overload
def utc(instant: datetime) -> datetime: ...
@overload
def utc(instant: None) -> None: ...
def utc(instant: datetime | None) -> datetime | None:
    """The instant in UTC: SQLite keeps no time zone; PostgreSQL gives back the session's."""
    if instant is None:
        return None
    return instant.replace(tzinfo=UTC) if instant.tzinfo is None else instant.astimezone(UTC)
