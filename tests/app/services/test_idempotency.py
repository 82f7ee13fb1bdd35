"""At most once, against a model: any sequence, any interleaving, two services on one database."""

import asyncio
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sqlalchemy import URL, Engine

from app.services.exceptions import ServiceError, Unavailable
from app.services.idempotency import IdempotencyService
from app.store import (
    IdempotencyStore,
    KeyedAnswer,
    NewKey,
    PlanStore,
    new_entry,
    open_engine,
)


@pytest.fixture(scope="module")
def engine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Engine]:
    folder: Path = tmp_path_factory.mktemp("keys")
    engine = open_engine(URL.create("sqlite", database=str(folder / "prunus.sqlite3")))
    yield engine
    engine.dispose()


class Services:
    """Some services on one database, and how often each of their routes created something."""

    def __init__(self, engine: Engine, services: int) -> None:
        self._plans = PlanStore(engine)
        self._scope = f"POST /{_fresh()}"
        self._services = [IdempotencyService(IdempotencyStore(engine)) for _ in range(services)]
        self.stored: list[str] = []

    async def send(self, service: int, key: str, body: str, fails: bool) -> str:
        """The id of the plan that a request is answered with, or the code of the refusal."""
        new_key = NewKey(self._scope, key, body)

        async def create() -> KeyedAnswer:
            await asyncio.sleep(0)
            if fails:
                raise Unavailable("solver_unavailable", "")
            plan_id = _fresh()
            entry = new_entry(new_key, 201, plan_id)
            await asyncio.to_thread(
                self._plans.add, plan_id, robot="r", request=body, answer="{}", key=entry
            )
            self.stored.append(plan_id)
            return KeyedAnswer(201, plan_id)

        try:
            return (await self._services[service].once(new_key, create)).location
        except ServiceError as error:
            return error.code


_numbers = iter(range(1, 10**9))


def _fresh() -> str:
    return f"{next(_numbers):032x}"


REQUESTS = st.lists(
    st.tuples(st.integers(0, 1), st.sampled_from("ab"), st.sampled_from("xyz"), st.booleans()),
    max_size=8,
)


@given(REQUESTS)
def test_one_after_the_other_is_what_the_model_says(
    engine: Engine, requests: list[tuple[int, str, str, bool]]
) -> None:
    async def run() -> None:
        services = Services(engine, 2)
        model: dict[str, tuple[str, str]] = {}
        for service, key, body, fails in requests:
            answer = await services.send(service, key, body, fails)
            if key not in model and fails:
                assert answer == "solver_unavailable"
            elif key not in model:
                model[key] = (body, answer)
            else:
                assert answer == (
                    model[key][1] if model[key][0] == body else "idempotency_key_reused"
                )
        assert services.stored == [plan_id for _, plan_id in model.values()]

    asyncio.run(run())


@given(REQUESTS)
def test_at_once_nothing_is_created_twice(
    engine: Engine, requests: list[tuple[int, str, str, bool]]
) -> None:
    async def run() -> None:
        services = Services(engine, 2)
        answers = await asyncio.gather(*(services.send(*request) for request in requests))
        given_ids = {
            (key, answer)
            for (_, key, _, _), answer in zip(requests, answers, strict=True)
            if answer in services.stored
        }
        # Every plan was answered, under one key; every key has one plan at most.
        assert sorted(answer for _, answer in given_ids) == sorted(services.stored)
        assert len({key for key, _ in given_ids}) == len(given_ids)
        for (_, key, body, fails), answer in zip(requests, answers, strict=True):
            if answer not in services.stored:
                assert answer in ("idempotency_key_reused", "solver_unavailable")
                assert fails or answer == "idempotency_key_reused"
                others = [b for _, k, b, f in requests if k == key and not f]
                assert fails or any(other != body for other in others)

    asyncio.run(run())
