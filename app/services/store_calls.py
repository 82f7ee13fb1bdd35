"""Calls of the store, which block, in threads of their own number.

A database that is locked or lost holds up each call for seconds. The threads in which requests are
read, plans loaded and routes without `async` run must not all end up waiting there.
"""

import asyncio
import math
from collections.abc import Callable
from functools import partial
from typing import Final, ParamSpec, TypeVar

from anyio import CapacityLimiter, to_thread
from anyio.lowlevel import RunVar

from app.store.failures import StoreBusy

# Below the engine's pool, so that no call waits for a connection.
MOST_CALLS: Final = 12
# Longer than a good database ever lets anybody wait, shorter than a client does.
WAIT_S: Final = 10.0

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

_limiters: Final[RunVar[tuple[CapacityLimiter, CapacityLimiter]]] = RunVar("prunus_store_limiters")


async def store_call(
    call: Callable[Arguments, Result], *args: Arguments.args, **kwargs: Arguments.kwargs
) -> Result:
    """Run a call of the store in a thread.

    Raises:
        StoreBusy: too many have been waiting for too long; nothing was begun.
    """
    try:
        mine, threads = _limiters.get()
    except LookupError:
        mine, threads = CapacityLimiter(MOST_CALLS), CapacityLimiter(math.inf)
        _limiters.set((mine, threads))
    place = object()
    try:
        async with asyncio.timeout(WAIT_S):
            await mine.acquire_on_behalf_of(place)
    except TimeoutError:
        raise StoreBusy(f"{MOST_CALLS} calls have been waiting for {WAIT_S:g} s") from None
    try:
        return await to_thread.run_sync(partial(call, *args, **kwargs), limiter=threads)
    finally:
        mine.release_on_behalf_of(place)
