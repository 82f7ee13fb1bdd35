"""Migrations: to the tables of now, with what was stored before."""

from datetime import UTC, datetime

from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import URL, Engine, create_engine, text

from app.store import ExecutionStore, PlanStore, open_engine
from app.store.database import migrate
from app.store.tables import METADATA

ID = f"{1:032x}"


def test_migrations_lead_to_the_tables(engine: Engine) -> None:
    with engine.connect() as connection:
        assert compare_metadata(MigrationContext.configure(connection), METADATA) == []


def test_a_database_of_the_first_version_keeps_its_plans(store_url: URL) -> None:
    engine = create_engine(store_url)
    with engine.begin() as connection:
        migrate(connection, "0001")
        connection.execute(
            text("INSERT INTO plans VALUES (:id, :at, 'tabletop', '{}', '[]')"),
            {"id": ID, "at": "2026-01-01 00:00:00"},
        )
    engine.dispose()
    engine = open_engine(store_url)
    plan = PlanStore(engine).plan(ID)
    assert plan is not None
    assert (plan.request, plan.answer) == ("{}", "[]")
    ExecutionStore(engine).add(
        ID, plan_id=ID, robot="tabletop", status="queued", created_at=datetime.now(UTC),
        document="{}",
    )  # fmt: skip
    engine.dispose()
