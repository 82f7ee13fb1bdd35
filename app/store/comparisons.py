"""The table of comparisons."""

from collections.abc import Sequence
from datetime import UTC, datetime

from sqlalchemy import Engine, func, insert, select, update

from app.store.database import writing
from app.store.idempotency import NewEntry, insert_key
from app.store.plans import ID
from app.store.tables import COMPARISONS


class ComparisonStore:
    """Comparisons as they stand. Its calls block: keep them off the event loop.

    Documents are the JSON that clients get, without the progress; pages are HTML.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def add(
        self, comparison_id: str, *, scenario: str, document: str, key: NewEntry | None = None
    ) -> None:
        """Store a new comparison, which is active, with the key it was asked for under.

        Raises:
            KeyTaken: something was created under the key before; nothing was stored.
        """
        now = datetime.now(UTC)
        row = {
            "id": comparison_id,
            "scenario": scenario,
            "active": True,
            "created_at": now,
            "updated_at": now,
            "document": document,
        }
        with writing(self._engine) as connection:
            insert_key(connection, key)
            connection.execute(insert(COMPARISONS), row)

    def save(
        self, comparison_id: str, *, document: str, ended: bool, page: str | None = None
    ) -> None:
        """Store how a comparison stands now, with its page when it is complete."""
        changes = {
            "document": document,
            "active": not ended,
            "page": page,
            "updated_at": datetime.now(UTC),
        }
        with writing(self._engine) as connection:
            connection.execute(
                update(COMPARISONS).where(COMPARISONS.c.id == comparison_id).values(**changes)
            )

    def document(self, comparison_id: str) -> str | None:
        """The document of that id, or None."""
        if not ID.fullmatch(comparison_id):
            return None
        query = select(COMPARISONS.c.document).where(COMPARISONS.c.id == comparison_id)
        with self._engine.connect() as connection:
            return connection.execute(query).scalar_one_or_none()

    def page(self, comparison_id: str) -> str | None:
        """The page of a complete comparison, or None."""
        if not ID.fullmatch(comparison_id):
            return None
        query = select(COMPARISONS.c.page).where(COMPARISONS.c.id == comparison_id)
        with self._engine.connect() as connection:
            return connection.execute(query).scalar_one_or_none()

    def active(self) -> Sequence[str]:
        """The documents of all that have not ended."""
        query = select(COMPARISONS.c.document).where(COMPARISONS.c.active)
        with self._engine.connect() as connection:
            return connection.execute(query).scalars().all()

    def count_active(self) -> int:
        """How many have not ended."""
        query = select(func.count()).select_from(COMPARISONS).where(COMPARISONS.c.active)
        with self._engine.connect() as connection:
            return connection.execute(query).scalar_one()
