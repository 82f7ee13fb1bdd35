"""Tokens: how they are made, kept and checked."""

import contextlib
import hmac
import sqlite3
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.services.access.tokens import BadToken, digest_of, id_of, is_valid, new_token
from app.settings import Settings
from app.store import TokenStore, open_engine


@pytest.fixture
def store(tmp_path: Path) -> Iterator[TokenStore]:
    engine = open_engine(Settings(data_dir=tmp_path).resolved_database_url)
    yield TokenStore(engine)
    engine.dispose()


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
