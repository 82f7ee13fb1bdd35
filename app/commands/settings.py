"""`prunus settings`, and how commands of the service get their settings."""

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.commands.failing import fail

if TYPE_CHECKING:
    from app.settings import Settings

SettingsFile = Annotated[
    Path | None,
    typer.Option("--settings", envvar="PRUNUS_SETTINGS", help="TOML file with settings."),
]


def settings(settings: SettingsFile = None) -> None:
    """Print the settings as the service would take them, as TOML, with passwords hidden."""
    from app.settings import shown_settings

    for name, value in shown_settings(settings_or_fail(settings, {})).items():
        # JSON's texts, numbers, truths and lists are TOML's as well.
        typer.echo(f"{name} = {json.dumps(value)}")


def settings_or_fail(file: Path | None, given: dict[str, Any]) -> "Settings":
    """The settings, or the end of the command with one line."""
    from pydantic import ValidationError

    from app.settings import SettingsFileUnusable, load_settings, misspelt_variables

    if misspelt := misspelt_variables(os.environ):
        fail(f"unknown settings in the environment: {', '.join(misspelt)}", code=1)
    try:
        return load_settings(
            file, {name: value for name, value in given.items() if value is not None}
        )
    except ValidationError as error:
        unknown = [entry for entry in error.errors() if entry["type"] == "extra_forbidden"]
        if unknown:
            names = ", ".join(str(entry["loc"][0]) for entry in unknown)
            fail(f"unknown settings: {names}", code=1)
        names = ", ".join(f"PRUNUS_{entry['loc'][0]}".upper() for entry in error.errors())
        fail(f"settings that make no sense: {names}", code=1)
    except SettingsFileUnusable as error:
        fail(str(error), code=1)
