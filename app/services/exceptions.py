"""What a service refuses, and why; `app.errors` makes answers of these."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from pydantic import ValidationError

from app.schemas.faults import structural_faults
from solver import Fault, InvalidProblem


class ServiceError(Exception):
    """A refusal that whoever asked gets to see. Raised as one of the classes below.

    Attributes:
        code: what it is, for programs.
        detail: a sentence for people; nothing in it repeats what was sent.
        faults: what in the request is wrong, each with the path of its field.
        retry_after_s: when it makes sense to try again, if that is known.
    """

    def __init__(
        self,
        code: str,
        detail: str,
        *,
        faults: Sequence[Fault] = (),
        retry_after_s: int | None = None,
    ) -> None:
        super().__init__(detail)
        self.code = code
        self.detail = detail
        self.faults = tuple(faults)
        self.retry_after_s = retry_after_s

    def __reduce__(self) -> tuple[Any, ...]:
        # It may be raised in a solver process; Python would make it again from its message alone.
        return type(self), (self.code, self.detail), self.__dict__


class InvalidRequest(ServiceError):
    """What is asked makes no sense, whatever the state of things."""


class NotFound(ServiceError):
    """There is nothing of that id or name."""


class Conflict(ServiceError):
    """What is asked does not fit the state of things."""


class Unavailable(ServiceError):
    """What is asked cannot be done now; later it may be."""


def invalid_request(faults: Sequence[Fault]) -> InvalidRequest:
    """The refusal of a request with these faults."""
    return InvalidRequest(
        "invalid_request", "The request makes no sense; see errors.", faults=faults
    )


@contextmanager
def told_as_invalid() -> Iterator[None]:
    """Tell of a request that makes no sense as the InvalidRequest of its faults.

    Raises:
        InvalidRequest: it makes no sense.
    """
    try:
        yield
    except ValidationError as error:
        raise invalid_request(structural_faults(error)) from None
    except InvalidProblem as error:
        raise invalid_request(error.faults) from None
