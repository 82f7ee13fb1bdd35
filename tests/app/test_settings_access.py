import pytest
from pydantic import ValidationError

from app.settings import Settings


def test_origins_are_a_text_with_commas_in_the_environment(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("PRUNUS_CORS_ORIGINS", "https://a.example, http://localhost:3000,")
    assert Settings().cors_origins == ("https://a.example", "http://localhost:3000")


@pytest.mark.parametrize(
    "origin",
    ["*", "null", "a.example", "https://a.example/", "https://*.example", "ftp://a", "https://A"],
)
def test_origins_that_are_not_exact_are_refused(origin: str) -> None:
    with pytest.raises(ValidationError):
        Settings(cors_origins=(origin,))


def test_where_a_token_is_required() -> None:
    assert not Settings().token_required
    assert Settings(require_token=True).token_required
    for host in ("0.0.0.0", "::", "192.168.1.5", "arm.example"):
        assert Settings(host=host).token_required
