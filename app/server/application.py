"""The application: routes, errors, limits, and what lives as long as it does."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import FastAPI
from sqlalchemy import event
from starlette.concurrency import run_in_threadpool
from starlette.middleware.cors import CORSMiddleware

from app.errors import install_error_handlers
from app.guards.access import AccessGuardMiddleware
from app.guards.body_limit import BodyLimitMiddleware
from app.guards.body_timeout import BodyTimeoutMiddleware
from app.guards.browser import BrowserGuardMiddleware
from app.guards.cors import CORS_RULES
from app.guards.request_log import RequestLogMiddleware
from app.guards.route_scopes import check_rows
from app.guards.traffic import StoppingMiddleware, Traffic
from app.observation.metrics import Metrics
from app.routers import (
    comparisons,
    documentation,
    executions,
    frames,
    health,
    jobs,
    leases,
    link,
    metrics,
    plans,
    robot_state,
    robots,
    thinning_selections,
)
from app.routers.dependencies import Services, keep_services, services_of
from app.server.openapi_document import openapi_document
from app.services.access.service import AccessService
from app.services.comparisons.service import ComparisonService
from app.services.idempotency import IdempotencyService
from app.services.jobs.service import JobService
from app.services.plans.registered_frames import FrameService
from app.services.robots.executions import ExecutionService
from app.services.robots.leases import LeaseService
from app.services.robots.links import LinkService
from app.services.solving.service import SolvingService
from app.settings import Settings
from app.store import (
    ComparisonStore,
    ExecutionStore,
    FrameStore,
    IdempotencyStore,
    JobStore,
    PlanStore,
    TokenStore,
    open_engine,
)
from app.version import prunus_version


def create_app(settings: Settings, traffic: Traffic | None = None) -> FastAPI:
    """The application; it touches nothing outside before it is started.

    Args:
        settings: of the service.
        traffic: known to whoever serves the application, and tells it of its end.
    """
    counters = Metrics(prunus_version())
    traffic = traffic or Traffic()

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        async with _running_services(settings, counters, traffic) as services:
            keep_services(app, services)
            yield

    app = FastAPI(
        title="Prunus",
        version=prunus_version(),
        description="Decides how a robot arm reaches for blossoms in a tree. "
        "Metres, radians and seconds in the robot's base frame throughout.",
        lifespan=lifespan,
        # The stock pages load their scripts from elsewhere; app.routers.documentation does not.
        docs_url=None,
        # A client that does not follow redirects would take one for an answer to its batch.
        redirect_slashes=False,
        redoc_url=None,
    )
    # What is added last is outermost.
    app.add_middleware(StoppingMiddleware, traffic=traffic)
    app.add_middleware(BodyLimitMiddleware, limit_bytes=settings.body_limit_bytes)
    app.add_middleware(
        BodyTimeoutMiddleware,
        idle_s=settings.body_idle_timeout_s,
        total_s=settings.body_timeout_s,
    )
    app.add_middleware(
        AccessGuardMiddleware,
        access=lambda: services_of(app).access,
        token_required=settings.token_required,
        rate_per_s=settings.rate_limit_per_s,
        burst=settings.rate_burst,
        most_requests=settings.most_requests,
    )
    if settings.cors_origins:
        # In front of what checks tokens: a browser asks beforehand without one.
        app.add_middleware(CORSMiddleware, allow_origins=settings.cors_origins, **CORS_RULES)
    app.add_middleware(
        BrowserGuardMiddleware,
        host=settings.host,
        any_name=settings.token_required,
        origins=settings.cors_origins,
    )
    app.add_middleware(RequestLogMiddleware, metrics=counters, traffic=traffic)
    install_error_handlers(app, counters.store_failed)
    for module in (
        plans,
        jobs,
        executions,
        comparisons,
        frames,
        thinning_selections,
        robots,
        robot_state,
        leases,
        link,
        health,
        metrics,
        documentation,
    ):
        app.include_router(module.router)
    check_rows(app.routes)
    documentation.mount_files(app)
    # FastAPI's documented way to extend the document is to replace this method.
    app.openapi = lambda: openapi_document(app)  # type: ignore[method-assign]
    return app


@asynccontextmanager
async def _running_services(
    settings: Settings, counters: Metrics, traffic: Traffic
) -> AsyncIterator[Services]:
    engine = await run_in_threadpool(open_engine, settings.resolved_database_url)
    event.listen(engine, "handle_error", lambda _: counters.store_failed())
    plan_store, execution_store = PlanStore(engine), ExecutionStore(engine)
    links, leases = LinkService(), LeaseService()
    solving = SolvingService(
        settings.workers,
        settings.most_waiting_plans,
        counters,
        settings.log_options,
    )
    services = Services(
        settings=settings,
        metrics=counters,
        traffic=traffic,
        engine=engine,
        plan_store=plan_store,
        execution_store=execution_store,
        access=AccessService(TokenStore(engine)),
        idempotency=IdempotencyService(IdempotencyStore(engine)),
        frames=FrameService(FrameStore(engine)),
        links=links,
        leases=leases,
        solving=solving,
        jobs=JobService(
            JobStore(engine),
            workers=settings.job_workers,
            most_waiting=settings.most_waiting_jobs,
            logs=settings.log_options,
            measures=counters,
            stopping=traffic.stopping,
        ),
        executions=ExecutionService(execution_store, plan_store, solving, links, leases),
        comparisons=ComparisonService(ComparisonStore(engine), solving),
    )
    try:
        await services.executions.end_interrupted()
        await services.comparisons.end_interrupted()
        await services.jobs.start()
        yield services
    finally:
        await services.executions.close()
        await services.comparisons.close()
        await services.jobs.close()
        await services.solving.close()
        await run_in_threadpool(engine.dispose)
