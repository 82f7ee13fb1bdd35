"""A limit on the size of request bodies, declared or streamed."""

import asyncio
import contextlib

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.errors import problem_response

# A client that is still sending does not read; up to this many times the limit is thrown away
# for so long, so that it gets to see the answer instead of a reset connection.
DRAINED_LIMITS = 4
DRAIN_S = 5
# Bodies of megabytes are parsed in other processes on these routes; no other has use for any.
LARGE_ROUTES = ("/v1/plans", "/v1/thinning-selections")
SMALL_BODY_BYTES = 1024 * 1024


class _BodyTooLarge(Exception):
    def __init__(self, *, has_more: bool) -> None:
        super().__init__()
        self.has_more = has_more


class BodyLimitMiddleware:
    """Answers 413 to bodies over the limit, before they are held in memory."""

    def __init__(self, app: ASGIApp, *, limit_bytes: int) -> None:
        self._app = app
        self._limit = limit_bytes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, counting its body."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        large = scope["path"] in LARGE_ROUTES
        limit = self._limit if large else min(self._limit, SMALL_BODY_BYTES)
        headers = dict(scope["headers"])
        declared = headers.get(b"content-length", b"")
        if declared.isdigit() and int(declared) > limit:
            if headers.get(b"expect", b"").lower() != b"100-continue":
                await _drain(receive, limit)
            await _refuse(limit, scope, receive, send)
            return
        received = 0
        started = False

        async def counting() -> Message:
            nonlocal received
            message = await receive()
            received += len(message.get("body", b""))
            if received > limit:
                raise _BodyTooLarge(has_more=message.get("more_body", False))
            return message

        async def watching(message: Message) -> None:
            nonlocal started
            started = True
            await send(message)

        try:
            await self._app(scope, counting, watching)
        except _BodyTooLarge as error:
            if started:
                raise
            if error.has_more:
                await _drain(receive, limit)
            await _refuse(limit, scope, receive, send)


async def _drain(receive: Receive, limit: int) -> None:
    thrown_away = 0
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(DRAIN_S):
            while thrown_away <= DRAINED_LIMITS * limit:
                message = await receive()
                thrown_away += len(message.get("body", b""))
                if not message.get("more_body", False):
                    return


async def _refuse(limit: int, scope: Scope, receive: Receive, send: Send) -> None:
    response = problem_response(
        413,
        "body_too_large",
        f"The body is over the limit of {limit} bytes.",
        headers={"Connection": "close"},
    )
    await response(scope, receive, send)
