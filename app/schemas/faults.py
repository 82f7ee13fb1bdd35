"""What pydantic finds wrong with a body, as faults that repeat nothing of what was sent."""

from collections.abc import Sequence

from pydantic import ValidationError

from solver import Fault

MOST_FAULTS = 100
LONGEST_STEP = 100


def structural_faults(error: ValidationError) -> tuple[Fault, ...]:
    """The faults of a body that is not what its schema says, without the values."""
    if error.error_count() > MOST_FAULTS:
        return (Fault((), f"has {error.error_count()} fields that are not what they must be"),)
    entries = error.errors(include_url=False, include_input=False, include_context=False)
    return tuple(Fault(_clipped(entry["loc"]), entry["msg"]) for entry in entries)


def _clipped(path: Sequence[str | int]) -> tuple[str | int, ...]:
    # An unknown field's name is the client's own text; a long one is pointed to by its parent.
    long = (i for i, step in enumerate(path) if len(str(step)) > LONGEST_STEP)
    return tuple(path[: next(long, len(path))])
