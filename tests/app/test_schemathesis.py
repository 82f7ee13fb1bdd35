"""Little of what `python -m bench.service.fuzz` does: every route, few requests."""

from pathlib import Path

from bench.service.fuzz import UNLIMITED, fuzz
from tests.app.conftest import running_server

CASES = 50
"""Of each route."""


def test_every_route_keeps_to_its_description(tmp_path: Path) -> None:
    with running_server(tmp_path, **UNLIMITED) as server:
        fuzzed = fuzz(server.url, CASES)
        described = server.client.get("/openapi.json").json()["paths"]
    routes = {f"{method.upper()} {path}" for path, kinds in described.items() for method in kinds}
    assert set(fuzzed.answers) == routes
    assert fuzzed.findings == {}
