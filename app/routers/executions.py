"""Executions: plans on their way through a robot."""

from fastapi import APIRouter, Query, Request, Response

from app.routers.common import body_of, json_body, problem_answers
from app.schemas.executions import (
    ExecutionAnswer,
    ExecutionRequest,
    ExecutionsAnswer,
    ExecutionSummary,
)
from app.services.execution_record import Execution, execution_to_json
from app.services.executions import ExecutionService
from app.services.store_calls import store_call
from app.store import ExecutionRow, ExecutionStore

router = APIRouter(prefix="/v1/executions", tags=["executions"])


@router.post(
    "",
    operation_id="createExecution",
    status_code=202,
    summary="Execute a plan",
    responses={
        202: {
            "model": ExecutionAnswer,
            "headers": {"Location": {"schema": {"type": "string"}}},
        },
        **problem_answers(404, 409, 413, 415, 422, 500, 503),
    },
    openapi_extra=body_of(ExecutionRequest),
)
async def create_execution(request: Request) -> Response:
    """Motions are built and verified anew, then sent once; the arm moves if its worker agrees.

    A robot has one active execution at most.
    """
    given = ExecutionRequest.model_validate_json(await json_body(request))
    execution = await _service(request).create(given.plan_id, given.robot)
    answer = _accepted(execution)
    answer.headers["Location"] = f"/v1/executions/{execution.id}"
    return answer


@router.get(
    "",
    operation_id="listExecutions",
    summary="The newest 50, newest first",
    responses={200: {"model": ExecutionsAnswer}, **problem_answers(500)},
)
async def list_executions(
    request: Request, robot: str = Query(default="", description="only this robot's")
) -> Response:
    """Without their targets."""
    store: ExecutionStore = request.app.state.execution_store
    rows = await store_call(store.newest, robot)
    answer = ExecutionsAnswer(executions=[_summary(row) for row in rows])
    return Response(answer.model_dump_json(), media_type="application/json")


@router.get(
    "/{execution_id}",
    operation_id="getExecution",
    summary="How an execution stands",
    responses={200: {"model": ExecutionAnswer}, **problem_answers(404, 500)},
)
async def get_execution(execution_id: str, request: Request) -> Response:
    """As its worker told it last."""
    document = await _service(request).document(execution_id)
    return Response(document, media_type="application/json")


@router.post(
    "/{execution_id}/pause",
    operation_id="pauseExecution",
    status_code=202,
    summary="Slow down to a stand on the path",
    responses={202: {"model": ExecutionAnswer}, **problem_answers(404, 409, 500)},
)
async def pause_execution(execution_id: str, request: Request) -> Response:
    """Only one that is executing; it is paused when its status says so."""
    return _accepted(await _service(request).pause(execution_id))


@router.post(
    "/{execution_id}/resume",
    operation_id="resumeExecution",
    status_code=202,
    summary="Go on along the path",
    responses={202: {"model": ExecutionAnswer}, **problem_answers(404, 409, 500)},
)
async def resume_execution(execution_id: str, request: Request) -> Response:
    """Only one that is paused."""
    return _accepted(await _service(request).resume(execution_id))


@router.post(
    "/{execution_id}/cancel",
    operation_id="cancelExecution",
    status_code=202,
    summary="Slow down to a stand on the path and end there",
    responses={202: {"model": ExecutionAnswer}, **problem_answers(404, 409, 500)},
)
async def cancel_execution(execution_id: str, request: Request) -> Response:
    """One that the arm cannot have begun is canceled at once, another when its status says so."""
    return _accepted(await _service(request).cancel(execution_id))


def _service(request: Request) -> ExecutionService:
    service: ExecutionService = request.app.state.executions
    return service


def _accepted(execution: Execution) -> Response:
    return Response(execution_to_json(execution), 202, media_type="application/json")


def _summary(row: ExecutionRow) -> ExecutionSummary:
    created, updated = (
        instant.isoformat(timespec="milliseconds").replace("+00:00", "Z")
        for instant in (row.created_at, row.updated_at)
    )
    return ExecutionSummary(
        id=row.id,
        plan_id=row.plan_id,
        robot=row.robot,
        status=row.status,
        created_at=created,
        updated_at=updated,
    )
