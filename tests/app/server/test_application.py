"""What is true of the application as a whole."""

from pathlib import Path

import pytest

from app.routers.dependencies import services_of
from app.server.application import create_app
from app.settings import Settings
from tests.app.conftest import Server, assert_problem

MARKER = "qq7z"


@pytest.mark.parametrize(
    "path", ["/v1/plans/1", f"/v1/plans/{'0' * 32}", "/v1/plans/%00", "/v1/robots/qq7z", "/qq7z"]
)
def test_unknown_path(path: str, server: Server) -> None:
    answer = server.client.get(path)
    assert_problem(answer, 404)
    assert MARKER not in answer.text


def test_wrong_http_method(server: Server) -> None:
    assert_problem(server.client.delete("/v1/plans"), 405)


def test_a_slash_too_many_is_no_redirection(server: Server) -> None:
    assert_problem(server.client.post("/v1/plans/", json={}), 404)


def test_what_is_not_started_has_no_services_and_touches_nothing(tmp_path: Path) -> None:
    made = create_app(Settings(data_dir=tmp_path / "data"))
    with pytest.raises(AttributeError):
        services_of(made)
    assert list(tmp_path.iterdir()) == []
