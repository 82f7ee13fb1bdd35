"""Whether the service lives, and whether it can work."""

from fastapi import APIRouter
from sqlalchemy.exc import SQLAlchemyError

from app.errors import ProblemError
from app.guards.traffic import RETRY_S
from app.routers.dependencies import ThePlanStore, TheSolving, TheTraffic
from app.routers.problem_answers import problem_answers
from app.schemas.answers import HealthAnswer
from app.services.store_calls import store_call

router = APIRouter(tags=["health"])


@router.get("/healthz", operation_id="get_health", summary="The process answers")
async def get_health() -> HealthAnswer:
    """Needs nothing but the event loop."""
    return HealthAnswer(status="ok")


@router.get(
    "/readyz",
    operation_id="get_readiness",
    summary="The solver is warm and the store answers",
    responses=problem_answers(503),
)
async def get_readiness(
    traffic: TheTraffic, solving: TheSolving, store: ThePlanStore
) -> HealthAnswer:
    """503 until then, and again as soon as the service is stopping."""
    if traffic.is_stopping:
        raise ProblemError(503, "stopping", "The service is stopping.", retry_after_s=RETRY_S)
    if not solving.is_ready:
        raise ProblemError(503, "not_ready", "The solver is warming up.")
    try:
        await store_call(store.check)
    except SQLAlchemyError:
        raise ProblemError(503, "not_ready", "The store does not answer.") from None
    return HealthAnswer(status="ready")
