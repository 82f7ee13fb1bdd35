"""Metrics for Prometheus."""

from fastapi import APIRouter, Response
from sqlalchemy.exc import SQLAlchemyError

from app.observation.metrics import MEDIA_TYPE
from app.routers.dependencies import TheEngine, TheLinks, TheMetrics
from app.routers.problem_answers import problem_answers
from app.services.store_calls import store_call
from app.store.counts import stored_counts
from app.store.failures import StoreBusy

router = APIRouter(tags=["health"])


@router.get(
    "/metrics",
    operation_id="get_metrics",
    summary="Metrics in the text format of Prometheus",
    response_class=Response,
    responses={
        200: {"content": {"text/plain": {"schema": {"type": "string"}}}},
        **problem_answers(500),
    },
)
async def get_metrics(metrics: TheMetrics, links: TheLinks, engine: TheEngine) -> Response:
    """What the store holds is left as it was counted last when it does not answer."""
    metrics.connected(links.count)
    try:
        counts = await store_call(stored_counts, engine)
    except StoreBusy:
        metrics.store_failed()
    except SQLAlchemyError:
        pass  # counted, where the engine reports errors
    else:
        metrics.stored(counts.jobs, counts.executions)
    return Response(metrics.text(), media_type=MEDIA_TYPE)
