"""Little of the mixed load of `python -m bench.service.load`."""

import asyncio
import time
from urllib.parse import urlsplit

import pytest

from bench.service.client import Client
from bench.service.memory import sample
from bench.service.mixed import Tally, mixed_load
from tests.app.conftest import Server

DURATION_S = 60
"""At least; longer where the machine has not come to enough by then."""
MOST_GROWTH_KIB = 300 * 1024


def enough(tally: Tally) -> bool:
    """Or an error, which ends it."""
    done = tally.done["plan"] > 20 and tally.done["read"] > 10 and bool(tally.provoked)
    return done or tally.errors > 0


@pytest.mark.long
def test_mixed_load(server: Server) -> None:
    samples: list[tuple[float, int]] = []

    async def load() -> None:
        client = Client("127.0.0.1", urlsplit(server.url).port or 0)
        sampling = asyncio.create_task(sample(server.process.pid, 2, samples))
        began = time.monotonic()
        tally = await mixed_load(
            client,
            lambda so_far: time.monotonic() - began < DURATION_S or not enough(so_far),
            1,
            compare=False,
        )
        sampling.cancel()
        client.close()
        assert tally.errors == 0, tally.notes

    asyncio.run(load())
    # The first third fills heaps and caches.
    settled = [kib for at, kib in samples if at > DURATION_S / 3]
    assert settled[-1] - settled[0] < MOST_GROWTH_KIB, samples
