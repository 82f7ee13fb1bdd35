"""How commands refuse: one line each on standard error, and an exit code."""

from typing import NoReturn

import typer

BAD_REQUEST = 2


def fail(*lines: str, code: int = BAD_REQUEST) -> NoReturn:
    """End the command with these lines."""
    for line in lines:
        typer.echo(line, err=True)
    raise typer.Exit(code)
