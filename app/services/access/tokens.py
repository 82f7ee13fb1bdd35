"""Bearer tokens: how they look, how they are made, and what of them is kept.

A token is `prunus_ID_SECRET`. The id is no secret; it finds the row and names the client in logs.
The secret has 256 random bits, so a plain SHA-256 digest is as good as a slow password hash would
be: nobody can try all of them, however fast a try is.
"""

import hashlib
import hmac
import re
import secrets
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Final

from app.services.access.scopes import SCOPES
from app.store import TokenRow

ID_BYTES: Final = 6
SECRET_BYTES: Final = 32
LONGEST_NAME: Final = 100

_TOKEN: Final = re.compile(rf"prunus_([0-9a-f]{{{2 * ID_BYTES}}})_[0-9a-f]{{{2 * SECRET_BYTES}}}")


class BadToken(ValueError):
    """A token that cannot be made as asked; the message says why."""


def new_token(name: str, scopes: Sequence[str]) -> tuple[str, TokenRow]:
    """A token in clear, which is kept nowhere, and what is kept of it.

    Raises:
        BadToken: no name or scope, or none that makes sense.
    """
    if not (0 < len(name) <= LONGEST_NAME and name.isprintable()):
        raise BadToken(f"a token's name has 1 to {LONGEST_NAME} printable characters")
    unknown = [scope for scope in scopes if scope not in SCOPES]
    if unknown or not scopes:
        raise BadToken(f"a token has one or more of the scopes {', '.join(SCOPES)}")
    token_id = secrets.token_hex(ID_BYTES)
    token = f"prunus_{token_id}_{secrets.token_hex(SECRET_BYTES)}"
    kept = tuple(scope for scope in SCOPES if scope in scopes)
    return token, TokenRow(token_id, name, kept, digest_of(token), datetime.now(UTC))


def id_of(token: str) -> str | None:
    """The id in a token; None if it has not the form of one."""
    found = _TOKEN.fullmatch(token)
    return None if found is None else found[1]


def digest_of(token: str) -> str:
    """What of a token is kept."""
    return hashlib.sha256(token.encode()).hexdigest()


def is_valid(row: TokenRow | None, token: str) -> bool:
    """Whether a row is this token's and not revoked; in the same time for every wrong secret."""
    if row is None:
        return False
    return hmac.compare_digest(row.digest, digest_of(token)) and row.revoked_at is None
