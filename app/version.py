"""The distribution's version."""

from importlib import metadata


def prunus_version() -> str:
    """The version of the installed distribution."""
    return metadata.version("prunus")
