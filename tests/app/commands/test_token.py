"""`prunus token`: made, listed and revoked, and what the commands refuse."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.commands.cli import cli
from app.services.access.tokens import id_of, is_valid
from app.settings import Settings
from app.store import TokenStore, open_engine


@pytest.fixture
def store(tmp_path: Path) -> Iterator[TokenStore]:
    engine = open_engine(Settings(data_dir=tmp_path).resolved_database_url)
    yield TokenStore(engine)
    engine.dispose()


def run(data_dir: Path, *arguments: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(cli, ["token", *arguments, "--data-dir", str(data_dir)])
    return result.exit_code, result.stdout, result.stderr


def test_the_command_makes_lists_and_revokes(store: TokenStore, tmp_path: Path) -> None:
    code, token, told = run(tmp_path, "create", "--name", "eye", *("--scope", "observe"),
                            *("--scope", "plan"), *("--scope", "plan"))  # fmt: skip
    assert code == 0
    token = token.strip()
    found = store.token(id_of(token) or "")
    assert is_valid(found, token)
    assert token not in told

    code, listed, _ = run(tmp_path, "list", "--json")
    (entry,) = json.loads(listed)["tokens"]
    assert code == 0
    assert set(entry) == {"id", "name", "scopes", "created_at"}
    assert (entry["name"], entry["scopes"]) == ("eye", ["plan", "observe"])
    secret = token.rpartition("_")[2]
    assert secret not in listed
    code, shown, _ = run(tmp_path, "list")
    assert entry["id"] in shown
    assert secret not in shown

    code, shown, _ = run(tmp_path, "revoke", entry["id"])
    assert code == 0
    assert not is_valid(store.token(entry["id"]), token)
    (entry,) = json.loads(run(tmp_path, "list", "--json")[1])["tokens"]
    assert "revoked_at" in entry
    assert "revoked" in run(tmp_path, "list")[1]


@pytest.mark.usefixtures("store")
def test_the_command_refuses_in_one_line(tmp_path: Path) -> None:
    for arguments in (
        ("create", "--name", "x", "--scope", "fly"),
        ("create", "--name", "", "--scope", "plan"),
        ("revoke", "000000000000"),
    ):
        code, said, complaint = run(tmp_path, *arguments)
        assert code == 2
        assert said == ""
        assert len(complaint.splitlines()) == 1


def test_commands_take_the_services_settings(
    store: TokenStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Or a token is made, or a copy, of another database than the service's."""
    file, elsewhere = tmp_path / "prunus.toml", tmp_path / "elsewhere"
    file.write_text(f'data_dir = "{tmp_path}"')
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    made = CliRunner().invoke(
        cli, ["token", "create", "--name", "eye", "--scope", "plan", "--settings", str(file)]
    )
    assert made.exit_code == 0
    assert [row.name for row in store.all()] == ["eye"]
    monkeypatch.setenv("PRUNUS_SETTINGS", str(file))
    copied = CliRunner().invoke(cli, ["backup", "copy.sqlite3"])
    assert copied.exit_code == 0
    assert str(tmp_path / "prunus.sqlite3") in copied.stderr
    assert [path.name for path in elsewhere.iterdir()] == ["copy.sqlite3"]
    monkeypatch.setenv("PRUNUS_DATADIR", str(tmp_path))
    for arguments in (["backup", "other.sqlite3"], ["token", "list"]):
        refused = CliRunner().invoke(cli, arguments)
        assert refused.exit_code == 1
        assert "PRUNUS_DATADIR" in refused.stderr


def test_no_database_is_made_to_look_for_tokens(tmp_path: Path) -> None:
    for arguments in (["list"], ["revoke", "000000000000"]):
        command = ["token", *arguments, "--data-dir", str(tmp_path / "typo")]
        refused = CliRunner().invoke(cli, command)
        assert refused.exit_code == 1
        assert "there is no database" in refused.stderr
    assert not (tmp_path / "typo").exists()


def test_a_database_that_is_not_there_is_one_line_without_its_password(tmp_path: Path) -> None:
    url = "postgresql+psycopg://prunus:qq7z@127.0.0.1:9/none"
    result = CliRunner().invoke(cli, ["token", "list", "--database-url", url])
    assert result.exit_code == 1
    assert len(result.stderr.splitlines()) == 1
    assert "qq7z" not in result.output
