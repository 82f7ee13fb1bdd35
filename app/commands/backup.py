"""`prunus backup`: the embedded database copied while the service runs."""

import contextlib
import os
import sqlite3
import tempfile
from pathlib import Path
from typing import Annotated

import typer
from sqlalchemy import URL

from app.commands.failing import fail
from app.commands.settings import SettingsFile, settings_or_fail

BUSY_TIMEOUT_S = 10.0


class CannotBackUp(Exception):
    """There is no back-up, and why in one line."""


def backup(
    output: Annotated[Path, typer.Argument(metavar="OUTPUT", help="The new file; must not exist.")],
    data_dir: Annotated[
        Path | None, typer.Option(help="Folder of the database [prunus-data].")
    ] = None,
    settings: SettingsFile = None,
) -> None:
    """Copy the embedded database to one file; the service may run. Ends with 1 without a copy."""
    url = settings_or_fail(settings, {"data_dir": data_dir}).resolved_database_url
    try:
        back_up(url, output)
    except CannotBackUp as error:
        fail(str(error), code=1)
    typer.echo(f"{url.database} is copied to {output}", err=True)


def back_up(url: URL, output: Path) -> None:
    """Copy a database to a file that appears when it is whole.

    Everything that was stored before this is called is in it.

    Raises:
        CannotBackUp: nothing was written.
    """
    if url.get_backend_name() != "sqlite":
        raise CannotBackUp(
            "PostgreSQL has a tool of its own: pg_dump --format=custom --file=OUTPUT DATABASE_URL"
        )
    source = Path(str(url.database))
    if not source.is_file():
        raise CannotBackUp(f"there is no database {source}")
    if output.exists():
        raise CannotBackUp(f"{output} exists already")
    try:
        # Beside its place, so that it can appear there by a link, which never overwrites.
        with tempfile.TemporaryDirectory(dir=output.parent, prefix=".prunus-backup-") as folder:
            copy = Path(folder) / "prunus.sqlite3"
            _copy(source, copy)
            os.link(copy, output)
        _sync(output.parent)
    except FileExistsError:
        raise CannotBackUp(f"{output} exists already") from None
    except OSError as error:
        raise CannotBackUp(f"{output}: {error.strerror}") from error
    except sqlite3.Error as error:
        raise CannotBackUp(f"the database could not be copied: {error}") from error


def _copy(source: Path, copy: Path) -> None:
    with (
        contextlib.closing(
            sqlite3.connect(
                f"{source.resolve().as_uri()}?mode=rw", uri=True, timeout=BUSY_TIMEOUT_S
            )
        ) as original,
        contextlib.closing(sqlite3.connect(copy)) as written,
    ):
        # All pages in one step: by parts it would begin again at every write of the service.
        original.backup(written, pages=-1)
        # One file; the service turns write-ahead logging on again.
        written.execute("PRAGMA journal_mode = DELETE")
        (found,) = written.execute("PRAGMA quick_check").fetchone()
        if found != "ok":
            raise CannotBackUp(f"the copy is damaged: {found}")
    copy.chmod(0o600)
    _sync(copy)


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
