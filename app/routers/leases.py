"""Leases of robots: one controlling client each."""

from typing import Final

import orjson
from fastapi import APIRouter, Request, Response
from pydantic import MISSING
from starlette.concurrency import run_in_threadpool

from app.errors import ProblemError
from app.routers.dependencies import TheLeases
from app.routers.idempotency_key import CREATED_HEADERS, REPLAYED, new_key, with_key
from app.routers.problem_answers import problem_answers
from app.routers.requests import body_of, json_body
from app.schemas.leases import (
    USUAL_LEASE_S,
    LeaseAnswer,
    LeaseRenewal,
    LeaseRequest,
    LeaseStateAnswer,
)
from app.services.robots.instances import robot_instance
from app.services.robots.leases import Lease

AS_LONG_AS_IT_LASTS: Final = (
    "As long as the lease lasts, the same key with the same body gets it again, as it stands then, "
    "and with another body 422. A lease that has ended is forgotten, with its key."
)

router = APIRouter(prefix="/v1/robots/{name}/lease", tags=["robots"])


@router.post(
    "",
    operation_id="create_lease",
    status_code=201,
    summary="Take control of a robot for a while",
    responses={
        201: {
            "model": LeaseAnswer,
            "headers": CREATED_HEADERS,
        },
        **problem_answers(404, 408, 409, 413, 415, 422, 500),
    },
    openapi_extra=with_key(body_of(LeaseRequest), AS_LONG_AS_IT_LASTS),
)
async def create_lease(name: str, request: Request, leases: TheLeases) -> Response:
    """While it lasts, only requests with the header `Prunus-Lease` start and change executions.

    Anybody may still stop the robot. What is being executed goes on when the lease ends. The key
    gives the same lease again as long as it lasts, with the time when it ends now.
    """
    body = await json_body(request)
    given = LeaseRequest.from_json(body)
    await run_in_threadpool(robot_instance, name)
    duration_s = USUAL_LEASE_S if given.duration_s is MISSING else given.duration_s
    key = await new_key(request, body)
    before = leases.current(name)
    lease = leases.take(name, given.holder, duration_s, key)
    headers = {"Location": f"/v1/robots/{name}/lease/{lease.id}"}
    if lease is before:
        headers[REPLAYED] = "true"
    return _answer(lease, 201, headers)


@router.get(
    "",
    operation_id="get_lease",
    summary="Who controls a robot",
    responses={200: {"model": LeaseStateAnswer}, **problem_answers(404, 500)},
)
async def get_lease(name: str, leases: TheLeases) -> Response:
    """404 while nobody has a lease of it."""
    await run_in_threadpool(robot_instance, name)
    lease = leases.current(name)
    if lease is None:
        raise ProblemError(404, "not_found", "Nobody has a lease of this robot.")
    return Response(orjson.dumps(_state(lease)), media_type="application/json")


@router.put(
    "/{lease_id}",
    operation_id="renew_lease",
    summary="Keep control of a robot",
    responses={200: {"model": LeaseAnswer}, **problem_answers(404, 408, 413, 415, 422, 500)},
    openapi_extra=body_of(LeaseRenewal),
)
async def renew_lease(name: str, lease_id: str, request: Request, leases: TheLeases) -> Response:
    """It lasts from now on. Renew it well before it ends: after that it is 404."""
    given = LeaseRenewal.from_json(await json_body(request))
    await run_in_threadpool(robot_instance, name)
    duration_s = None if given.duration_s is MISSING else given.duration_s
    return _answer(leases.renew(name, lease_id, duration_s), 200, {})


@router.delete(
    "/{lease_id}",
    operation_id="delete_lease",
    status_code=204,
    summary="Give control of a robot back",
    responses=problem_answers(404, 500),
)
async def delete_lease(name: str, lease_id: str, leases: TheLeases) -> Response:
    """Others may take it at once."""
    await run_in_threadpool(robot_instance, name)
    leases.give_back(name, lease_id)
    return Response(status_code=204)


def _state(lease: Lease) -> dict[str, str | float]:
    return {
        "robot": lease.robot,
        "holder": lease.holder,
        "expires_at": lease.expires_at,
        "duration_s": lease.duration_s,
    }


def _answer(lease: Lease, status: int, headers: dict[str, str]) -> Response:
    body = orjson.dumps({"lease_id": lease.id, **_state(lease)})
    # The id is as good as a key: nothing between here and the client may keep it.
    headers |= {"Cache-Control": "no-store"}
    return Response(body, status, media_type="application/json", headers=headers)
