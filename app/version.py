"""The distribution's version."""

from functools import cache
from importlib import metadata


@cache
def prunus_version() -> str:
    """The version of the installed distribution; finding it reads its metadata, a millisecond."""
    return metadata.version("prunus")
