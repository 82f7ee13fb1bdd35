"""Services refuse in words of their own, wherever they run."""

import pickle
import re
from pathlib import Path

import pytest
from pydantic import BaseModel

import app.services
from app.services.exceptions import (
    Conflict,
    InvalidRequest,
    NotFound,
    ServiceError,
    Unavailable,
    told_as_invalid,
)
from solver import Fault, InvalidProblem

ROOM = Path(app.services.__file__).parent
FAULTS = (Fault(("targets", 0, "id"), "it is empty"), Fault((), "too little"))
# Of statuses only those that a number of something else is unlikely to be.
OF_HTTP = re.compile(r"HTTP|ProblemError|fastapi|starlette|\b(20[1-9]|4\d\d|5\d\d)\b")


class _Body(BaseModel):
    number: int


@pytest.mark.parametrize("kind", [NotFound, Conflict, InvalidRequest, Unavailable])
@pytest.mark.parametrize("retry_after_s", [None, 7])
def test_a_refusal_comes_whole_out_of_a_solver_process(
    kind: type[ServiceError], retry_after_s: int | None
) -> None:
    raised = kind("some_code", "A sentence.", faults=FAULTS, retry_after_s=retry_after_s)
    raised.add_note("where it was raised")
    came = pickle.loads(pickle.dumps(raised))
    assert type(came) is kind
    assert (came.code, came.detail, str(came)) == ("some_code", "A sentence.", "A sentence.")
    assert (came.faults, came.retry_after_s) == (FAULTS, retry_after_s)
    assert came.__notes__ == ["where it was raised"]


def test_what_makes_no_sense_is_told_with_its_faults() -> None:
    with pytest.raises(InvalidRequest) as told, told_as_invalid():
        raise InvalidProblem(FAULTS)
    assert told.value.faults == FAULTS
    with pytest.raises(InvalidRequest) as told, told_as_invalid():
        _Body.model_validate({"number": "many"})
    assert [fault.pointer for fault in told.value.faults] == ["#/number"]


def test_no_service_speaks_of_http() -> None:
    speaking = {
        str(file.relative_to(ROOM)): found
        for file in ROOM.rglob("*.py")
        if (found := OF_HTTP.findall(file.read_text()))
    }
    assert speaking == {}
