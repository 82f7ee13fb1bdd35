"""Prometheus metrics, in a registry of the application's own."""

import platform
from collections.abc import Mapping
from typing import Final

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Gauge,
    Histogram,
    Info,
    ProcessCollector,
    generate_latest,
)

from app.observation.measures import PlanFigures

MEDIA_TYPE: Final = "text/plain; version=0.0.4; charset=utf-8"
BATCH_BUCKETS: Final = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10_000, 100_000)
SECONDS_BUCKETS: Final = (
    0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60, 300,
)  # fmt: skip


class Metrics:
    """Every metric of the service; it is what `app.observation.measures.Measures` asks for."""

    def __init__(self, version: str) -> None:
        self.registry = registry = CollectorRegistry()
        ProcessCollector(registry=registry)
        build = Info("prunus_build", "Version of Prunus and of Python.", registry=registry)
        build.info({"version": version, "python": platform.python_version()})
        self._requests = Counter(
            "prunus_http_requests",
            "Requests answered.",
            ("method", "route", "status"),
            registry=registry,
        )
        self._request_s = Histogram(
            "prunus_http_request_duration_seconds",
            "From a request's head to the last byte of its answer.",
            ("method", "route"),
            buckets=SECONDS_BUCKETS,
            registry=registry,
        )
        self._in_flight = Gauge(
            "prunus_http_requests_in_flight", "Requests being answered.", registry=registry
        )
        self._batch = Histogram(
            "prunus_batch_targets",
            "Targets of a solved batch.",
            buckets=BATCH_BUCKETS,
            registry=registry,
        )
        self._solve_s = Histogram(
            "prunus_solve_duration_seconds",
            "The solver's own time for a batch.",
            ("method",),
            buckets=SECONDS_BUCKETS,
            registry=registry,
        )
        self._targets = Counter(
            "prunus_targets",
            "Targets solved, by status and code of the reason (empty: planned).",
            ("status", "reason"),
            registry=registry,
        )
        self._running = Gauge(
            "prunus_solver_running", "Tasks that solver processes work on.", registry=registry
        )
        self._waiting = Gauge(
            "prunus_solver_queue_depth", "Tasks that wait for a solver process.", registry=registry
        )
        self._lost = Counter(
            "prunus_solver_losses", "Solver processes that died over a task.", registry=registry
        )
        self._workers = Gauge(
            "prunus_connected_workers", "Robots with a worker connected.", registry=registry
        )
        self._jobs = Gauge("prunus_jobs", "Stored jobs.", ("status",), registry=registry)
        self._executions = Gauge(
            "prunus_executions", "Stored executions.", ("status",), registry=registry
        )
        self._store_errors = Counter(
            "prunus_store_errors",
            "Errors that the database reported, and calls that waited for it in vain.",
            registry=registry,
        )

    def request_started(self) -> None:
        """A request has come."""
        self._in_flight.inc()

    def request_ended(self, method: str, route: str, status: int, elapsed_s: float) -> None:
        """It is answered, or given up."""
        self._in_flight.dec()
        self._requests.labels(method, route, str(status)).inc()
        self._request_s.labels(method, route).observe(elapsed_s)

    def solver_load(self, running: int, waiting: int) -> None:
        """So many tasks are with the solver processes now, and so many wait for one."""
        self._running.set(running)
        self._waiting.set(waiting)

    def solved(self, figures: PlanFigures) -> None:
        """A batch was solved."""
        self._batch.observe(figures.targets)
        self._solve_s.labels(figures.method).observe(figures.elapsed_s)
        if figures.planned:
            self._targets.labels("planned", "").inc(figures.planned)
        for code, count in figures.infeasible.items():
            self._targets.labels("infeasible", code).inc(count)

    def solver_lost(self) -> None:
        """A solver process died."""
        self._lost.inc()

    def store_failed(self) -> None:
        """The database reported an error."""
        self._store_errors.inc()

    def stored(self, jobs: Mapping[str, int], executions: Mapping[str, int]) -> None:
        """What the store holds now, by status."""
        for gauge, counts in ((self._jobs, jobs), (self._executions, executions)):
            gauge.clear()
            for status, count in counts.items():
                gauge.labels(status).set(count)

    def connected(self, workers: int) -> None:
        """So many robots have a worker."""
        self._workers.set(workers)

    def text(self) -> bytes:
        """Everything in Prometheus's text format."""
        return generate_latest(self.registry)
