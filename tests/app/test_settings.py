from urllib.parse import unquote

import pytest
from pydantic import ValidationError
from sqlalchemy import make_url

from app.settings import Settings, shown_settings


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


@pytest.mark.parametrize(
    ("url", "shown"),
    [
        ("postgresql://u:pw@h/d", "postgresql+psycopg://u:***@h/d"),
        ("postgres://h/d?password=pw", "postgresql+psycopg://h/d?password=***"),
        ("postgresql://h/d?sslpassword=pw&x=1", "postgresql+psycopg://h/d?sslpassword=***&x=1"),
    ],
)
def test_no_password_of_the_database_is_shown(url: str, shown: str) -> None:
    text = shown_settings(Settings(database_url=url))["database_url"]
    assert unquote(text) == shown


@pytest.mark.parametrize("url", ["no url of pw", "mysql://u:pw@h/d", "oracle://h"])
def test_other_databases_are_refused_without_repeating_them(url: str) -> None:
    with pytest.raises(ValidationError) as raised:
        Settings(database_url=url)
    told = [entry["msg"] for entry in raised.value.errors()]
    assert not any("pw" in line for line in told)


def test_postgresql_urls_take_the_driver_that_is_installed(postgresql_url: str) -> None:
    url = Settings(database_url=postgresql_url).resolved_database_url
    assert url.drivername == "postgresql+psycopg"
    assert make_url(postgresql_url).database == url.database
