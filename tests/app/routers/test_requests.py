"""What every body is asked for."""

import json
from typing import Any

import pytest

from tests.app.conftest import Server, assert_problem


@pytest.mark.parametrize(
    ("media_type", "encoding"),
    [
        ("text/plain", "identity"),
        ("application/x-www-form-urlencoded", "identity"),
        ("multipart/form-data", "identity"),
        ("application/json", "gzip"),
    ],
)
def test_what_is_not_declared_as_plain_json_is_refused(
    media_type: str, encoding: str, server: Server, request_body: dict[str, Any]
) -> None:
    before = server.stored_plans()
    headers = {"Content-Type": media_type, "Content-Encoding": encoding}
    content = json.dumps(request_body).encode()
    assert_problem(server.client.post("/v1/plans", content=content, headers=headers), 415)
    assert server.stored_plans() == before
