"""The commands `prunus token ...`: tokens made, listed and revoked in the service's store.

They need no running service, and a running one knows of a change within a second.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.commands.failing import fail
from app.commands.settings import SettingsFile, settings_or_fail

if TYPE_CHECKING:
    from app.store import TokenRow, TokenStore

token_commands = typer.Typer(
    help="Tokens, which the service demands off loopback.", no_args_is_help=True
)

DataDir = Annotated[
    Path | None, typer.Option(help="The service's folder [prunus-data, or PRUNUS_DATA_DIR].")
]
DatabaseUrl = Annotated[
    str | None,
    typer.Option(help="The service's database. Others see it: rather set PRUNUS_DATABASE_URL."),
]


@token_commands.command("create")
def create_token(
    name: Annotated[str, typer.Option(help="What it is for; shown in lists.")],
    scope: Annotated[
        list[str], typer.Option(help="plan, execute, observe or admin; may be repeated.")
    ],
    data_dir: DataDir = None,
    database_url: DatabaseUrl = None,
    settings: SettingsFile = None,
) -> None:
    """Make a token and print it, once: only a digest of it is kept."""
    from app.services.access.tokens import BadToken, new_token

    try:
        token, row = new_token(name, scope)
    except BadToken as error:
        fail(str(error))
    with _store(data_dir, database_url, settings, may_be_new=True) as store:
        store.add(row)
    typer.echo(token)
    typer.echo(f"token {row.id}: {', '.join(row.scopes)}; it is not shown again", err=True)


@token_commands.command("list")
def list_tokens(
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    data_dir: DataDir = None,
    database_url: DatabaseUrl = None,
    settings: SettingsFile = None,
) -> None:
    """Show every token but its secret, the oldest first."""
    import orjson

    with _store(data_dir, database_url, settings) as store:
        rows = store.all()
    if as_json:
        typer.echo(orjson.dumps({"tokens": [_to_json(row) for row in rows]}).decode())
        return
    for row in rows:
        scopes = ",".join(row.scopes)
        state = "valid" if row.revoked_at is None else f"revoked {_instant(row.revoked_at)}"
        typer.echo(f"{row.id}  {_instant(row.created_at)}  {scopes}  {state}  {row.name}")


@token_commands.command("revoke")
def revoke_token(
    token_id: Annotated[str, typer.Argument(metavar="ID", help="As in the list; not the token.")],
    data_dir: DataDir = None,
    database_url: DatabaseUrl = None,
    settings: SettingsFile = None,
) -> None:
    """Make a token invalid for ever. What it holds open is closed."""
    with _store(data_dir, database_url, settings) as store:
        row = store.revoke(token_id)
    if row is None or row.revoked_at is None:
        fail("there is no token of this id")
    typer.echo(f"token {row.id} ({row.name}) is revoked since {_instant(row.revoked_at)}")


@contextmanager
def _store(
    data_dir: Path | None, database_url: str | None, file: Path | None, *, may_be_new: bool = False
) -> "Iterator[TokenStore]":
    from sqlalchemy.exc import SQLAlchemyError

    from app.store import TokenStore, open_engine

    given = {"data_dir": data_dir, "database_url": database_url}
    url = settings_or_fail(file, given).resolved_database_url
    embedded = url.get_backend_name() == "sqlite"
    if embedded and not may_be_new and not Path(str(url.database)).exists():
        fail(f"there is no database {url.database}", code=1)
    try:
        engine = open_engine(url)
    except (OSError, SQLAlchemyError):
        # A driver's message may have the URL in it, and that the password.
        fail("the store cannot be opened", code=1)
    try:
        yield TokenStore(engine)
    except SQLAlchemyError:
        fail("the store does not answer", code=1)
    finally:
        engine.dispose()


def _to_json(row: "TokenRow") -> dict[str, object]:
    told: dict[str, object] = {
        "id": row.id,
        "name": row.name,
        "scopes": row.scopes,
        "created_at": _instant(row.created_at),
    }
    return told if row.revoked_at is None else {**told, "revoked_at": _instant(row.revoked_at)}


def _instant(instant: datetime) -> str:
    return instant.isoformat(timespec="seconds").replace("+00:00", "Z")
