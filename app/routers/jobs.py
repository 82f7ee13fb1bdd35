"""Jobs: large batches that are answered later."""

from collections.abc import AsyncIterator, Iterator
from datetime import datetime
from typing import Any, Final

import orjson
from fastapi import APIRouter, Request, Response
from fastapi.responses import StreamingResponse
from fastapi.sse import EventSourceResponse
from starlette.concurrency import iterate_in_threadpool
from starlette.types import Send

from app.routers.dependencies import TheJobs, ThePlanStore
from app.routers.problem_answers import problem_answers
from app.routers.requests import NDJSON, wants_lines
from app.schemas.jobs import JobAnswer, JobResultsAnswer, JobsAnswer
from app.schemas.present import present
from app.services.plans.parts import joined_arrays
from app.services.plans.plan_reading import lines_of
from app.services.store_calls import store_call
from app.store import JobRow, PlanStore
from hardware.clock import instant_text

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])

EVENTS: Final = "text/event-stream"
HEARTBEAT_S: Final = 5.0
"""How often an event stream without events shows that it is alive, and a proxy keeps it open."""


@router.get(
    "",
    operation_id="list_jobs",
    summary="The newest 50, newest first",
    responses={200: {"model": JobsAnswer}, **problem_answers(500)},
)
async def list_jobs(jobs: TheJobs) -> Response:
    """Ended ones too."""
    newest = [job_document(job) for job in await jobs.newest()]
    return Response(orjson.dumps({"jobs": newest}), media_type="application/json")


@router.get(
    "/{job_id}",
    operation_id="get_job",
    summary="How a job stands",
    responses={200: {"model": JobAnswer}, **problem_answers(404, 500)},
)
async def get_job(job_id: str, jobs: TheJobs) -> Response:
    """Progress, in finished targets."""
    return Response(job_json(await jobs.job(job_id)), media_type="application/json")


@router.delete(
    "/{job_id}",
    operation_id="cancel_job",
    status_code=202,
    summary="Cancel a job, whatever it does",
    responses={202: {"model": JobAnswer}, **problem_answers(404, 409, 500)},
)
async def cancel_job(job_id: str, jobs: TheJobs) -> Response:
    """Only one that has not ended. What is solved stays readable."""
    job = await jobs.cancel(job_id)
    return Response(job_json(job), 202, media_type="application/json")


@router.get(
    "/{job_id}/events",
    operation_id="follow_job",
    summary="Progress as server-sent events",
    responses={
        200: {
            # OpenAPI 3.1 has no schema for one event of a stream, and of the whole nothing is true.
            "content": {EVENTS: {}},
            "description": "`progress` now and after every part, then `ended`; `data` is the job "
            "as GET /v1/jobs/{job_id} gives it, `id` the number of finished targets",
        },
        **problem_answers(404, 500),
    },
    response_class=Response,
)
async def follow_job(job_id: str, jobs: TheJobs) -> Response:
    """Ends with the job, or with the service: then ask again."""
    changes = jobs.changes(job_id, HEARTBEAT_S)
    first = await anext(changes)
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return EventSourceResponse(_events(first, changes), headers=headers)


async def _events(
    first: JobRow | None, changes: AsyncIterator[JobRow | None]
) -> AsyncIterator[bytes]:
    if first is not None:
        yield _event(first)
    async for job in changes:
        yield b": alive\n\n" if job is None else _event(job)


def _event(job: JobRow) -> bytes:
    name = "progress" if job.active else "ended"
    # With the fields in the order that they always had.
    return f"event: {name}\nid: {job.done}\ndata: {job_json(job)}\n\n".encode()


@router.get(
    "/{job_id}/results",
    operation_id="get_job_results",
    summary="The approaches that are solved so far",
    responses={
        200: {
            "model": JobResultsAnswer,
            "description": f"With Accept: {NDJSON} the approaches one a line, as they come, until "
            "the job has ended; cut off when the service ends before",
        },
        **problem_answers(404, 500),
    },
)
async def get_job_results(
    job_id: str, request: Request, jobs: TheJobs, store: ThePlanStore
) -> Response:
    """In the order that they are solved in, which with `order: optimal` need not be the plan's."""
    headers = {"Vary": "Accept"}
    if not wants_lines(request):
        await jobs.job(job_id)
        pieces = iterate_in_threadpool(_array(store, job_id))
        return StreamingResponse(pieces, media_type="application/json", headers=headers)
    changes = jobs.changes(job_id, HEARTBEAT_S)
    lines = _following(store, job_id, await anext(changes), changes)
    return _Lines(lines, media_type=NDJSON, headers=headers)


class _CutShort(Exception):
    """The service ends before the job."""


class _Lines(StreamingResponse):
    async def stream_response(self, send: Send) -> None:
        try:
            await super().stream_response(send)
        except _CutShort:
            # Without its last piece the answer is not whole, and the server cuts the connection:
            # nobody takes some of the results for all.
            return


def _array(store: PlanStore, job_id: str) -> Iterator[bytes]:
    yield b'{"approaches":'
    yield from joined_arrays(part.encode() for part in store.parts(job_id))
    yield b"}"


async def _following(
    store: PlanStore, job_id: str, job: JobRow | None, changes: AsyncIterator[JobRow | None]
) -> AsyncIterator[bytes]:
    number = 0
    while True:
        # Looked at before the parts: a job that has ended gets no more of them.
        ended = job is not None and not job.active
        while (part := await store_call(store.part, job_id, number)) is not None:
            yield lines_of(orjson.loads(part))
            number += 1
        if ended:
            return
        try:
            job = await anext(changes)
        except StopAsyncIteration:
            raise _CutShort from None


def job_document(job: JobRow) -> dict[str, Any]:
    """A job as JSON values."""
    return present(
        id=job.id,
        plan_id=job.id,
        robot=job.robot,
        status=job.status,
        targets=job.targets,
        done=job.done,
        planned=job.planned,
        infeasible=job.infeasible,
        created_at=_instant(job.created_at),
        started_at=_instant(job.started_at),
        ended_at=_instant(job.ended_at),
        detail=job.detail,
    )


def job_json(job: JobRow) -> str:
    """A job as JSON."""
    return orjson.dumps(job_document(job)).decode()


def _instant(instant: datetime | None) -> str | None:
    return None if instant is None else instant_text(instant)
