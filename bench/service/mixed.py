"""Mixed load: clients that plan, read, select, compare, cancel jobs and provoke errors."""

import asyncio
import random
from collections import Counter
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import Final

import orjson

from bench.service.batches import Batches
from bench.service.client import Answer, Client

CLIENTS: Final = 4
PAUSE_S: Final = 0.05
KEPT_PLANS: Final = 50
MOST_NOTES: Final = 20
JOB_TARGETS: Final = 300
COMPARISON: Final = orjson.dumps({"scenario": "data-set-3", "methods": ["as"], "repeats": 1})
SELECTION: Final = orjson.dumps(
    {
        "branches": [
            {
                "id": "b",
                "points_m": [[0.1, 0.0, 0.3], [0.3, 0.0, 0.3]],
                "blossoms": [{"id": str(i), "distance_m": i / 100} for i in range(20)],
            }
        ]
    }
)


@dataclass
class Tally:
    """What was answered."""

    done: Counter[str] = field(default_factory=Counter)
    provoked: Counter[str] = field(default_factory=Counter)
    errors: int = 0
    notes: list[str] = field(default_factory=list)
    plans: list[str] = field(default_factory=list)

    def expect(self, what: str, answer: Answer, *statuses: int) -> bool:
        """Count an answer, as an error unless its status is one of these."""
        if answer.status in statuses:
            self.done[what] += 1
            return True
        self.fail(what, f"{answer.status} {answer.code}")
        return False

    def fail(self, what: str, why: str) -> None:
        """Count an error."""
        self.errors += 1
        if len(self.notes) < MOST_NOTES:
            self.notes.append(f"{what}: {why}")


class _Visitor:
    def __init__(self, client: Client, tally: Tally, seed: int) -> None:
        self._client = client
        self._tally = tally
        self._random = random.Random(seed)
        self._batches = Batches(seed)
        self._actions: list[tuple[int, Callable[[], Awaitable[None]]]] = [
            (40, self._plan), (10, self._batch), (30, self._read), (10, self._select),
            (10, self._provoke), (4, self._look), (4, self._job),
        ]  # fmt: skip

    async def run(self, goes_on: Callable[[Tally], bool]) -> None:
        weights, actions = zip(*self._actions, strict=True)
        while goes_on(self._tally):
            (action,) = self._random.choices(actions, weights)
            try:
                await action()
            except (OSError, asyncio.IncompleteReadError) as error:
                self._tally.fail(action.__name__.strip("_"), type(error).__name__)
            await asyncio.sleep(self._random.uniform(0, 2 * PAUSE_S))

    async def _plan(self) -> None:
        await self._post_plan("plan", self._random.randint(1, 5), self._random.choice(METHODS))

    async def _batch(self) -> None:
        await self._post_plan("batch", self._random.randint(50, 500), "ssas")

    async def _post_plan(self, what: str, count: int, method: str) -> None:
        answer = await self._client.request("POST", "/v1/plans", self._batches.body(count, method))
        if self._tally.expect(what, answer, 201):
            self._tally.plans = [*self._tally.plans[-KEPT_PLANS:], answer.headers["location"]]

    async def _read(self) -> None:
        if self._tally.plans:
            accept = self._random.choice(("application/json", "application/x-ndjson"))
            where = self._random.choice(self._tally.plans)
            answer = await self._client.request("GET", where, headers={"Accept": accept})
            self._tally.expect("read", answer, 200)

    async def _select(self) -> None:
        answer = await self._client.request("POST", "/v1/thinning-selections", SELECTION)
        self._tally.expect("selection", answer, 200)

    async def _look(self) -> None:
        for path in ("/healthz", "/readyz", "/metrics", "/v1/robots", "/v1/executions"):
            self._tally.expect("look", await self._client.request("GET", path), 200)

    async def _provoke(self) -> None:
        method, path, body, status = self._random.choice(PROVOCATIONS)
        answer = await self._client.request(method, path, body)
        if self._tally.expect("provoked", answer, status):
            self._tally.provoked[f"{status} {answer.code}"] += 1

    async def _job(self) -> None:
        body = self._batches.body(JOB_TARGETS, "ncos")
        prefer = {"Prefer": "respond-async"}
        answer = await self._client.request("POST", "/v1/plans", body, prefer)
        if not self._tally.expect("job", answer, 202):
            return
        where = answer.headers["location"]
        self._tally.expect("job read", await self._client.request("GET", where), 200)
        if self._random.random() < CANCELED_SHARE:
            canceled = await self._client.request("DELETE", where)
            # 409: it had ended before the cancel came.
            self._tally.expect("job canceled", canceled, 202, 409)
        else:
            await self._await_job(where)

    async def _await_job(self, where: str) -> None:
        while True:
            answer = await self._client.request("GET", where)
            if not self._tally.expect("job read", answer, 200):
                return
            if orjson.loads(answer.body)["status"] not in ("queued", "running"):
                return
            await asyncio.sleep(10 * PAUSE_S)


METHODS: Final = ("as", "ssas", "ncos")
CANCELED_SHARE: Final = 0.5
PROVOCATIONS: Final = (
    ("POST", "/v1/plans", b"{", 422),
    ("POST", "/v1/plans", b"[" * 10_000, 422),
    ("POST", "/v1/plans", b'{"robot": "nobody", "targets": []}', 422),
    ("GET", f"/v1/plans/{'0' * 32}", None, 404),
    ("GET", "/v1/robots/nobody", None, 404),
    ("PUT", "/v1/plans", b"{}", 405),
    ("POST", "/v1/executions", orjson.dumps({"plan_id": "0" * 32, "robot": "tabletop"}), 404),
)


async def mixed_load(
    client: Client, goes_on: Callable[[Tally], bool], seed: int, *, compare: bool
) -> Tally:
    """CLIENTS visitors for as long as it goes on; one comparison at the start if wanted."""
    tally = Tally()
    if compare:
        answer = await client.request("POST", "/v1/comparisons", COMPARISON)
        tally.expect("comparison", answer, 202)
    visitors = [_Visitor(client, tally, seed + number) for number in range(CLIENTS)]
    await asyncio.gather(*(visitor.run(goes_on) for visitor in visitors))
    return tally
