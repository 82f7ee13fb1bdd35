"""What services refuse, as answers."""

import asyncio
from collections.abc import Iterator
from typing import Any

import orjson
import psycopg
import pytest
from fastapi import FastAPI, Request, Response
from sqlalchemy.exc import OperationalError, SQLAlchemyError

from app.errors import STATUSES, STORE_RETRY_S, ProblemError, install_error_handlers
from app.services.exceptions import (
    Conflict,
    InvalidRequest,
    NotFound,
    ServiceError,
    Unavailable,
)
from app.store.failures import StoreBusy
from solver import Fault


def _kinds(of: type[ServiceError] = ServiceError) -> Iterator[type[ServiceError]]:
    for kind in of.__subclasses__():
        yield kind
        yield from _kinds(kind)


class Answering:
    """The handlers of an application that counts failures of the store."""

    def __init__(self) -> None:
        self.app = FastAPI()
        self.store_failures = 0
        install_error_handlers(self.app, self._count)

    def _count(self) -> None:
        self.store_failures += 1

    def answer(self, error: Exception, kind: type[Exception]) -> Response:
        request = Request({"type": "http", "method": "GET", "path": "/", "app": self.app})
        handler: Any = self.app.exception_handlers[kind]
        answer: Response = asyncio.run(handler(request, error))
        return answer


def test_every_refusal_has_a_status() -> None:
    assert set(_kinds()) == set(STATUSES)


@pytest.mark.parametrize(
    ("error", "status", "retry_after"),
    [
        (NotFound("not_found", "x"), 404, None),
        (Conflict("busy", "x"), 409, None),
        (Conflict("leased", "x", retry_after_s=12), 409, "12"),
        (InvalidRequest("invalid_request", "x", faults=[Fault(("a", 0), "bad")]), 422, None),
        (Unavailable("no_worker", "x"), 503, "1"),
        (Unavailable("jobs_full", "x", retry_after_s=30), 503, "30"),
    ],
)
def test_refusals_are_problems_that_say_when_to_come_again(
    error: ServiceError, status: int, retry_after: str | None
) -> None:
    answer = Answering().answer(error, ServiceError)
    assert answer.status_code == status
    assert answer.headers.get("retry-after") == retry_after
    assert answer.headers["content-type"] == "application/problem+json"
    assert orjson.loads(answer.body) == {
        "type": f"urn:prunus:problem:{error.code}",
        "title": error.code.replace("_", " ").capitalize(),
        "status": status,
        "detail": "x",
        "errors": [{"pointer": "#/a/0", "detail": "bad"}] if error.faults else [],
    }


@pytest.mark.parametrize(
    ("status", "given", "told"), [(503, None, 1), (503, 5, 5), (404, None, None), (429, 3, 3)]
)
def test_what_cannot_be_done_now_is_tried_again_after_a_second(
    status: int, given: int | None, told: int | None
) -> None:
    assert ProblemError(status, "x", "x", retry_after_s=given).retry_after_s == told


def test_a_store_that_nobody_reached_is_counted_here_and_one_that_failed_is_not() -> None:
    answering = Answering()
    busy = answering.answer(StoreBusy("x"), SQLAlchemyError)
    assert (busy.status_code, busy.headers["retry-after"]) == (503, str(STORE_RETRY_S))
    assert answering.store_failures == 1
    lost = OperationalError("SELECT", {}, psycopg.OperationalError("gone"))
    assert answering.answer(lost, SQLAlchemyError).status_code == 503
    assert answering.store_failures == 1


def test_a_defect_in_what_is_asked_of_the_store_is_no_problem_document() -> None:
    defect = OperationalError("SELECT", {}, Exception("no such column"))
    with pytest.raises(OperationalError):
        Answering().answer(defect, SQLAlchemyError)
