"""Plans: made from a batch of targets, kept, and read again."""

import uuid
from collections.abc import Iterator

import orjson
from fastapi import APIRouter, Request, Response
from fastapi.responses import StreamingResponse
from starlette.concurrency import run_in_threadpool

from app.errors import ProblemError, invalid_request
from app.routers.common import body_of, json_body, problem_answers
from app.routers.idempotency_key import CREATED_HEADERS, once, with_key
from app.schemas.answers import PlanAnswer
from app.schemas.requests import PlanRequest
from app.services.frames import FrameService
from app.services.sent_frames import FindFrame, stored_request
from app.services.solving import SolvingService
from app.services.wire import parse_request, problem_from_wire
from app.store import NewKey, PlanStore, new_entry
from solver import Fault, Problem

NDJSON = "application/x-ndjson"

router = APIRouter(prefix="/v1/plans", tags=["plans"])


@router.post(
    "",
    operation_id="create_plan",
    status_code=201,
    summary="Plan an approach for every target",
    responses={
        201: {
            "model": PlanAnswer,
            "headers": CREATED_HEADERS,
        },
        **problem_answers(413, 415, 422, 500, 503),
    },
    openapi_extra=with_key(body_of(PlanRequest)),
)
async def create_plan(request: Request) -> Response:
    """Targets that cannot be reached come back infeasible, with a reason."""
    body = await json_body(request)
    store: PlanStore = request.app.state.store
    return await once(request, body, lambda key: _create(request, body, key), read=store.answer)


async def _create(request: Request, body: bytes, key: NewKey | None) -> Response:
    limit: int = request.app.state.settings.sync_targets_limit
    frames: FrameService = request.app.state.frames
    problem, normalised = await run_in_threadpool(_read, body, limit, frames.transform)
    plan_id = uuid.uuid4().hex
    location = f"/v1/plans/{plan_id}"
    solving: SolvingService = request.app.state.solving
    answer = await solving.solve(problem, plan_id)
    store: PlanStore = request.app.state.store
    await run_in_threadpool(
        store.add,
        plan_id,
        robot=problem.robot.name,
        request=normalised,
        answer=answer.decode(),
        key=new_entry(key, 201, location),
    )
    return Response(
        answer,
        status_code=201,
        media_type="application/json",
        headers={"Location": location},
    )


def _read(body: bytes, targets_limit: int, find_frame: FindFrame) -> tuple[Problem, str]:
    request = parse_request(body)
    if len(request.targets) > targets_limit:
        detail = f"more than {targets_limit} targets: asynchronous jobs are not available yet"
        raise invalid_request([Fault(("targets",), detail)])
    problem = problem_from_wire(request, find_frame)
    return problem, stored_request(request, problem)


@router.get(
    "/{plan_id}",
    operation_id="get_plan",
    summary="The plan again",
    responses={
        200: {
            "model": PlanAnswer,
            "content": {NDJSON: {"schema": {"type": "string"}}},
            "description": f"With Accept: {NDJSON} its approaches, one a line",
        },
        **problem_answers(404, 500),
    },
)
async def get_plan(plan_id: str, request: Request) -> Response:
    """As it was answered, byte for byte."""
    store: PlanStore = request.app.state.store
    answer = await run_in_threadpool(store.answer, plan_id)
    if answer is None:
        raise ProblemError(404, "not_found", "There is no plan of this id.")
    headers = {"Vary": "Accept"}
    if NDJSON in request.headers.get("accept", "").lower():
        return StreamingResponse(_lines(answer), media_type=NDJSON, headers=headers)
    return Response(answer, media_type="application/json", headers=headers)


def _lines(answer: str) -> Iterator[bytes]:
    for approach in orjson.loads(answer)["approaches"]:
        yield orjson.dumps(approach, option=orjson.OPT_APPEND_NEWLINE)
