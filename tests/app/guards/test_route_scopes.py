"""Every route has a scope, and the OpenAPI document says which."""

import pytest
from fastapi import APIRouter
from starlette.routing import Mount
from starlette.staticfiles import StaticFiles

from app.guards.route_scopes import (
    ANY,
    LEASED,
    OPEN,
    ROUTES,
    STOP,
    UNLIMITED,
    WEBSOCKET,
    RouteWithoutScope,
    check_rows,
    row_of,
    served_rows,
)
from app.server.application import create_app
from app.services.access.scopes import ADMIN, SCOPES
from app.settings import Settings

APP = create_app(Settings())
DOCUMENT = APP.openapi()
OPERATIONS = {
    (method.upper(), path): operation
    for path, operations in DOCUMENT["paths"].items()
    for method, operation in operations.items()
}
# All that a stranger gets to see off loopback.
HARMLESS = {"/healthz", "/readyz", "/openapi.json", "/docs", "/docs/files/{path:path}"}


def test_every_route_has_a_row() -> None:
    served = served_rows(APP.routes)
    assert len(served) > 20
    assert set(served) <= set(ROUTES)
    assert (WEBSOCKET, "/v1/robots/{name}/link") in served


def test_a_route_without_a_row_keeps_the_application_from_being_made() -> None:
    router = APIRouter(prefix="/v1")

    @router.post("/forgotten")
    def forgotten() -> None:
        return None

    with pytest.raises(RouteWithoutScope, match="/v1/forgotten"):
        check_rows([*APP.routes, *router.routes])


def test_folders_of_files_have_rows_too() -> None:
    check_rows([Mount("/docs/files", StaticFiles(directory="."))])
    with pytest.raises(RouteWithoutScope, match="/elsewhere"):
        check_rows([Mount("/elsewhere", StaticFiles(directory="."))])


def test_nothing_but_harmless_routes_is_open() -> None:
    assert {path for (_, path), scopes in ROUTES.items() if scopes == OPEN} == HARMLESS
    assert all(set(scopes) <= set(SCOPES) for scopes in ROUTES.values())


def test_whatever_changes_something_needs_more_than_any_token_but_a_stop() -> None:
    for (method, path), scopes in ROUTES.items():
        if method != "GET" and (method, path) != STOP:
            assert scopes in (("plan",), ("execute",)), (method, path)
        if method == "GET":
            assert "observe" in scopes or scopes == OPEN, path
    assert ROUTES[STOP] == ANY
    assert STOP in UNLIMITED
    assert STOP not in LEASED


@pytest.mark.parametrize(
    ("method", "path", "row"),
    [
        ("POST", "/v1/robots/a b/stop", STOP),
        ("HEAD", "/openapi.json", ("GET", "/openapi.json")),
        ("GET", "/docs/files/ui.js", ("GET", "/docs/files/{path:path}")),
        ("GET", "/v1/robots/x/y/stop", None),
        ("POST", "/v1/robots/x/stop/", None),
        ("POST", "/v1/docs", None),
        ("DELETE", "/v1/plans", None),
    ],
)
def test_rows_of_requests(method: str, path: str, row: tuple[str, str] | None) -> None:
    assert row_of(method, path) == row


def test_every_row_is_that_of_its_own_path() -> None:
    for method, path in ROUTES:
        shown = path.replace("{path:path}", "x").replace("{", "").replace("}", "")
        assert row_of(method, shown) == (method, path)


def test_the_document_has_scopes_and_refusals_for_every_operation() -> None:
    assert DOCUMENT["components"]["securitySchemes"]["bearer"]["scheme"] == "bearer"
    assert DOCUMENT["security"] == [{"bearer": []}, {}]
    assert OPERATIONS
    for row, operation in OPERATIONS.items():
        answers = operation["responses"]
        if ROUTES[row] == OPEN:
            assert operation["security"] == []
        else:
            assert "security" not in operation
            assert {"401", "403", "503"} <= set(answers), row
            for scope in ROUTES[row]:
                assert scope == ADMIN or f"`{scope}`" in operation["description"], row
        assert ("429" in answers) == (row not in UNLIMITED), row
        for status in {"429", "503"} & set(answers):
            assert "Retry-After" in answers[status]["headers"]
        leased = [entry["name"] for entry in operation.get("parameters", ())]
        assert ("Prunus-Lease" in leased) == (row in LEASED)
        assert row not in LEASED or "409" in answers
