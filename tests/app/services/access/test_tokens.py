"""Tokens: how they are made, kept and checked, and the command."""

import contextlib
import hmac
import json
import sqlite3
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.commands.cli import cli
from app.services.access.tokens import BadToken, digest_of, id_of, is_valid, new_token
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


def test_a_token_has_256_random_bits_and_only_its_digest_is_kept(
    store: TokenStore, tmp_path: Path
) -> None:
    made = [new_token("detector", ["plan"]) for _ in range(100)]
    secrets = {token.rpartition("_")[2] for token, _ in made}
    assert len(secrets) == 100
    assert {len(bytes.fromhex(secret)) for secret in secrets} == {32}
    token, row = made[0]
    store.add(row)
    assert store.token(row.id) == row
    assert (id_of(token), digest_of(token)) == (row.id, row.digest)
    with contextlib.closing(sqlite3.connect(tmp_path / "prunus.sqlite3")) as database:
        text = "\n".join(database.iterdump())
    assert row.digest in text
    assert token.rpartition("_")[2] not in text


@pytest.mark.parametrize("name", ["", "x" * 101, "a\nb", "\x00"])
def test_names_that_make_no_sense(name: str) -> None:
    with pytest.raises(BadToken):
        new_token(name, ["plan"])


@pytest.mark.parametrize("scopes", [[], ["Plan"], ["plan", "fly"], [""]])
def test_scopes_that_make_no_sense(scopes: list[str]) -> None:
    with pytest.raises(BadToken):
        new_token("x", scopes)


@pytest.mark.parametrize("change", ["", "0", "prunus", "{}x", " {}", "{}\n", "é{}"])
def test_texts_that_have_not_the_form_of_a_token(change: str) -> None:
    token, _ = new_token("x", ["plan"])
    assert id_of(token)
    assert id_of(change.format(token)) is None


def test_digests_are_compared_in_constant_time(
    store: TokenStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    token, row = new_token("x", ["plan"])
    other = token[:-1] + ("0" if token[-1] != "0" else "1")
    compared: list[tuple[str, str]] = []
    original = hmac.compare_digest

    def comparing(a: str, b: str) -> bool:
        compared.append((a, b))
        return original(a, b)

    monkeypatch.setattr("app.services.access.tokens.hmac.compare_digest", comparing)
    assert is_valid(row, token)
    assert not is_valid(row, other)
    assert not is_valid(None, token)
    assert compared == [(row.digest, digest_of(token)), (row.digest, digest_of(other))]


def test_a_revoked_token_is_not_valid_and_stays_so(store: TokenStore) -> None:
    token, row = new_token("x", ["plan"])
    assert not store.has_valid()
    store.add(row)
    assert store.has_valid()
    revoked = store.revoke(row.id)
    assert revoked is not None
    assert revoked.revoked_at is not None
    assert not is_valid(revoked, token)
    assert not store.has_valid()
    assert store.revoke(row.id) == revoked
    assert store.revoke("nobody") is None


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
