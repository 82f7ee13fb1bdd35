"""A limit on how long a request's body may take."""

import asyncio

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.errors import problem_response


class _BodyTooSlow(Exception):
    pass


class BodyTimeoutMiddleware:
    """Answers 408 to bodies that stop coming, or come too slowly.

    Args:
        app: what is guarded.
        idle_s: nothing of the body came for so long.
        total_s: the whole body may take this long.
    """

    def __init__(self, app: ASGIApp, *, idle_s: float, total_s: float) -> None:
        self._app = app
        self._idle_s = idle_s
        self._total_s = total_s

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, timing its body."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        loop = asyncio.get_running_loop()
        deadline: float | None = None
        complete = started = False

        async def timed() -> Message:
            nonlocal deadline, complete
            if complete:  # what is waited for now is the client's leaving
                return await receive()
            if deadline is None:
                deadline = loop.time() + self._total_s
            try:
                async with asyncio.timeout_at(min(deadline, loop.time() + self._idle_s)):
                    message = await receive()
            except TimeoutError:
                raise _BodyTooSlow from None
            complete = not message.get("more_body", False)
            return message

        async def watching(message: Message) -> None:
            nonlocal started
            started = True
            await send(message)

        try:
            await self._app(scope, timed, watching)
        except _BodyTooSlow:
            if started:
                raise
            response = problem_response(
                408,
                "request_timeout",
                "The body did not come in time; nothing was done.",
                headers={"Connection": "close"},
            )
            await response(scope, receive, send)
