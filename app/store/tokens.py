"""The table of tokens. Of a token only its digest is kept."""

from dataclasses import dataclass
from datetime import UTC, datetime

from sqlalchemy import Engine, RowMapping, func, insert, select, update

from app.store.database import writing
from app.store.instants import utc
from app.store.tables import TOKENS


@dataclass(frozen=True)
class TokenRow:
    """A token as it is kept. The times are in UTC.

    Attributes:
        id: what it is called by; no secret.
        name: what it is for, in its maker's words.
        scopes: what it allows.
        digest: SHA-256 of the whole token, hexadecimal.
        revoked_at: since when it is not valid any more, if so.
    """

    id: str
    name: str
    scopes: tuple[str, ...]
    digest: str
    created_at: datetime
    revoked_at: datetime | None = None


class TokenStore:
    """Tokens. Its calls block: keep them off the event loop."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def add(self, token: TokenRow) -> None:
        """Store a new token."""
        row = {
            "id": token.id,
            "name": token.name,
            "scopes": " ".join(token.scopes),
            "digest": token.digest,
            "created_at": token.created_at,
            "revoked_at": token.revoked_at,
        }
        with writing(self._engine) as connection:
            connection.execute(insert(TOKENS), row)

    def token(self, token_id: str) -> TokenRow | None:
        """The token of that id, revoked or not, or None."""
        with self._engine.connect() as connection:
            row = connection.execute(select(TOKENS).where(TOKENS.c.id == token_id))
            found = row.mappings().one_or_none()
        return None if found is None else _token(found)

    def all(self) -> list[TokenRow]:
        """Every token, the oldest first, revoked ones too."""
        query = select(TOKENS).order_by(TOKENS.c.created_at, TOKENS.c.id)
        with self._engine.connect() as connection:
            return [_token(row) for row in connection.execute(query).mappings()]

    def has_valid(self) -> bool:
        """Whether there is one that is not revoked."""
        query = select(func.count()).select_from(TOKENS).where(TOKENS.c.revoked_at.is_(None))
        with self._engine.connect() as connection:
            return bool(connection.execute(query).scalar_one())

    def revoke(self, token_id: str) -> TokenRow | None:
        """Make a token invalid for ever; as it is then, or None if there is none.

        One that is revoked already stays as it is.
        """
        change = (
            update(TOKENS)
            .where(TOKENS.c.id == token_id, TOKENS.c.revoked_at.is_(None))
            .values(revoked_at=datetime.now(UTC))
        )
        with writing(self._engine) as connection:
            connection.execute(change)
        return self.token(token_id)


def _token(fields: RowMapping) -> TokenRow:
    return TokenRow(
        id=fields["id"],
        name=fields["name"],
        scopes=tuple(fields["scopes"].split()),
        digest=fields["digest"],
        created_at=utc(fields["created_at"]),
        revoked_at=None if fields["revoked_at"] is None else utc(fields["revoked_at"]),
    )
