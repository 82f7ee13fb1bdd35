"""What the OpenAPI document says about tokens, scopes, leases and limits, for every operation."""

from typing import Any, Final

from app.guards.route_scopes import LEASED, OPEN, ROUTES, UNLIMITED
from app.routers.problem_answers import problem_answers
from app.schemas.leases import LEASE_HEADER
from app.services.access.scopes import ADMIN, SCOPES

SCHEME: Final = "bearer"
NOT_OPERATIONS: Final = ("parameters", "summary", "description", "servers", "$ref")


def describe_access(document: dict[str, Any]) -> None:
    """Add to an OpenAPI document what is true of every route."""
    document["components"].setdefault("securitySchemes", {})[SCHEME] = {
        "type": "http",
        "scheme": "bearer",
        "description": "Made by `prunus token create`. On loopback none is needed unless the "
        "service says so, but one that is sent must be valid. Scopes: "
        + "; ".join(f"`{name}`: {what}" for name, what in SCOPES.items())
        + ".",
    }
    # Said once for the whole document, and not by every operation: generated clients take an
    # operation with a `security` of its own as one that cannot go without a token.
    document["security"] = [{SCHEME: []}, {}]
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            if method not in NOT_OPERATIONS:
                _describe(operation, (method.upper(), path))


def _describe(operation: dict[str, Any], row: tuple[str, str]) -> None:
    scopes = ROUTES[row]
    statuses = [] if row in UNLIMITED else [429, 503]
    if scopes == OPEN:
        operation["security"] = []
    else:
        statuses += [401, 403, 503]
        wanted = [f"`{scope}`" for scope in scopes if scope != ADMIN]
        said = f"Scope: {' or '.join(wanted)}."
        operation["description"] = f"{operation.get('description', '').rstrip()}\n\n{said}".strip()
    if row in LEASED:
        statuses.append(409)
        operation.setdefault("parameters", []).append(
            {
                "name": LEASE_HEADER,
                "in": "header",
                "required": False,
                "description": "The lease's id, needed while the robot is leased.",
                "schema": {"type": "string", "maxLength": 200},
            }
        )
    described = {str(code): what for code, what in problem_answers(*statuses).items()}
    operation["responses"] = described | operation["responses"]
    leasing = row in LEASED or row == ("POST", "/v1/robots/{name}/lease")
    for status in ("409", "429", "503") if leasing else ("429", "503"):
        if status in operation["responses"]:
            operation["responses"][status].setdefault("headers", {})["Retry-After"] = {
                "description": "seconds after which it makes sense to try again"
                + (", if the robot is leased" if status == "409" else ""),
                "schema": {"type": "integer", "minimum": 0},
            }
