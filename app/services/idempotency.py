"""Once and only once: what is created under a key, and its answer again for every duplicate."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import TypeVar
from weakref import WeakValueDictionary

from app.services.exceptions import InvalidRequest, Unavailable
from app.services.store_calls import store_call
from app.store import IdempotencyStore, KeyedAnswer, KeyTaken, NewKey

Created = TypeVar("Created")


def key_reused() -> InvalidRequest:
    """The refusal of a key that stands for another body."""
    detail = "This Idempotency-Key was used for another body; take a new key for a new request."
    return InvalidRequest("idempotency_key_reused", detail)


class IdempotencyService:
    """Lives on the event loop and is used there only."""

    def __init__(self, store: IdempotencyStore) -> None:
        self._store = store
        # A lock lives as long as somebody holds it or waits for it.
        self._locks: WeakValueDictionary[tuple[str, str], asyncio.Lock] = WeakValueDictionary()

    async def once(
        self, key: NewKey, create: Callable[[], Awaitable[Created]]
    ) -> Created | KeyedAnswer:
        """What `create` gives, or the answer that is stored under the key.

        `create` must store the key in the transaction that stores what it creates. When it raises,
        nothing is stored, and the next with this key runs it again. A duplicate waits for the one
        under way; duplicates that reach other services of the same database do not wait, but lose
        against the key that is stored first.

        Raises:
            InvalidRequest: the key stands for another body.
            Unavailable: the service is shutting down.
            Exception: whatever `create` raises.
        """
        lock = self._locks.setdefault((key.scope, key.key), asyncio.Lock())
        try:
            await lock.acquire()
        except asyncio.CancelledError:
            # Only the server's shutdown cancels a request; its client still gets an answer.
            raise Unavailable("solver_unavailable", "The service is shutting down.") from None
        try:
            stored = await self._find(key)
            if stored is not None:
                return stored
            try:
                return await create()
            except KeyTaken:
                stored = await self._find(key)
                if stored is None:
                    raise
                return stored
        finally:
            lock.release()

    async def _find(self, key: NewKey) -> KeyedAnswer | None:
        stored = await store_call(self._store.find, key.scope, key.key)
        if stored is None:
            return None
        if stored.digest != key.digest:
            raise key_reused()
        return stored.answer
