"""A key is stored with what was created under it, or not at all."""

from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from uuid import uuid4

import pytest
from sqlalchemy import URL, Engine, func, select

from app.store import (
    ComparisonStore,
    ExecutionStore,
    IdempotencyStore,
    KeyTaken,
    NewEntry,
    NewKey,
    PlanStore,
    RobotBusy,
    new_entry,
    open_engine,
)
from app.store.tables import COMPARISONS, EXECUTIONS, IDEMPOTENCY_KEYS, PLANS

NOW = datetime(2026, 5, 1, 12, tzinfo=UTC)


@pytest.fixture(scope="module")
def engine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Engine]:
    folder: Path = tmp_path_factory.mktemp("keys")
    engine = open_engine(URL.create("sqlite", database=str(folder / "prunus.sqlite3")))
    yield engine
    engine.dispose()


def _entry() -> NewEntry:
    entry = new_entry(NewKey("POST /", uuid4().hex, "digest"), 201, "/1", "{}")
    assert entry is not None
    return entry


def _count(engine: Engine) -> list[int]:
    tables = (PLANS, EXECUTIONS, COMPARISONS, IDEMPOTENCY_KEYS)
    with engine.connect() as connection:
        return [connection.scalar(select(func.count()).select_from(table)) or 0 for table in tables]


def _add(engine: Engine, kind: str, robot: str, entry: NewEntry) -> None:
    if kind == "plan":
        PlanStore(engine).add(uuid4().hex, robot=robot, request="{}", answer="{}", key=entry)
    elif kind == "comparison":
        ComparisonStore(engine).add(uuid4().hex, scenario="s", document="{}", key=entry)
    else:
        ExecutionStore(engine).add(
            uuid4().hex, plan_id=uuid4().hex, robot=robot, status="queued", created_at=NOW,
            document="{}", key=entry,
        )  # fmt: skip


@pytest.mark.parametrize("kind", ["plan", "comparison", "execution"])
def test_a_taken_key_stores_nothing_of_what_it_was_for(engine: Engine, kind: str) -> None:
    entry = _entry()
    _add(engine, kind, kind, entry)
    before = _count(engine)
    # Of a duplicate it is not said that the robot is busy, although it is, with the first.
    with pytest.raises(KeyTaken):
        _add(engine, kind, kind, entry)
    assert _count(engine) == before


def test_what_was_not_created_leaves_no_key(engine: Engine) -> None:
    _add(engine, "execution", "busy", _entry())
    before, entry = _count(engine), _entry()
    with pytest.raises(RobotBusy):
        _add(engine, "execution", "busy", entry)
    assert _count(engine) == before
    _add(engine, "execution", "idle", entry)
    stored = IdempotencyStore(engine).find(entry.key.scope, entry.key.key)
    assert stored is not None
    assert (stored.digest, stored.answer) == (entry.key.digest, entry.answer)
