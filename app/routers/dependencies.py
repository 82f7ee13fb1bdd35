"""What routes are given: what lives as long as the application does.

The only module that knows where the application keeps it. Everything here is `async` although
nothing waits: FastAPI runs other dependencies in threads, and there may be none free.
"""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, FastAPI
from fastapi.requests import HTTPConnection
from sqlalchemy import Engine

from app.guards.traffic import Traffic
from app.observation.metrics import Metrics
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
from app.store import ExecutionStore, PlanStore


@dataclass(frozen=True)
class Services:
    """Settings, stores and services, one of each."""

    settings: Settings
    metrics: Metrics
    traffic: Traffic
    engine: Engine
    plan_store: PlanStore
    execution_store: ExecutionStore
    access: AccessService
    idempotency: IdempotencyService
    frames: FrameService
    links: LinkService
    leases: LeaseService
    solving: SolvingService
    jobs: JobService
    executions: ExecutionService
    comparisons: ComparisonService


def keep_services(app: FastAPI, services: Services) -> None:
    """Make them those of an application."""
    app.state.services = services


def services_of(app: FastAPI) -> Services:
    """Those of an application, which has them once it is started."""
    services: Services = app.state.services
    return services


async def _all(connection: HTTPConnection) -> Services:
    return services_of(connection.app)


AllServices = Annotated[Services, Depends(_all)]
"""For a route that needs most of them; others take one by one what they need."""


async def _metrics(services: AllServices) -> Metrics:
    return services.metrics


async def _traffic(services: AllServices) -> Traffic:
    return services.traffic


async def _engine(services: AllServices) -> Engine:
    return services.engine


async def _plan_store(services: AllServices) -> PlanStore:
    return services.plan_store


async def _execution_store(services: AllServices) -> ExecutionStore:
    return services.execution_store


async def _idempotency(services: AllServices) -> IdempotencyService:
    return services.idempotency


async def _frames(services: AllServices) -> FrameService:
    return services.frames


async def _links(services: AllServices) -> LinkService:
    return services.links


async def _leases(services: AllServices) -> LeaseService:
    return services.leases


async def _solving(services: AllServices) -> SolvingService:
    return services.solving


async def _jobs(services: AllServices) -> JobService:
    return services.jobs


async def _executions(services: AllServices) -> ExecutionService:
    return services.executions


async def _comparisons(services: AllServices) -> ComparisonService:
    return services.comparisons


TheMetrics = Annotated[Metrics, Depends(_metrics)]
TheTraffic = Annotated[Traffic, Depends(_traffic)]
TheEngine = Annotated[Engine, Depends(_engine)]
ThePlanStore = Annotated[PlanStore, Depends(_plan_store)]
TheExecutionStore = Annotated[ExecutionStore, Depends(_execution_store)]
TheIdempotency = Annotated[IdempotencyService, Depends(_idempotency)]
TheFrames = Annotated[FrameService, Depends(_frames)]
TheLinks = Annotated[LinkService, Depends(_links)]
TheLeases = Annotated[LeaseService, Depends(_leases)]
TheSolving = Annotated[SolvingService, Depends(_solving)]
TheJobs = Annotated[JobService, Depends(_jobs)]
TheExecutions = Annotated[ExecutionService, Depends(_executions)]
TheComparisons = Annotated[ComparisonService, Depends(_comparisons)]
