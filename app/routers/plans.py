"""Plans: made from a batch of targets, kept, and read again."""

import uuid
from typing import Final

from fastapi import APIRouter, Request, Response
from fastapi.responses import StreamingResponse
from starlette.concurrency import iterate_in_threadpool, run_in_threadpool

from app.errors import ProblemError
from app.routers.dependencies import AllServices, Services, ThePlanStore
from app.routers.idempotency_key import CREATED_HEADERS, once, with_key
from app.routers.jobs import job_json
from app.routers.problem_answers import problem_answers
from app.routers.requests import NDJSON, body_of, json_body, wants_lines
from app.schemas.answers import PlanAnswer
from app.schemas.jobs import JobAnswer
from app.schemas.requests import PlanRequest
from app.services.jobs.service import JobService
from app.services.plans.batch_reading import (
    LARGE_BODY_BYTES,
    BatchLimits,
    JobOrder,
    PlanOrder,
    read_batch,
)
from app.services.plans.plan_reading import plan_chunks, plan_lines
from app.services.store_calls import store_call
from app.store import CREATED, NewKey, PlanStore, new_entry

RESPOND_ASYNC: Final = "respond-async"
PREFER: Final = {
    "name": "Prefer",
    "in": "header",
    "required": False,
    "description": f"`{RESPOND_ASYNC}`: answer with a job, however few targets there are",
    "schema": {"type": "string"},
    "example": RESPOND_ASYNC,
}

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
        202: {
            "model": JobAnswer,
            "headers": {
                **CREATED_HEADERS,
                "Preference-Applied": {
                    "description": f"`{RESPOND_ASYNC}` if it was preferred; else absent",
                    "schema": {"type": "string"},
                },
            },
            "description": "Taken on as a job; Location has its progress",
        },
        **problem_answers(408, 413, 415, 422, 500, 503),
    },
    openapi_extra=with_key({"parameters": [PREFER], **body_of(PlanRequest)}),
)
async def create_plan(request: Request, services: AllServices) -> Response:
    """Targets that cannot be reached come back infeasible, with a reason.

    With `Prefer: respond-async`, and always above the limit of targets for an answer at once, the
    batch becomes a job: 202, and its progress at Location.
    """
    body = await json_body(request)
    return await once(
        services.idempotency,
        request,
        body,
        lambda key: _create(services, body, key, preferred=prefers_async(request)),
        read=lambda plan_id: _stored_answer(services.plan_store, plan_id),
    )


async def _create(
    services: Services, body: bytes, key: NewKey | None, *, preferred: bool
) -> Response:
    order = await _read(services, body, preferred)
    if isinstance(order, JobOrder):
        return await _create_job(services.jobs, order, key, preferred)
    plan_id = uuid.uuid4().hex
    location = f"/v1/plans/{plan_id}"
    answer = await services.solving.solve(order.problem, plan_id)
    await store_call(
        services.plan_store.add,
        plan_id,
        robot=order.problem.robot.name,
        request=order.request,
        answer=answer.decode(),
        key=new_entry(key, CREATED, location),
    )
    return Response(
        answer,
        status_code=201,
        media_type="application/json",
        headers={"Location": location},
    )


async def _create_job(
    jobs: JobService, order: JobOrder, key: NewKey | None, preferred: bool
) -> Response:
    job = await jobs.create(order, job_json, key)
    headers = {"Location": f"/v1/jobs/{job.id}"}
    if preferred:
        headers["Preference-Applied"] = RESPOND_ASYNC
    return Response(job_json(job), 202, media_type="application/json", headers=headers)


def prefers_async(request: Request) -> bool:
    """Whether the client would rather have a job (RFC 7240)."""
    preferences = ",".join(request.headers.getlist("prefer")).split(",")
    return any(entry.partition(";")[0].strip().lower() == RESPOND_ASYNC for entry in preferences)


async def _read(services: Services, body: bytes, preferred: bool) -> PlanOrder | JobOrder:
    settings, frames = services.settings, services.frames
    limits = BatchLimits(settings.sync_targets_limit, settings.job_targets_limit)
    if len(body) <= LARGE_BODY_BYTES:
        return await run_in_threadpool(read_batch, body, limits, preferred, frames.transform)
    return await services.solving.read(body, limits, preferred, await store_call(frames.transforms))


def _stored_answer(store: PlanStore, plan_id: str) -> str | None:
    plan = store.plan(plan_id)
    return None if plan is None else plan.answer


@router.get(
    "/{plan_id}",
    operation_id="get_plan",
    summary="The plan again",
    responses={
        200: {
            "model": PlanAnswer,
            "description": f"With Accept: {NDJSON} its approaches, one a line",
        },
        **problem_answers(404, 500),
    },
)
async def get_plan(plan_id: str, request: Request, store: ThePlanStore) -> Response:
    """As it was answered, byte for byte."""
    plan = await store_call(store.plan, plan_id)
    if plan is None:
        raise ProblemError(404, "not_found", "There is no plan of this id.")
    headers = {"Vary": "Accept"}
    if wants_lines(request):
        lines = iterate_in_threadpool(plan_lines(store, plan_id, plan))
        return StreamingResponse(lines, media_type=NDJSON, headers=headers)
    if not plan.in_parts:
        return Response(plan.answer, media_type="application/json", headers=headers)
    pieces = iterate_in_threadpool(plan_chunks(store, plan_id, plan))
    return StreamingResponse(pieces, media_type="application/json", headers=headers)
