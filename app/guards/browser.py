"""Keeps pages of other origins from moving an arm through the browser of somebody near it.

A browser says in `Origin` which page a request comes from; a worker or curl sends none. And a page
that has its own name resolved to loopback (DNS rebinding) still has that name in `Host`.
"""

from collections.abc import Sequence
from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from app.errors import problem_response
from app.settings import is_loopback

DEFAULT_PORTS = {"http": 80, "https": 443}
LOOPBACK_NAMES = ("localhost", "127.0.0.1", "::1")
REFUSED = 4403


class BrowserGuardMiddleware:
    """Answers 403 to requests and WebSockets that a page elsewhere has made.

    Args:
        app: what is guarded.
        host: the address that the service listens on.
        any_name: on loopback too, as behind a reverse proxy that passes its own name on. A name
            resolved to loopback is no danger where requests need a token.
        origins: pages of these origins pass.
    """

    def __init__(
        self, app: ASGIApp, *, host: str, any_name: bool = False, origins: Sequence[str] = ()
    ) -> None:
        self._app = app
        bound = is_loopback(host) and not any_name
        self._names = (*LOOPBACK_NAMES, host.lower()) if bound else ()
        self._origins = frozenset(origins)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass it on, or refuse it."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        host = headers.get("host", "")
        if self._names and _address(f"//{host}")[0] not in self._names:
            code, detail = "unknown_host", "The service listens on loopback under no such name."
        elif not all(
            origin in self._origins or _is_same(origin, host)
            for origin in headers.getlist("origin")
        ):
            code, detail = "cross_origin", "The request comes from a page of another origin."
        else:
            await self._app(scope, receive, send)
            return
        if scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": REFUSED, "reason": detail})
            return
        response = problem_response(403, code, detail, headers={"Connection": "close"})
        await response(scope, receive, send)


def _is_same(origin: str, host: str) -> bool:
    scheme = origin.partition("://")[0].lower()
    page, here = _address(origin), _address(f"{scheme}://{host}")
    return bool(page[0]) and page == here


def _address(url: str) -> tuple[str, int]:
    """Name and port in a URL; no name if there is none or it makes no sense."""
    try:
        parts = urlsplit(url)
        port = parts.port
    except ValueError:
        return "", 0
    return parts.hostname or "", DEFAULT_PORTS.get(parts.scheme, 0) if port is None else port
