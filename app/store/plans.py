"""The table of plans."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import count

from sqlalchemy import Engine, insert, select

from app.store.database import writing
from app.store.idempotency import NewEntry, insert_key
from app.store.tables import PLAN_PARTS, PLANS

ID = re.compile(r"[0-9a-f]{32}")


@dataclass(frozen=True)
class StoredPlan:
    """A plan's answer with the request that it answers, both JSON.

    Attributes:
        in_parts: the answer has no `approaches`; they are in the parts of the plan.
    """

    request: str
    answer: str
    in_parts: bool = False


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
        with writing(self._engine) as connection:
            insert_key(connection, key)
            connection.execute(insert(PLANS), row)

    def plan(self, plan_id: str) -> StoredPlan | None:
        """The plan of that id, or None."""
        if not ID.fullmatch(plan_id):
            return None
        with self._engine.connect() as connection:
            query = select(PLANS.c.request, PLANS.c.answer, PLANS.c.in_parts).where(
                PLANS.c.id == plan_id
            )
            row = connection.execute(query).one_or_none()
        return None if row is None else StoredPlan(row.request, row.answer, row.in_parts)

    def part(self, plan_id: str, number: int) -> str | None:
        """The approaches of a part as a JSON array, or None: there is no such part yet."""
        query = select(PLAN_PARTS.c.approaches).where(
            PLAN_PARTS.c.plan_id == plan_id, PLAN_PARTS.c.number == number
        )
        with self._engine.connect() as connection:
            return connection.execute(query).scalar_one_or_none()

    def parts(self, plan_id: str) -> Iterator[str]:
        """The parts of a plan or job as far as they are there, in order, JSON arrays."""
        for number in count():
            approaches = self.part(plan_id, number)
            if approaches is None:
                return
            yield approaches

    def check(self) -> None:
        """Raise SQLAlchemyError unless the database answers."""
        with self._engine.connect() as connection:
            connection.execute(select(PLANS.c.id).limit(1))
