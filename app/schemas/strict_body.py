"""What every request body has in common, and how one is read."""

import json
from collections import Counter
from collections.abc import Iterator
from typing import Any, Self

from pydantic import BaseModel, ConfigDict

from solver import Fault, InvalidProblem

# By the identity of an object, which lives as long as it is in here: its names that repeat.
_Repeated = dict[int, tuple[dict[str, Any], list[str]]]


class StrictBody(BaseModel):
    """Nothing unknown, nothing converted, nothing that is not finite."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)

    @classmethod
    def from_json(cls, body: bytes) -> Self:
        """The body that a JSON document is.

        Raises:
            pydantic.ValidationError: not JSON, or not the schema's structure.
            InvalidProblem: an object has a name twice; which value was meant nobody knows.
        """
        read = cls.model_validate_json(body)
        repeated = repeated_names(body)
        if repeated:
            raise InvalidProblem(tuple(Fault(path, "stands here twice") for path in repeated))
        return read


def repeated_names(document: bytes) -> list[tuple[str | int, ...]]:
    """Paths to the names that an object of a JSON document has more than once."""
    repeated: _Repeated = {}

    def remember(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) < len(pairs):
            counts = Counter(name for name, _ in pairs)
            repeated[id(found)] = found, [name for name in found if counts[name] > 1]
        return found

    # As a float, a number may have as many digits as it likes.
    whole = json.loads(document, object_pairs_hook=remember, parse_int=float)
    return list(_paths(whole, (), repeated)) if repeated else []


def _paths(
    value: Any, path: tuple[str | int, ...], repeated: _Repeated
) -> Iterator[tuple[str | int, ...]]:
    _, names = repeated.get(id(value), (None, ()))
    for name in names:
        yield (*path, name)
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from _paths(inner, (*path, name), repeated)
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            yield from _paths(inner, (*path, place), repeated)
