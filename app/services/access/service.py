"""Whose token a request carries, looked up so that a revocation counts at once."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from anyio import CapacityLimiter, fail_after, to_thread
from sqlalchemy.exc import SQLAlchemyError

from app.services.access.scopes import ADMIN, Scopes
from app.services.access.tokens import digest_of, id_of, is_valid
from app.store import TokenRow, TokenStore

TRUSTED_S: Final = 1.0
"""For so long a token that was valid is not looked up again: a revocation counts after it."""

STOP_PATIENCE_S: Final = 0.5
"""A stop waits so long for the store, and then believes what it said last of the token."""

LOOKUPS_AT_ONCE: Final = 4
"""A store that hangs holds so many threads and no more, whatever tokens are tried."""


@dataclass(frozen=True)
class Client:
    """Who sends a request.

    Attributes:
        id: the token's.
        scopes: what the token allows.
    """

    id: str
    scopes: tuple[str, ...]

    def may(self, wanted: Scopes) -> bool:
        """Whether it has one of these scopes, or may do everything."""
        return ADMIN in self.scopes or any(scope in self.scopes for scope in wanted)


class AccessService:
    """Valid tokens. It lives on the event loop and is used there only."""

    def __init__(
        self, store: TokenStore, *, monotonic: Callable[[], float] = time.monotonic
    ) -> None:
        self._store = store
        self._monotonic = monotonic
        self._limiter = CapacityLimiter(LOOKUPS_AT_ONCE)
        # Only tokens that were found valid, by digest: strangers cannot make it grow.
        self._known: dict[str, tuple[Client, float]] = {}

    async def client(self, token: str, *, for_stop: bool = False) -> Client | None:
        """Whose token it is; None if it is none that is valid.

        Args:
            token: as it was sent.
            for_stop: a stop must not fail over a store that is away, so a token that was valid
                when the store was asked last is then good enough.

        Raises:
            SQLAlchemyError: the store does not answer.
            TimeoutError: the same, and it was for a stop.
        """
        token_id = id_of(token)
        if token_id is None:
            return None
        digest = digest_of(token)
        client, asked_at = self._known.get(digest, (None, -float("inf")))
        if self._monotonic() - asked_at < TRUSTED_S:
            return client
        try:
            row = await self._row(token_id, STOP_PATIENCE_S if for_stop else None)
        except (SQLAlchemyError, TimeoutError):
            if for_stop and client is not None:
                return client
            raise
        if row is None or not is_valid(row, token):
            self._known.pop(digest, None)
            return None
        client = Client(row.id, row.scopes)
        self._known[digest] = client, self._monotonic()
        return client

    async def _row(self, token_id: str, patience_s: float | None) -> TokenRow | None:
        with fail_after(patience_s):
            return await to_thread.run_sync(
                self._store.token, token_id, abandon_on_cancel=True, limiter=self._limiter
            )
