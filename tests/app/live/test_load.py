"""Little of the mixed load of `python -m bench.service.load`."""

import asyncio
from collections.abc import Mapping
from urllib.parse import urlsplit

import orjson
import pytest

from bench.service.batches import Batches
from bench.service.client import Client
from bench.service.memory import resident_kib, tree
from bench.service.mixed import Tally, mixed_load
from tests.app.conftest import Server

# Work, and not time, which says little on a busy machine: first until heaps and caches are filled,
# then so much that what is kept of each request would show.
FILLED = {"plan": 20, "read": 10, "batch": 5, "provoked": 1}
AND_THEN = {"plan": 60, "read": 50, "batch": 20, "job": 3, "provoked": 10}
MOST_GROWTH_KIB = 60 * 1024
"""Of all processes together, at most at any one time; processes come and go with jobs."""


def came_to(tally: Tally, least: Mapping[str, int]) -> bool:
    return all(tally.done[what] >= count for what, count in least.items())


async def whole_job(client: Client) -> None:
    """The process for jobs comes with the first one, and is as large as the others behind it."""
    body, prefer = Batches(0).body(50, "ncos"), {"Prefer": "respond-async"}
    begun = await client.request("POST", "/v1/plans", body, prefer)
    while True:
        job = await client.request("GET", begun.headers["location"])
        status = orjson.loads(job.body)["status"]
        if status == "completed":
            return
        assert status in ("queued", "running")
        await asyncio.sleep(0.2)


@pytest.mark.long
def test_mixed_load(server: Server) -> None:
    most_kib = {"filling": 0, "after": 0}

    def goes_on(tally: Tally) -> bool:
        phase = "after" if came_to(tally, FILLED) else "filling"
        most_kib[phase] = max(most_kib[phase], resident_kib(tree(server.process.pid)))
        return not tally.errors and not came_to(tally, AND_THEN)

    async def load() -> Tally:
        client = Client("127.0.0.1", urlsplit(server.url).port or 0)
        try:
            await whole_job(client)
            return await mixed_load(client, goes_on, 1, compare=False)
        finally:
            client.close()

    tally = asyncio.run(load())
    assert tally.errors == 0, tally.notes
    assert most_kib["after"] - most_kib["filling"] < MOST_GROWTH_KIB
