"""In front of everything: a request's id, its line in the log, and its place in the metrics."""

import logging
import re
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.contextvars import bound_contextvars

from app.errors import internal_error
from app.guards.traffic import Traffic
from app.observation.metrics import Metrics

HEADER: Final = "X-Request-Id"
SANE_ID: Final = re.compile(r"[!-~]{1,128}")
"""Visible ASCII: it is written to logs and sent back."""

# Metrics keep every value of a label for ever, so none may be a client's own text.
METHODS: Final = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")
OTHER: Final = "other"
UNMATCHED: Final = "unmatched"
CLIENT_GONE: Final = 499
"""In log and metrics only: nobody was there any more to be answered."""

logger = logging.getLogger(__name__)


class RequestLogMiddleware:
    """Gives every request an id, and accounts for it when it is over.

    It is the outermost, so that errors of whatever is within are answered with the id as well.
    """

    def __init__(self, app: ASGIApp, *, metrics: Metrics, traffic: Traffic) -> None:
        self._app = app
        self._metrics = metrics
        self._traffic = traffic

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass it on under an id."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        given = Headers(scope=scope).get(HEADER, "")
        request_id = given if SANE_ID.fullmatch(given) else uuid.uuid4().hex
        with bound_contextvars(request_id=request_id):
            if scope["type"] == "websocket":
                await self._app(scope, receive, send)
            else:
                await self._request(scope, receive, send, request_id)

    async def _request(self, scope: Scope, receive: Receive, send: Send, request_id: str) -> None:
        status, sent_bytes, done = 0, 0, False

        async def watching(message: Message) -> None:
            nonlocal status, sent_bytes, done
            if message["type"] == "http.response.start":
                status = message["status"]
                headers = MutableHeaders(scope=message)
                headers[HEADER] = request_id
                if self._traffic.is_stopping:
                    headers["Connection"] = "close"
            elif message["type"] == "http.response.body":
                sent_bytes += len(message.get("body", b""))
                done = not message.get("more_body", False)
            await send(message)

        started = time.perf_counter()
        with self._counted():
            try:
                await self._app(scope, receive, watching)
            except Exception:
                logger.exception("a request failed")
                if status:
                    raise  # too late for another answer: the server cuts the connection
                await internal_error()(scope, receive, watching)
            finally:
                elapsed_s = time.perf_counter() - started
                method = scope["method"] if scope["method"] in METHODS else OTHER
                route = _template(scope)
                shown = status if done else CLIENT_GONE
                self._metrics.request_ended(method, route, shown, elapsed_s)
                logger.info(
                    "request",
                    extra={
                        "method": method,
                        "route": route,
                        "status": shown,
                        "duration_s": round(elapsed_s, 6),
                        "sent_bytes": sent_bytes,
                        **_client(scope),
                    },
                )

    @contextmanager
    def _counted(self) -> Iterator[None]:
        self._metrics.request_started()
        self._traffic.in_flight += 1
        try:
            yield
        finally:
            self._traffic.in_flight -= 1


def _template(scope: Scope) -> str:
    path = getattr(scope.get("route"), "path", None)
    return path if isinstance(path, str) else UNMATCHED


def _client(scope: Scope) -> dict[str, str]:
    client_id = scope.get("state", {}).get("client_id")
    return {"client_id": str(client_id)} if client_id else {}
