"""How the OpenAPI document describes errors."""

from typing import Any

from app.schemas.problem_details import MEDIA_TYPE, ProblemDetails

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
