"""What is absent is left out of every answer; nothing is ever null."""

from typing import Any


def present(**values: Any) -> dict[str, Any]:
    """The values that are there."""
    return {name: value for name, value in values.items() if value is not None}
