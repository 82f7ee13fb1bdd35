"""The header Idempotency-Key of requests that create: how it is read, described and answered."""

import hashlib
import re
from collections.abc import Awaitable, Callable
from typing import Any, Final
from urllib.parse import quote

from fastapi import Request, Response
from starlette.concurrency import run_in_threadpool

from app.errors import ProblemError
from app.services.idempotency import IdempotencyService
from app.services.store_calls import store_call
from app.store import KeyedAnswer, NewKey

HEADER: Final = "Idempotency-Key"
REPLAYED: Final = "Idempotency-Replayed"
# As much as the table's column holds; a UUID has 36.
LONGEST_KEY: Final = 200
# Visible ASCII: what every HTTP library sends and logs unchanged.
KEY = re.compile(f"[!-~]{{1,{LONGEST_KEY}}}")

CREATED_HEADERS: Final[dict[str, Any]] = {
    "Location": {
        "description": "path of what was created",
        "schema": {"type": "string"},
    },
    REPLAYED: {
        "description": f"true when this is the stored answer to an earlier request of this {HEADER}"
        "; else absent",
        "schema": {"type": "string"},
    },
}
"""The OpenAPI description of the headers of an answer to a request that creates."""


FOR_EVER: Final = (
    "The same key with the same body creates once and gets the first answer again, for ever; with "
    "another body it gets 422. Errors are not kept."
)


def with_key(operation: dict[str, Any], meaning: str = FOR_EVER) -> dict[str, Any]:
    """The OpenAPI description of an operation that takes the header, and what it does there."""
    parameter = {
        "name": HEADER,
        "in": "header",
        "required": False,
        "description": "A text of the client's own, new for every new request and the same for "
        f"its repetitions. {meaning} Without it, a request whose answer was lost must not be sent "
        "again.",
        "schema": {
            "type": "string",
            "minLength": 1,
            "maxLength": LONGEST_KEY,
            "pattern": "^[!-~]+$",
        },
    }
    return {**operation, "parameters": [parameter, *operation.get("parameters", ())]}


async def once(
    keys: IdempotencyService,
    request: Request,
    body: bytes,
    create: Callable[[NewKey | None], Awaitable[Response]],
    read: Callable[[str], str | None] | None = None,
) -> Response:
    """The answer that `create` makes, or the one that is stored under the request's key.

    Args:
        keys: those that were used.
        request: that may have a key.
        body: of the request, as it came.
        create: makes the answer; it must store the key, if there is one, in the transaction that
            stores what it creates.
        read: gives the body of an answer that is stored without one, for the last step of its
            location; it blocks.

    Raises:
        ProblemError: 422, the key makes no sense; 404, what was created is not there any more.
        InvalidRequest: the key stands for another body.
        Exception: whatever `create` raises.
    """
    key = await new_key(request, body)
    if key is None:
        return await create(None)
    answer = await keys.once(key, lambda: create(key))
    if isinstance(answer, KeyedAnswer):
        return await _replayed(answer, read)
    return answer


async def new_key(request: Request, body: bytes) -> NewKey | None:
    """The key of a request with this body, if it has one.

    Raises:
        ProblemError: 422, the key makes no sense.
    """
    text = _key(request)
    if text is None:
        return None
    digest = await run_in_threadpool(lambda: hashlib.sha256(body).hexdigest())
    return NewKey(_scope(request), text, digest)


def _key(request: Request) -> str | None:
    given = request.headers.getlist(HEADER)
    if not given:
        return None
    if len(given) > 1 or not KEY.fullmatch(given[0]):
        raise ProblemError(
            422,
            "invalid_idempotency_key",
            f"{HEADER} must be given once, with 1 to {LONGEST_KEY} visible ASCII characters.",
        )
    return given[0]


def _scope(request: Request) -> str:
    client = getattr(request.state, "client_id", "")
    return f"{request.method} {quote(request.url.path)} {client}".rstrip()


async def _replayed(answer: KeyedAnswer, read: Callable[[str], str | None] | None) -> Response:
    body = answer.body
    if body is None and read is not None:
        body = await store_call(read, answer.location.rpartition("/")[2])
    if body is None:
        raise ProblemError(
            404, "not_found", "What was created under this key is not there any more."
        )
    return Response(
        body,
        answer.status,
        media_type="application/json",
        headers={"Location": answer.location, REPLAYED: "true"},
    )
