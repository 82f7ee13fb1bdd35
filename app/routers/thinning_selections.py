"""Thinning selections: which blossoms of a branch are removed by the 5-8 pattern."""

import orjson
from fastapi import APIRouter, Request, Response
from starlette.concurrency import run_in_threadpool

from app.routers.common import body_of, json_body, problem_answers
from app.schemas.thinning_selections import ThinningSelectionAnswer, ThinningSelectionRequest
from solver import Blossom, BlossomBranch, ThinningSelection, select_blossoms

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
async def create_thinning_selection(request: Request) -> Response:
    """The targets' `id`, `position_m` and `branch_direction` make targets of a plan.

    Nothing is stored.
    """
    body = await json_body(request)
    return Response(await run_in_threadpool(_answer, body), media_type="application/json")


def _answer(body: bytes) -> bytes:
    selection = select(ThinningSelectionRequest.model_validate_json(body))
    # orjson writes dataclasses as objects, with the contract's names.
    return orjson.dumps({"targets": selection.targets, "keepers": selection.keepers})


def select(request: ThinningSelectionRequest) -> ThinningSelection:
    """What a request's blossoms come to.

    Raises:
        InvalidProblem: with the faults found; no fault repeats what was sent.
    """
    branches = [
        BlossomBranch(
            branch.id,
            branch.points_m,
            [Blossom(blossom.id, blossom.distance_m) for blossom in branch.blossoms],
        )
        for branch in request.branches
    ]
    return select_blossoms(branches)
