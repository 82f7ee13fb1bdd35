"""How many rows of which status there are."""

from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy import Engine, Table, func, select

from app.store.tables import EXECUTIONS, JOBS


@dataclass(frozen=True)
class StoredCounts:
    """Jobs and executions by status."""

    jobs: Mapping[str, int]
    executions: Mapping[str, int]


def stored_counts(engine: Engine) -> StoredCounts:
    """Count them; this blocks.

    Raises:
        sqlalchemy.exc.SQLAlchemyError: the database does not answer.
    """
    return StoredCounts(_by_status(engine, JOBS), _by_status(engine, EXECUTIONS))


def _by_status(engine: Engine, table: Table) -> dict[str, int]:
    query = select(table.c.status, func.count()).group_by(table.c.status)
    with engine.connect() as connection:
        return {status: count for status, count in connection.execute(query)}
