"""What routes read of requests: bodies, and headers that several take."""

from typing import Any

from fastapi import Request

from app.errors import ProblemError
from app.schemas.examples import EXAMPLES
from app.schemas.leases import LEASE_HEADER

NDJSON = "application/x-ndjson"


def body_of(model: type) -> dict[str, Any]:
    """The OpenAPI description of a body that the route reads itself."""
    name = model.__name__
    content = {"schema": {"$ref": f"#/components/schemas/{name}"}, "example": EXAMPLES[name]}
    return {"requestBody": {"required": True, "content": {"application/json": content}}}


def wants_lines(request: Request) -> bool:
    """Whether the client asks for one JSON value a line."""
    return NDJSON in request.headers.get("accept", "").lower()


async def json_body(request: Request) -> bytes:
    """The body, which may be declared as nothing or as JSON.

    Raises:
        ProblemError: 415, it is declared as something else.
    """
    media_type = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if media_type not in ("", "application/json"):
        raise ProblemError(415, "unsupported_media_type", "The body must be application/json.")
    if request.headers.get("content-encoding", "identity").strip().lower() != "identity":
        raise ProblemError(415, "unsupported_media_type", "The body must not be compressed.")
    return await request.body()


def lease_of(request: Request) -> str:
    """The lease that the request comes with; empty without one."""
    return request.headers.get(LEASE_HEADER, "")
