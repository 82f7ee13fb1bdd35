"""What several routes share: how bodies are read and errors described."""

from typing import Any

from fastapi import Request

from app.errors import ProblemError
from app.schemas.examples import EXAMPLES
from app.schemas.problem_details import MEDIA_TYPE, ProblemDetails
from app.services.robots.leases import LEASE_HEADER

# Python's own phrases for these change from version to version.
DESCRIPTIONS = {
    401: "No token, or none that is valid",
    403: "Not allowed for this token, from a page of another origin, or under another host name",
    404: "Unknown",
    408: "The body did not come in time",
    409: "Not in this state",
    413: "Body over the size limit",
    415: "Body not JSON by its media type",
    422: "Request that makes no sense",
    429: "Too many requests",
    500: "Fault of the service",
    503: "Not available now",
    507: "The storage is full",
}


def problem_answers(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """The OpenAPI descriptions of these errors."""
    content = {MEDIA_TYPE: {"schema": {"$ref": f"#/components/schemas/{ProblemDetails.__name__}"}}}
    return {
        status: {"content": content, "description": DESCRIPTIONS[status]} for status in statuses
    }


def body_of(model: type) -> dict[str, Any]:
    """The OpenAPI description of a body that the route reads itself."""
    name = model.__name__
    content = {"schema": {"$ref": f"#/components/schemas/{name}"}, "example": EXAMPLES[name]}
    return {"requestBody": {"required": True, "content": {"application/json": content}}}


NDJSON = "application/x-ndjson"


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
