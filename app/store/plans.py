"""The table of plans."""

import re
from dataclasses import dataclass
from datetime import UTC, datetime

from sqlalchemy import Engine, insert, select

from app.store.database import writing
from app.store.idempotency import NewEntry, insert_key
from app.store.tables import PLANS

ID = re.compile(r"[0-9a-f]{32}")


@dataclass(frozen=True)
class StoredPlan:
    """A plan's answer with the request that it answers, both JSON."""

    request: str
    answer: str


class PlanStore:
    """Plans as they were answered. Its calls block: keep them off the event loop."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def add(
        self,
        plan_id: str,
        *,
        robot: str,
        request: str,
        answer: str,
        key: NewEntry | None = None,
    ) -> None:
        """Store a plan, with the key it was asked for under; both are durable when this returns.

        Raises:
            KeyTaken: something was created under the key before; nothing was stored.
        """
        row = {
            "id": plan_id,
            "created_at": datetime.now(UTC),
            "robot": robot,
            "request": request,
            "answer": answer,
        }
        with writing(self._engine).begin() as connection:
            insert_key(connection, key)
            connection.execute(insert(PLANS), row)

    def answer(self, plan_id: str) -> str | None:
        """The answer of that id, or None."""
        plan = self.plan(plan_id)
        return None if plan is None else plan.answer

    def plan(self, plan_id: str) -> StoredPlan | None:
        """The plan of that id, or None."""
        if not ID.fullmatch(plan_id):
            return None
        with self._engine.connect() as connection:
            query = select(PLANS.c.request, PLANS.c.answer).where(PLANS.c.id == plan_id)
            row = connection.execute(query).one_or_none()
        return None if row is None else StoredPlan(row.request, row.answer)

    def check(self) -> None:
        """Raise SQLAlchemyError unless the database answers."""
        with self._engine.connect() as connection:
            connection.execute(select(PLANS.c.id).limit(1))
