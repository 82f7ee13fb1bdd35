"""The application: routes, errors, limits, and what lives as long as it does."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from pydantic.json_schema import models_json_schema
from starlette.concurrency import run_in_threadpool

from app.body_limit import BodyLimitMiddleware
from app.browser_guard import BrowserGuardMiddleware
from app.errors import install_error_handlers
from app.routers import (
    comparisons,
    executions,
    health,
    link,
    plans,
    robot_state,
    robots,
    thinning_selections,
)
from app.routers.common import problem_answers
from app.schemas.comparisons import ComparisonRequest
from app.schemas.executions import ExecutionRequest
from app.schemas.problem_details import ProblemDetails
from app.schemas.requests import PlanRequest
from app.schemas.thinning_selections import ThinningSelectionRequest
from app.services.comparisons import ComparisonService
from app.services.executions import ExecutionService
from app.services.links import LinkService
from app.services.solving import SolvingService
from app.settings import Settings
from app.store import ComparisonStore, ExecutionStore, PlanStore, open_engine
from app.version import prunus_version


def create_app(settings: Settings) -> FastAPI:
    """The application; it touches nothing outside before it is started."""
    app = FastAPI(
        title="Prunus",
        version=prunus_version(),
        description="Decides how a robot arm reaches for blossoms in a tree. "
        "Metres, radians and seconds in the robot's base frame throughout.",
        lifespan=_lifespan,
        # The stock pages load their scripts from elsewhere; this must work offline.
        docs_url=None,
        redoc_url=None,
    )
    app.state.settings = settings
    app.add_middleware(BodyLimitMiddleware, limit_bytes=settings.body_limit_bytes)
    app.add_middleware(BrowserGuardMiddleware, host=settings.host)
    install_error_handlers(app)
    for module in (
        plans,
        executions,
        comparisons,
        thinning_selections,
        robots,
        robot_state,
        link,
        health,
    ):
        app.include_router(module.router)
    # FastAPI's documented way to extend the document is to replace this method.
    app.openapi = lambda: _openapi(app)  # type: ignore[method-assign]
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    settings: Settings = app.state.settings
    state = app.state
    engine = await run_in_threadpool(open_engine, settings.resolved_database_url)
    state.store = PlanStore(engine)
    state.execution_store = ExecutionStore(engine)
    state.links = LinkService()
    state.solving = SolvingService(settings.workers)
    state.executions = ExecutionService(
        state.execution_store, state.store, state.solving, state.links
    )
    state.comparisons = ComparisonService(ComparisonStore(engine), state.solving)
    try:
        await state.executions.end_interrupted()
        await state.comparisons.end_interrupted()
        yield
    finally:
        await state.executions.close()
        await state.comparisons.close()
        await run_in_threadpool(state.solving.close)
        await run_in_threadpool(engine.dispose)


def _openapi(app: FastAPI) -> dict[str, Any]:
    document = get_openapi(
        title=app.title, version=app.version, description=app.description, routes=app.routes
    )
    # Bodies are parsed by hand, for strictness and for the problem form; so they are added here.
    for model, mode in (
        (PlanRequest, "validation"),
        (ExecutionRequest, "validation"),
        (ComparisonRequest, "validation"),
        (ThinningSelectionRequest, "validation"),
        (ProblemDetails, "serialization"),
    ):
        _, definitions = models_json_schema(
            [(model, mode)],  # type: ignore[list-item]
            ref_template="#/components/schemas/{model}",
        )
        document["components"]["schemas"].update(definitions["$defs"])
    refused = problem_answers(403)  # by the guard in front of every route
    failed = problem_answers(503, 507)  # by the database, behind almost all
    for route, path in document["paths"].items():
        for operation in path.values():
            if route.startswith("/v1/"):
                missing = failed.keys() - {int(code) for code in operation["responses"]}
                operation["responses"] |= {str(code): failed[code] for code in sorted(missing)}
            # FastAPI's own form of a validation error, which is never sent.
            _drop_stock_validation_error(operation["responses"])
            operation["responses"] |= {str(code): what for code, what in refused.items()}
    for name in ("HTTPValidationError", "ValidationError"):
        document["components"]["schemas"].pop(name, None)
    return document


def _drop_stock_validation_error(responses: dict[str, Any]) -> None:
    content = responses.get("422", {}).get("content", {})
    if "application/json" in content:
        del responses["422"]
