"""Thinning selections: which blossoms of a branch are removed by the 5-8 pattern."""

from fastapi import APIRouter, Request, Response
from starlette.concurrency import run_in_threadpool

from app.routers.dependencies import TheSolving
from app.routers.problem_answers import problem_answers
from app.routers.requests import body_of, json_body
from app.schemas.thinning_selections import ThinningSelectionAnswer, ThinningSelectionRequest
from app.services.plans.batch_reading import LARGE_BODY_BYTES
from app.services.plans.selecting import selection_to_json

router = APIRouter(prefix="/v1/thinning-selections", tags=["thinning selections"])


@router.post(
    "",
    operation_id="create_thinning_selection",
    summary="Blossoms along branches to targets, by the 5-8 pattern",
    responses={
        200: {"model": ThinningSelectionAnswer},
        **problem_answers(408, 413, 415, 422, 500),
    },
    openapi_extra=body_of(ThinningSelectionRequest),
)
async def create_thinning_selection(request: Request, solving: TheSolving) -> Response:
    """The targets' `id`, `position_m` and `branch_direction` make targets of a plan.

    Nothing is stored.
    """
    body = await json_body(request)
    if len(body) <= LARGE_BODY_BYTES:
        answer = await run_in_threadpool(selection_to_json, body)
    else:
        answer = await solving.select(body)
    return Response(answer, media_type="application/json")
