import asyncio
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import URL
from sqlalchemy.exc import OperationalError

from app.observation.logs import LogOptions
from app.observation.metrics import Metrics
from app.services.jobs.service import JobService
from app.services.plans.batch_reading import JobOrder
from app.store import JobStore, open_engine


def test_a_job_whose_commit_is_in_doubt_is_worked_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    engine = open_engine(URL.create("sqlite", database=str(tmp_path / "it.sqlite3")))
    store = JobStore(engine)
    add = store.add

    def add_and_lose_the_answer(*args: Any, **kwargs: Any) -> None:
        add(*args, **kwargs)
        raise OperationalError("COMMIT", {}, Exception("the connection was lost"))

    monkeypatch.setattr(store, "add", add_and_lose_the_answer)

    async def create() -> int:
        service = JobService(
            store, workers=1, most_waiting=3, logs=LogOptions(), measures=Metrics("1"),
            stopping=asyncio.Event(),
        )  # fmt: skip
        with pytest.raises(OperationalError):
            await service.create(JobOrder("tabletop", 2, "{}"), lambda _: "{}", None)
        return service._queue.qsize()

    assert asyncio.run(create()) == len(store.active()) == 1
    engine.dispose()
