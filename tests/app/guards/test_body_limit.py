"""Bodies that are too large."""

from collections.abc import Iterable

import pytest

from app.guards.body_limit import SMALL_BODY_BYTES
from tests.app.conftest import BODY_LIMIT_BYTES, Server, assert_problem


def refused(server: Server, path: str, content: bytes | Iterable[bytes]) -> None:
    before = server.stored_plans()
    headers = {"Content-Type": "application/json"}
    assert_problem(server.client.post(path, content=content, headers=headers), 413)
    assert server.stored_plans() == before


def test_body_over_the_limit(server: Server) -> None:
    refused(server, "/v1/plans", b" " * (BODY_LIMIT_BYTES + 1))


@pytest.mark.parametrize("sizes", [[400_000] * 40, [4_000_000, 4_000_001], [8_000_001]])
def test_streamed_body_over_the_limit(sizes: list[int], server: Server) -> None:
    refused(server, "/v1/plans", (b" " * size for size in sizes))


@pytest.mark.parametrize("path", ["/v1/executions", "/v1/comparisons", "/v1/robots/tabletop/lease"])
def test_no_other_route_takes_a_large_body(path: str, server: Server) -> None:
    refused(server, path, b" " * (SMALL_BODY_BYTES + 1))
