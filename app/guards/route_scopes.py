"""Who may call what: one row a route. `create_app` refuses a route that has none."""

from collections.abc import Iterable
from typing import Final

from fastapi.routing import iter_route_contexts
from starlette.routing import BaseRoute, Mount, compile_path

from app.services.access.scopes import ADMIN, EXECUTE, OBSERVE, PLAN, Scopes

OPEN: Final[Scopes] = ()
"""The route is open to everybody."""

ANY: Final[Scopes] = (PLAN, EXECUTE, OBSERVE, ADMIN)
WEBSOCKET: Final = "WEBSOCKET"
"""Stands for the method of a WebSocket's route."""

STOP: Final = ("POST", "/v1/robots/{name}/stop")

ROUTES: Final[dict[tuple[str, str], Scopes]] = {
    ("POST", "/v1/plans"): (PLAN,),
    ("GET", "/v1/plans/{plan_id}"): (PLAN, OBSERVE),
    ("GET", "/v1/jobs"): (PLAN, OBSERVE),
    ("GET", "/v1/jobs/{job_id}"): (PLAN, OBSERVE),
    ("DELETE", "/v1/jobs/{job_id}"): (PLAN,),
    ("GET", "/v1/jobs/{job_id}/events"): (PLAN, OBSERVE),
    ("GET", "/v1/jobs/{job_id}/results"): (PLAN, OBSERVE),
    ("POST", "/v1/thinning-selections"): (PLAN,),
    ("GET", "/v1/scenarios"): ANY,
    ("POST", "/v1/comparisons"): (PLAN,),
    ("GET", "/v1/comparisons/{comparison_id}"): ANY,
    # Whoever may ask for plans in a frame knows where the camera stands; a wrong frame misleads
    # plans, and every plan is checked again before an arm moves.
    ("GET", "/v1/frames"): ANY,
    ("GET", "/v1/frames/{name}"): ANY,
    ("PUT", "/v1/frames/{name}"): (PLAN,),
    ("DELETE", "/v1/frames/{name}"): (PLAN,),
    ("POST", "/v1/frames/{name}/registration"): (PLAN,),
    ("POST", "/v1/executions"): (EXECUTE,),
    ("GET", "/v1/executions"): ANY,
    ("GET", "/v1/executions/{execution_id}"): ANY,
    ("POST", "/v1/executions/{execution_id}/pause"): (EXECUTE,),
    ("POST", "/v1/executions/{execution_id}/resume"): (EXECUTE,),
    ("POST", "/v1/executions/{execution_id}/cancel"): (EXECUTE,),
    ("GET", "/v1/robots"): ANY,
    ("GET", "/v1/robots/{name}"): ANY,
    ("GET", "/v1/robots/{name}/state"): ANY,
    # Whoever sees an arm do harm may stop it.
    STOP: ANY,
    ("POST", "/v1/robots/{name}/acknowledge"): (EXECUTE,),
    ("POST", "/v1/robots/{name}/lease"): (EXECUTE,),
    ("GET", "/v1/robots/{name}/lease"): ANY,
    ("PUT", "/v1/robots/{name}/lease/{lease_id}"): (EXECUTE,),
    ("DELETE", "/v1/robots/{name}/lease/{lease_id}"): (EXECUTE,),
    (WEBSOCKET, "/v1/robots/{name}/link"): (EXECUTE,),
    ("GET", "/metrics"): (OBSERVE,),
    ("GET", "/healthz"): OPEN,
    ("GET", "/readyz"): OPEN,
    ("GET", "/openapi.json"): OPEN,
    ("GET", "/docs"): OPEN,
    ("GET", "/docs/files/{path:path}"): OPEN,
}

UNLIMITED: Final = (STOP, ("GET", "/healthz"), ("GET", "/readyz"))
"""Routes that no rate and no number of other requests keeps anybody from."""

LEASED: Final = (
    ("POST", "/v1/executions"),
    ("POST", "/v1/executions/{execution_id}/pause"),
    ("POST", "/v1/executions/{execution_id}/resume"),
    ("POST", "/v1/executions/{execution_id}/cancel"),
    ("POST", "/v1/robots/{name}/acknowledge"),
)
"""Routes that need the header `Prunus-Lease` while somebody has a lease of the robot."""

_PATTERNS: Final = tuple((row, compile_path(row[1])[0]) for row in ROUTES)


class RouteWithoutScope(Exception):
    """A route that nobody has said the scope of; a defect of the program."""


def row_of(method: str, path: str) -> tuple[str, str] | None:
    """The row of a request; None where there is no such route."""
    wanted = "GET" if method == "HEAD" else method
    for row, pattern in _PATTERNS:
        if row[0] == wanted and pattern.match(path):
            return row
    return None


def check_rows(routes: Iterable[BaseRoute]) -> None:
    """Raise RouteWithoutScope unless every route has a row."""
    missing = [row for row in served_rows(routes) if row not in ROUTES]
    if missing:
        raise RouteWithoutScope(f"app/guards/route_scopes.py has no row for {missing}")


def served_rows(routes: Iterable[BaseRoute]) -> list[tuple[str, str]]:
    """Method and path of every route that is served."""
    found = []
    listed = list(routes)
    # A folder of files is one route for whatever lies below it.
    found += [
        ("GET", f"{route.path}/{{path:path}}") for route in listed if isinstance(route, Mount)
    ]
    for route in iter_route_contexts([route for route in listed if not isinstance(route, Mount)]):
        methods = getattr(route, "methods", None) or (WEBSOCKET,)
        found += [(method, str(route.path)) for method in methods if method != "HEAD"]
    return found
