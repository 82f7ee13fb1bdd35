"""Whether the service is stopping, what it still answers, and what it refuses then."""

import asyncio
from typing import Final

from starlette.types import ASGIApp, Receive, Scope, Send

from app.errors import problem_response

CREATING: Final = ("/v1/plans", "/v1/executions", "/v1/comparisons")
"""A POST there begins work that must not be cut; the others end at once or hold an arm."""

RETRY_S: Final = 5
"""When a service that is started again may be there."""

DRAIN_POLL_S: Final = 0.02


class Traffic:
    """Requests being answered, and the end of the service. For the event loop only.

    Attributes:
        stopping: set when the service begins to end; streams wait for it and end.
        in_flight: requests being answered.
    """

    def __init__(self) -> None:
        self.stopping = asyncio.Event()
        self.in_flight = 0

    @property
    def is_stopping(self) -> bool:
        """Whether the service has begun to end."""
        return self.stopping.is_set()


class StoppingMiddleware:
    """Refuses what would create something once the service is stopping."""

    def __init__(self, app: ASGIApp, *, traffic: Traffic) -> None:
        self._app = app
        self._traffic = traffic

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass it on, or refuse it."""
        creates = (
            scope["type"] == "http" and scope["method"] == "POST" and scope["path"] in CREATING
        )
        if not (creates and self._traffic.is_stopping):
            await self._app(scope, receive, send)
            return
        # A client that is still sending would see a reset instead of the answer. Time and size are
        # bounded by what is in front of this.
        while (await receive()).get("more_body", False):
            pass
        response = problem_response(
            503,
            "stopping",
            "The service is stopping; nothing was created.",
            headers={"Retry-After": str(RETRY_S)},
        )
        await response(scope, receive, send)
