"""Little of the mixed load of `python -m bench.service.load`."""

import asyncio
import math
import time
from urllib.parse import urlsplit

import pytest

from bench.service.client import Client
from bench.service.memory import sample
from bench.service.mixed import Tally, mixed_load
from tests.app.conftest import Server

SETTLED_S = 40
"""How long memory is looked at."""
MOST_GROWTH_KIB = 300 * 1024


def settled(tally: Tally) -> bool:
    """Whether heaps and caches are filled, and all processes there, however slow the machine."""
    least = {"plan": 20, "read": 10, "batch": 3, "job": 3, "provoked": 1}
    return all(tally.done[what] >= count for what, count in least.items())


@pytest.mark.long
def test_mixed_load(server: Server) -> None:
    samples: list[tuple[float, int]] = []
    settled_after = math.inf

    async def load() -> None:
        client = Client("127.0.0.1", urlsplit(server.url).port or 0)
        sampling = asyncio.create_task(sample(server.process.pid, 2, samples))
        began = time.monotonic()

        def goes_on(tally: Tally) -> bool:
            nonlocal settled_after
            elapsed_s = time.monotonic() - began
            if settled(tally):
                settled_after = min(settled_after, elapsed_s)
            return not tally.errors and elapsed_s < settled_after + SETTLED_S

        tally = await mixed_load(client, goes_on, 1, compare=False)
        sampling.cancel()
        client.close()
        assert tally.errors == 0, tally.notes

    asyncio.run(load())
    looked_at = [kib for at, kib in samples if at > settled_after]
    assert looked_at[-1] - looked_at[0] < MOST_GROWTH_KIB, samples
