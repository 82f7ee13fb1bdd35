"""In front of every route: who asks, whether they may, and whether they ask too often.

Pure ASGI, so that answers are streamed as they come.
"""

import math
import time
from collections.abc import Callable
from typing import Final

from sqlalchemy.exc import SQLAlchemyError
from starlette.datastructures import Headers
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.errors import problem_response
from app.guards.rates import RateLimiter
from app.guards.route_scopes import ANY, OPEN, ROUTES, STOP, UNLIMITED, WEBSOCKET, row_of
from app.services.access.scopes import Scopes
from app.services.access.service import TRUSTED_S, AccessService, Client

REVOKED: Final = 4401
"""Close code of a WebSocket whose token was revoked; 44xx as the HTTP status 4xx that fits."""

REALM: Final = 'Bearer realm="prunus"'
STORE_RETRY_S: Final = "1"
ROOM_RETRY_S: Final = "1"


class _Refused(Exception):
    """A request that goes no further, and its answer."""

    def __init__(self, response: Response) -> None:
        super().__init__()
        self.response = response


class _Revoked(Exception):
    """The token was revoked while an answer was being streamed."""


class AccessGuardMiddleware:
    """Answers 401, 403, 429 and 503 to requests that may not go on.

    Who asks is then in the request's state: `client_id` is the token's id, or empty without one.

    Args:
        app: what is guarded.
        access: says which tokens are valid; there from the application's start on.
        token_required: nothing but open routes without a token.
        rate_per_s, burst: how many requests a client may make; see `RateLimiter`.
        most_requests: so many are answered at once.
        monotonic: a clock that never steps [s].
    """

    def __init__(
        self,
        app: ASGIApp,
        *,
        access: Callable[[], AccessService],
        token_required: bool,
        rate_per_s: float,
        burst: int,
        most_requests: int,
        monotonic: Callable[[], float] = time.monotonic,
    ) -> None:
        self._app = app
        self._access = access
        self._token_required = token_required
        self._limiter = RateLimiter(rate_per_s, burst, monotonic=monotonic)
        self._most_requests = most_requests
        self._requests = 0
        self._monotonic = monotonic

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass it on, or refuse it."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        scope.setdefault("state", {})["client_id"] = ""
        row = row_of(_method(scope), scope["path"])
        limited = row not in UNLIMITED and scope["type"] == "http"
        try:
            if limited and self._requests >= self._most_requests:
                raise _Refused(_too_many_requests())
            client, token = await self._admitted(scope, row, limited=limited)
        except _Refused as refusal:
            await refusal.response(scope, receive, send)
            return
        self._requests += limited
        try:
            if client is None:
                await self._app(scope, receive, send)
            else:
                scope["state"]["client_id"] = client.id
                await self._watched(scope, receive, send, token)
        finally:
            self._requests -= limited

    async def _admitted(
        self, scope: Scope, row: tuple[str, str] | None, *, limited: bool
    ) -> tuple[Client | None, str]:
        """Who may go on, and with which token; nobody in particular if that will do."""
        peer = f"peer {(scope.get('client') or ('',))[0]}"
        # Where there is no such route, any valid token gets to see that.
        wanted = ANY if row is None else ROUTES[row]
        sent = [] if wanted == OPEN else Headers(scope=scope).getlist("authorization")
        if not sent:
            if limited:
                self._count(peer)
            if wanted != OPEN and self._token_required:
                raise _Refused(_no_token())
            return None, ""
        token = _bearer(sent)
        client = await self._client(token, for_stop=row == STOP)
        if limited:
            self._count(peer if client is None else f"token {client.id}")
        if client is None:
            raise _Refused(_invalid_token())
        if not client.may(wanted):
            raise _Refused(_insufficient_scope(wanted))
        return client, token

    async def _client(self, token: str, *, for_stop: bool) -> Client | None:
        try:
            return await self._access().client(token, for_stop=for_stop)
        except (SQLAlchemyError, TimeoutError):
            raise _Refused(_store_unavailable()) from None

    def _count(self, client: str) -> None:
        wait_s = self._limiter.take(client)
        if wait_s > 0:
            raise _Refused(_rate_limited(max(1, math.ceil(wait_s))))

    async def _watched(self, scope: Scope, receive: Receive, send: Send, token: str) -> None:
        """Let it go on until it ends or its token is revoked."""
        asked_at = self._monotonic()
        revoked = False

        async def is_revoked() -> bool:
            nonlocal asked_at, revoked
            if not revoked and self._monotonic() - asked_at >= TRUSTED_S:
                asked_at = self._monotonic()
                try:
                    revoked = await self._access().client(token, for_stop=True) is None
                except (SQLAlchemyError, TimeoutError):
                    # A store that is away revokes nothing: an arm may hang on this link.
                    return False
            return revoked

        async def receiving() -> Message:
            message = await receive()
            if message["type"] != "websocket.receive" or not await is_revoked():
                return message
            reason = "The token has been revoked."
            await send({"type": "websocket.close", "code": REVOKED, "reason": reason})
            return {"type": "websocket.disconnect", "code": REVOKED}

        async def sending(message: Message) -> None:
            if scope["type"] == "websocket":
                if not revoked:
                    await send(message)
                return
            if message.get("more_body", False) and await is_revoked():
                raise _Revoked
            await send(message)

        try:
            await self._app(scope, receiving, sending)
        except _Revoked:
            # Without its last piece the answer is not whole, and the server cuts the connection.
            return


def _method(scope: Scope) -> str:
    return WEBSOCKET if scope["type"] == "websocket" else str(scope["method"])


def _bearer(sent: list[str]) -> str:
    scheme, _, token = sent[0].partition(" ")
    if len(sent) > 1 or scheme.lower() != "bearer":
        raise _Refused(_invalid_token())
    return token.strip()


def _no_token() -> Response:
    return problem_response(
        401,
        "token_required",
        "A bearer token is required here.",
        headers={"WWW-Authenticate": REALM},
    )


def _invalid_token() -> Response:
    return problem_response(
        401,
        "invalid_token",
        "The token is none that is valid.",
        headers={"WWW-Authenticate": f'{REALM}, error="invalid_token"'},
    )


def _insufficient_scope(wanted: Scopes) -> Response:
    challenge = f'{REALM}, error="insufficient_scope", scope="{" ".join(wanted)}"'
    return problem_response(
        403,
        "insufficient_scope",
        f"The token has not the scope for this: {' or '.join(wanted)}.",
        headers={"WWW-Authenticate": challenge},
    )


def _rate_limited(retry_after_s: int) -> Response:
    return problem_response(
        429,
        "rate_limited",
        "This client has sent too many requests.",
        headers={"Retry-After": str(retry_after_s)},
    )


def _too_many_requests() -> Response:
    return problem_response(
        503,
        "overloaded",
        "Too many requests are being answered.",
        headers={"Retry-After": ROOM_RETRY_S},
    )


def _store_unavailable() -> Response:
    return problem_response(
        503,
        "store_unavailable",
        "The store does not answer, so the token cannot be checked.",
        headers={"Retry-After": STORE_RETRY_S},
    )
