"""The table of plans."""

import re
from datetime import UTC, datetime

from sqlalchemy import URL, Column, DateTime, Engine, MetaData, String, Table, Text, insert, select

from app.store.database import open_engine, writing

METADATA = MetaData()
PLANS = Table(
    "plans",
    METADATA,
    Column("id", String(32), primary_key=True),
    Column("created_at", DateTime(timezone=True), nullable=False),
    Column("robot", String(200), nullable=False),
    Column("request", Text, nullable=False),
    Column("answer", Text, nullable=False),
)
PLAN_ID = re.compile(r"[0-9a-f]{32}")


class PlanStore:
    """Plans as they were answered. Its calls block: keep them off the event loop."""

    def __init__(self, url: URL) -> None:
        self._engine: Engine = open_engine(url)

    def add(self, plan_id: str, *, robot: str, request: str, answer: str) -> None:
        """Store a plan; it is durable when this returns."""
        row = {
            "id": plan_id,
            "created_at": datetime.now(UTC),
            "robot": robot,
            "request": request,
            "answer": answer,
        }
        with writing(self._engine).begin() as connection:
            connection.execute(insert(PLANS), row)

    def answer(self, plan_id: str) -> str | None:
        """The answer of that id, or None."""
        if not PLAN_ID.fullmatch(plan_id):
            return None
        with self._engine.connect() as connection:
            query = select(PLANS.c.answer).where(PLANS.c.id == plan_id)
            return connection.execute(query).scalar_one_or_none()

    def check(self) -> None:
        """Raise SQLAlchemyError unless the database answers."""
        with self._engine.connect() as connection:
            connection.execute(select(PLANS.c.id).limit(1))

    def close(self) -> None:
        """Close the connections."""
        self._engine.dispose()
