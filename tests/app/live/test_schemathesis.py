"""Little of what `python -m bench.service.fuzz` does: every route, few requests."""

import json
import urllib.request

import pytest

from bench.service.fuzz import UNLIMITED, fuzz
from bench.service.load import live_server

CASES = 20
"""Of each route."""


@pytest.mark.long
def test_every_route_keeps_to_its_description() -> None:
    with live_server(UNLIMITED) as (_, port):
        url = f"http://127.0.0.1:{port}"
        fuzzed = fuzz(url, CASES)
        with urllib.request.urlopen(f"{url}/openapi.json") as answer:
            described = json.load(answer)["paths"]
    routes = {f"{method.upper()} {path}" for path, kinds in described.items() for method in kinds}
    assert set(fuzzed.answers) == routes
    assert fuzzed.findings == {}
