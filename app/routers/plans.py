"""Plans: made from a batch of targets, kept, and read again."""

import uuid
from collections.abc import Iterator

import orjson
from fastapi import APIRouter, Request, Response
from fastapi.responses import StreamingResponse
from starlette.concurrency import run_in_threadpool

from app.errors import ProblemError, invalid_request
from app.routers.common import body_of, json_body, problem_answers
from app.schemas.answers import PlanAnswer
from app.schemas.requests import PlanRequest
from app.services.solving import SolvingService
from app.services.store_calls import store_call
from app.services.wire import parse_request, problem_from_wire
from app.store import PlanStore
from solver import Fault, Problem

NDJSON = "application/x-ndjson"

router = APIRouter(prefix="/v1/plans", tags=["plans"])


@router.post(
    "",
    operation_id="createPlan",
    status_code=201,
    summary="Plan an approach for every target",
    responses={
        201: {
            "model": PlanAnswer,
            "headers": {"Location": {"schema": {"type": "string"}}},
        },
        **problem_answers(413, 415, 422, 500, 503),
    },
    openapi_extra=body_of(PlanRequest),
)
async def create_plan(request: Request) -> Response:
    """Targets that cannot be reached come back infeasible, with a reason."""
    body = await json_body(request)
    limit: int = request.app.state.settings.sync_targets_limit
    problem, normalised = await run_in_threadpool(_read, body, limit)
    plan_id = uuid.uuid4().hex
    solving: SolvingService = request.app.state.solving
    answer = await solving.solve(problem, plan_id)
    store: PlanStore = request.app.state.store
    await store_call(
        store.add, plan_id, robot=problem.robot.name, request=normalised, answer=answer.decode()
    )
    return Response(
        answer,
        status_code=201,
        media_type="application/json",
        headers={"Location": f"/v1/plans/{plan_id}"},
    )


def _read(body: bytes, targets_limit: int) -> tuple[Problem, str]:
    request = parse_request(body)
    if len(request.targets) > targets_limit:
        detail = f"more than {targets_limit} targets: asynchronous jobs are not available yet"
        raise invalid_request([Fault(("targets",), detail)])
    return problem_from_wire(request), request.model_dump_json()


@router.get(
    "/{plan_id}",
    operation_id="getPlan",
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
    answer = await store_call(store.answer, plan_id)
    if answer is None:
        raise ProblemError(404, "not_found", "There is no plan of this id.")
    headers = {"Vary": "Accept"}
    if NDJSON in request.headers.get("accept", "").lower():
        return StreamingResponse(_lines(answer), media_type=NDJSON, headers=headers)
    return Response(answer, media_type="application/json", headers=headers)


def _lines(answer: str) -> Iterator[bytes]:
    for approach in orjson.loads(answer)["approaches"]:
        yield orjson.dumps(approach, option=orjson.OPT_APPEND_NEWLINE)
