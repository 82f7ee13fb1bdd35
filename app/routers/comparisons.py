"""Comparisons of methods, and the scenarios that there are."""

import orjson
from fastapi import APIRouter, Request, Response
from pydantic import MISSING

from app.reports.html import content_security_policy
from app.routers.dependencies import TheComparisons, TheIdempotency
from app.routers.idempotency_key import CREATED_HEADERS, once, with_key
from app.routers.problem_answers import problem_answers
from app.routers.requests import body_of, json_body
from app.schemas.comparisons import (
    ComparisonAnswer,
    ComparisonRequest,
    ScenarioAnswer,
    ScenariosAnswer,
)
from app.services.comparisons.service import location_of
from app.store import NewKey
from solver.comparison.registry import SCENARIOS

HTML = "text/html"

router = APIRouter(prefix="/v1", tags=["comparisons"])


@router.get(
    "/scenarios",
    operation_id="list_scenarios",
    summary="All scenarios that methods can be compared on",
    responses={200: {"model": ScenariosAnswer}, **problem_answers(500)},
)
def list_scenarios() -> Response:
    """By name, with a line on each."""
    answer = ScenariosAnswer(
        scenarios=[ScenarioAnswer(name=row.name, title=row.title) for row in SCENARIOS.values()]
    )
    return Response(answer.model_dump_json(), media_type="application/json")


@router.post(
    "/comparisons",
    operation_id="create_comparison",
    status_code=202,
    summary="Compare methods on a scenario",
    responses={
        202: {
            "model": ComparisonAnswer,
            "headers": CREATED_HEADERS,
        },
        **problem_answers(408, 413, 415, 422, 500, 503),
    },
    openapi_extra=with_key(body_of(ComparisonRequest)),
)
async def create_comparison(
    request: Request, comparisons: TheComparisons, keys: TheIdempotency
) -> Response:
    """It is queued; comparisons run one after the other, about a minute each."""
    body = await json_body(request)

    async def create(key: NewKey | None) -> Response:
        given = ComparisonRequest.from_json(body)
        document = await comparisons.create(
            given.scenario,
            None if given.methods is MISSING else tuple(given.methods),
            None if given.repeats is MISSING else given.repeats,
            key,
        )
        return Response(
            orjson.dumps(document),
            202,
            media_type="application/json",
            headers={"Location": location_of(document)},
        )

    return await once(keys, request, body, create)


@router.get(
    "/comparisons/{comparison_id}",
    operation_id="get_comparison",
    summary="How a comparison stands, and its result",
    responses={
        200: {
            "model": ComparisonAnswer,
            "content": {HTML: {"schema": {"type": "string"}}},
            "description": f"With Accept: {HTML} the report as a page",
        },
        **problem_answers(404, 500),
    },
)
async def get_comparison(
    comparison_id: str, request: Request, comparisons: TheComparisons
) -> Response:
    """As JSON; as a page for browsers, which loads itself again until there is a report."""
    headers = {"Vary": "Accept"}
    if _wants_page(request.headers.get("accept", "")):
        page = await comparisons.page(comparison_id)
        headers |= {
            "Content-Security-Policy": f"{content_security_policy()}; frame-ancestors 'none'",
            "X-Content-Type-Options": "nosniff",
        }
        return Response(page, media_type=HTML, headers=headers)
    document = await comparisons.document(comparison_id)
    return Response(orjson.dumps(document), media_type="application/json", headers=headers)


def _wants_page(accept: str) -> bool:
    kinds = [part.partition(";")[0].strip() for part in accept.lower().split(",")]
    wanted = [kind for kind in kinds if kind in (HTML, "application/json")]
    return wanted[:1] == [HTML]
