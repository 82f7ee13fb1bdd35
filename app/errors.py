"""Errors as RFC 9457 problem details. What a client sent is never sent back."""

import http
import logging
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Final

import orjson
from fastapi import FastAPI, Request, Response
from pydantic import ValidationError
from sqlalchemy.exc import SQLAlchemyError
from starlette.exceptions import HTTPException
from starlette.routing import Match

from app.schemas.faults import MOST_FAULTS, structural_faults
from app.schemas.problem_details import MEDIA_TYPE
from app.services.exceptions import (
    Conflict,
    InvalidRequest,
    NotFound,
    ServiceError,
    Unavailable,
    invalid_request,
)
from app.store.failures import StoreBusy, StoreFailure, cause_of, failure_of
from solver import Fault, InvalidProblem

logger = logging.getLogger(__name__)

STORE_RETRY_S = 5

STATUSES: Final[Mapping[type[ServiceError], int]] = MappingProxyType(
    {NotFound: 404, Conflict: 409, InvalidRequest: 422, Unavailable: 503}
)
"""What a service's refusal is in HTTP."""


class ProblemError(Exception):
    """An error of HTTP's own that a client gets to see; services raise `ServiceError`.

    Attributes:
        code: what it is, for programs; the end of the problem's `type`.
        retry_after_s: when it makes sense to try again, if that is known.
    """

    def __init__(
        self,
        status: int,
        code: str,
        detail: str,
        *,
        faults: Sequence[Fault] = (),
        retry_after_s: int | None = None,
    ) -> None:
        super().__init__(detail)
        self.status = status
        self.code = code
        self.detail = detail
        self.faults = tuple(faults)
        self.retry_after_s = 1 if retry_after_s is None and status == 503 else retry_after_s

    @classmethod
    def of(cls, error: ServiceError) -> "ProblemError":
        """The problem that a service's refusal is."""
        return cls(
            STATUSES[type(error)],
            error.code,
            error.detail,
            faults=error.faults,
            retry_after_s=error.retry_after_s,
        )


def store_problem(error: SQLAlchemyError) -> ProblemError | None:
    """The problem for a database that failed, or None if that is a defect of ours."""
    failure = failure_of(error)
    if failure is StoreFailure.FULL:
        detail = "The storage is full; nothing was stored."
        return ProblemError(507, "storage_full", detail)
    if failure is StoreFailure.UNAVAILABLE:
        detail = "The database does not answer now; try again."
        return ProblemError(503, "store_unavailable", detail, retry_after_s=STORE_RETRY_S)
    return None


def problem_response(
    status: int,
    code: str,
    detail: str,
    *,
    faults: Sequence[Fault] = (),
    headers: Mapping[str, str] | None = None,
) -> Response:
    """A problem as a response."""
    body = {
        "type": f"urn:prunus:problem:{code}",
        "title": code.replace("_", " ").capitalize(),
        "status": status,
        "detail": detail,
        "errors": [
            {"pointer": fault.pointer, "detail": fault.detail} for fault in faults[:MOST_FAULTS]
        ],
    }
    # orjson refuses lone surrogates, which a pointer cannot hold: the JSON parser refused them.
    return Response(orjson.dumps(body), status, headers=headers, media_type=MEDIA_TYPE)


def _allowed(request: Request) -> str:
    # Starlette names the methods of the first route of a path only.
    return ", ".join(
        method
        for method in sorted(http.HTTPMethod)
        if any(
            route.matches({**request.scope, "method": method.value})[0] is Match.FULL
            for route in request.app.routes
        )
    )


def internal_error() -> Response:
    """The 500 that says no more than that the log has it."""
    return problem_response(500, "internal_error", "Something broke; the log has it.")


def install_error_handlers(app: FastAPI, store_failed: Callable[[], None]) -> None:
    """Make every error of the application a problem.

    Args:
        app: whose errors they are.
        store_failed: counts a failure of the store that its engine has not seen.
    """

    @app.exception_handler(ProblemError)
    async def expected(_: Request, error: ProblemError) -> Response:
        retry = error.retry_after_s
        headers = None if retry is None else {"Retry-After": str(retry)}
        return problem_response(
            error.status, error.code, error.detail, faults=error.faults, headers=headers
        )

    @app.exception_handler(ServiceError)
    async def refused(request: Request, error: ServiceError) -> Response:
        return await expected(request, ProblemError.of(error))

    @app.exception_handler(SQLAlchemyError)
    async def store(request: Request, error: SQLAlchemyError) -> Response:
        problem = store_problem(error)
        if problem is None:
            raise error
        if isinstance(error, StoreBusy):
            store_failed()
        logger.warning("%s: %s", problem.code, cause_of(error))
        return await expected(request, problem)

    @app.exception_handler(InvalidProblem)
    async def invalid(request: Request, error: InvalidProblem) -> Response:
        return await refused(request, invalid_request(error.faults))

    @app.exception_handler(ValidationError)
    async def malformed(request: Request, error: ValidationError) -> Response:
        return await refused(request, invalid_request(structural_faults(error)))

    @app.exception_handler(HTTPException)
    async def protocol(request: Request, error: HTTPException) -> Response:
        phrase = http.HTTPStatus(error.status_code).phrase
        code = phrase.lower().replace(" ", "_")
        headers = error.headers
        if error.status_code == http.HTTPStatus.METHOD_NOT_ALLOWED:
            headers = {**(headers or {}), "Allow": _allowed(request)}
        return problem_response(error.status_code, code, f"{phrase}.", headers=headers)

    @app.exception_handler(Exception)
    async def unexpected(_: Request, error: Exception) -> Response:
        # Starlette raises the error again behind this answer, and it is logged in full.
        return internal_error()
