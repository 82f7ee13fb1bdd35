"""A comparison as JSON values. What does not exist is left out; nothing is ever null."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from solver.comparison.result import Comparison, MethodSummary, Row, Spread


def comparison_to_wire(comparison: Comparison) -> dict[str, Any]:
    """The object that `prunus compare --json` prints, and a comparison's `result`."""
    return _values(comparison)


def _values(part: Comparison | MethodSummary | Row | Spread) -> dict[str, Any]:
    values = {entry.name: _value(getattr(part, entry.name)) for entry in fields(part)}
    return {name: value for name, value in values.items() if value not in (None, "")}


def _value(value: Any) -> Any:
    if isinstance(value, Comparison | MethodSummary | Row | Spread):
        return _values(value)
    if isinstance(value, tuple | list):
        return [_value(entry) for entry in value]
    if isinstance(value, Mapping):
        return {name: _value(entry) for name, entry in value.items()}
    return value
