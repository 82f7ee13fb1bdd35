"""The table of executions."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Engine, insert, select, update
from sqlalchemy.exc import IntegrityError

from app.store.database import writing
from app.store.idempotency import NewEntry, insert_key
from app.store.instants import utc
from app.store.plans import ID
from app.store.tables import EXECUTIONS

MOST_LISTED = 50


class RobotBusy(Exception):
    """The robot has an active execution already."""

    def __init__(self, robot: str) -> None:
        super().__init__(robot)
        self.robot = robot


@dataclass(frozen=True)
class ExecutionRow:
    """An execution in a list. The times are in UTC."""

    id: str
    plan_id: str
    robot: str
    status: str
    created_at: datetime
    updated_at: datetime


class ExecutionStore:
    """Executions as they stand. Its calls block: keep them off the event loop.

    What was written is durable when a call returns. Documents are the JSON that clients get.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def add(
        self,
        execution_id: str,
        *,
        plan_id: str,
        robot: str,
        status: str,
        created_at: datetime,
        document: str,
        key: NewEntry | None = None,
    ) -> None:
        """Store a new execution, which is active, with the key it was asked for under.

        Raises:
            KeyTaken: something was created under the key before; nothing was stored.
            RobotBusy: the robot has an active one; nothing was stored.
        """
        row = {
            "id": execution_id,
            "plan_id": plan_id,
            "robot": robot,
            "status": status,
            "created_at": created_at,
            "updated_at": created_at,
            "active_robot": robot,
            "document": document,
        }
        try:
            with writing(self._engine) as connection:
                insert_key(connection, key)
                connection.execute(insert(EXECUTIONS), row)
        except IntegrityError as error:
            raise RobotBusy(robot) from error

    def save(self, execution_id: str, *, status: str, document: str, ended: bool) -> None:
        """Store how an execution stands now; one that has ended leaves its robot free."""
        changes: dict[str, Any] = {
            "status": status,
            "document": document,
            "updated_at": datetime.now(UTC),
        }
        if ended:
            changes["active_robot"] = None
        with writing(self._engine) as connection:
            connection.execute(
                update(EXECUTIONS).where(EXECUTIONS.c.id == execution_id).values(**changes)
            )

    def document(self, execution_id: str) -> str | None:
        """The document of that id, or None."""
        if not ID.fullmatch(execution_id):
            return None
        with self._engine.connect() as connection:
            query = select(EXECUTIONS.c.document).where(EXECUTIONS.c.id == execution_id)
            return connection.execute(query).scalar_one_or_none()

    def active(self) -> Sequence[str]:
        """The documents of all that have not ended."""
        query = select(EXECUTIONS.c.document).where(EXECUTIONS.c.active_robot.is_not(None))
        with self._engine.connect() as connection:
            return connection.execute(query).scalars().all()

    def newest(self, robot: str = "") -> list[ExecutionRow]:
        """The newest ones, newest first: of a robot, or of all."""
        if "\0" in robot:
            return []  # no robot's name has one, and PostgreSQL would refuse the question
        columns = [EXECUTIONS.c[name] for name in ExecutionRow.__dataclass_fields__]
        query = select(*columns).order_by(EXECUTIONS.c.created_at.desc(), EXECUTIONS.c.id)
        if robot:
            query = query.where(EXECUTIONS.c.robot == robot)
        with self._engine.connect() as connection:
            rows = connection.execute(query.limit(MOST_LISTED)).all()
        return [
            ExecutionRow(
                row.id, row.plan_id, row.robot, row.status, utc(row.created_at),
                utc(row.updated_at),
            )
            for row in rows
        ]  # fmt: skip
