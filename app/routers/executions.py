"""Executions: plans on their way through a robot."""

from fastapi import APIRouter, Query, Request, Response

from app.routers.dependencies import TheExecutions, TheExecutionStore, TheIdempotency
from app.routers.idempotency_key import CREATED_HEADERS, once, with_key
from app.routers.problem_answers import problem_answers
from app.routers.requests import body_of, json_body, lease_of
from app.schemas.executions import (
    ExecutionAnswer,
    ExecutionRequest,
    ExecutionsAnswer,
    ExecutionSummary,
)
from app.services.robots.execution_record import Execution, execution_to_json
from app.services.store_calls import store_call
from app.store import ExecutionRow, NewKey
from hardware.clock import instant_text

router = APIRouter(prefix="/v1/executions", tags=["executions"])


@router.post(
    "",
    operation_id="create_execution",
    status_code=202,
    summary="Execute a plan",
    responses={
        202: {
            "model": ExecutionAnswer,
            "headers": CREATED_HEADERS,
        },
        **problem_answers(404, 408, 409, 413, 415, 422, 500, 503),
    },
    openapi_extra=with_key(body_of(ExecutionRequest)),
)
async def create_execution(
    request: Request, executions: TheExecutions, keys: TheIdempotency
) -> Response:
    """Motions are built and verified anew, then sent once; the arm moves if its worker agrees.

    A robot has one active execution at most. Whoever sends it again without a key, because no
    answer came, may have the arm move twice.
    """
    body = await json_body(request)

    async def create(key: NewKey | None) -> Response:
        given = ExecutionRequest.from_json(body)
        execution = await executions.create(
            given.plan_id, given.robot, key, lease_id=lease_of(request)
        )
        answer = _accepted(execution)
        answer.headers["Location"] = execution.location
        return answer

    return await once(keys, request, body, create)


@router.get(
    "",
    operation_id="list_executions",
    summary="The newest 50, newest first",
    responses={200: {"model": ExecutionsAnswer}, **problem_answers(500)},
)
async def list_executions(
    store: TheExecutionStore,
    robot: str = Query(default="", description="only this robot's"),
) -> Response:
    """Without their targets."""
    rows = await store_call(store.newest, robot)
    answer = ExecutionsAnswer(executions=[_summary(row) for row in rows])
    return Response(answer.model_dump_json(), media_type="application/json")


@router.get(
    "/{execution_id}",
    operation_id="get_execution",
    summary="How an execution stands",
    responses={200: {"model": ExecutionAnswer}, **problem_answers(404, 500)},
)
async def get_execution(execution_id: str, executions: TheExecutions) -> Response:
    """As its worker told it last."""
    document = await executions.document(execution_id)
    return Response(document, media_type="application/json")


@router.post(
    "/{execution_id}/pause",
    operation_id="pause_execution",
    status_code=202,
    summary="Slow down to a stand on the path",
    responses={202: {"model": ExecutionAnswer}, **problem_answers(404, 409, 500)},
)
async def pause_execution(
    execution_id: str, request: Request, executions: TheExecutions
) -> Response:
    """Only one that is executing; it is paused when its status says so."""
    return _accepted(await executions.pause(execution_id, lease_id=lease_of(request)))


@router.post(
    "/{execution_id}/resume",
    operation_id="resume_execution",
    status_code=202,
    summary="Go on along the path",
    responses={202: {"model": ExecutionAnswer}, **problem_answers(404, 409, 500)},
)
async def resume_execution(
    execution_id: str, request: Request, executions: TheExecutions
) -> Response:
    """Only one that is paused."""
    return _accepted(await executions.resume(execution_id, lease_id=lease_of(request)))


@router.post(
    "/{execution_id}/cancel",
    operation_id="cancel_execution",
    status_code=202,
    summary="Slow down to a stand on the path and end there",
    responses={202: {"model": ExecutionAnswer}, **problem_answers(404, 409, 500)},
)
async def cancel_execution(
    execution_id: str, request: Request, executions: TheExecutions
) -> Response:
    """One that the arm cannot have begun is canceled at once, another when its status says so."""
    return _accepted(await executions.cancel(execution_id, lease_id=lease_of(request)))


def _accepted(execution: Execution) -> Response:
    return Response(execution_to_json(execution), 202, media_type="application/json")


def _summary(row: ExecutionRow) -> ExecutionSummary:
    return ExecutionSummary(
        id=row.id,
        plan_id=row.plan_id,
        robot=row.robot,
        status=row.status,
        created_at=instant_text(row.created_at),
        updated_at=instant_text(row.updated_at),
    )
