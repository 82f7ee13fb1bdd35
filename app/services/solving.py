"""Solving in other processes, so that the event loop stays free and a crash stays outside."""

import asyncio
import logging
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection
from typing import TypeVar

import orjson

from app.errors import ProblemError
from app.logs import configure_logs
from app.services.comparing import ComparisonOrder, compare_to_bytes
from app.services.measures import Measures, NoMeasures, PlanFigures
from app.services.motions import target_motions
from app.services.parts import (
    SolvedPart,
    Totals,
    added,
    head_of,
    joined,
    plan_figures,
    solve_part,
)
from app.services.wire import plan_to_wire
from hardware.messages import Failure
from solver import Problem, solve
from solver.many_targets import plans_together
from solver.staged import choose

logger = logging.getLogger(__name__)

Result = TypeVar("Result")

SHARED_TARGETS = 200
"""Independent batches from this size on are shared by all workers; below, sharing costs more."""

# A plan takes from milliseconds to seconds, so a queue of them is shorter after this.
OVERLOAD_RETRY_S = 2


class SolverLost(Exception):
    """A solver process died over what it was given. The pool has been started again."""


def solve_to_json(problem: Problem, plan_id: str) -> tuple[bytes, PlanFigures]:
    """The answer's body, and its figures; runs in a worker."""
    plan = solve(problem)
    return orjson.dumps(plan_to_wire(plan, plan_id)), plan_figures(plan)


def solve_share(problem: Problem) -> SolvedPart:
    """A share of a batch of independent targets; runs in a worker."""
    _, part = solve_part(problem, choose(problem), 0, len(problem.targets), problem.start)
    return part


@dataclass(frozen=True)
class LogOptions:
    """How the solver processes log; see `app.logs`."""

    log_format: str = "json"
    level: str = "info"


def _start_worker(lifeline: Connection, logs: LogOptions, prepare: Callable[[], None]) -> None:
    configure_logs(logs.log_format, logs.level)
    prepare()
    # Ctrl-C reaches the whole process group; the service decides when its workers end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_service, args=(lifeline,), daemon=True).start()
    from solver.warm_up import warm_up

    warm_up()


def _end_with_service(lifeline: Connection) -> None:
    # Nothing is ever sent: it ends when the service closes its end, or is killed.
    lifeline.poll(None)
    os._exit(0)


def _is_warm() -> bool:
    return True


def _nothing() -> None:
    pass


class Pool:
    """An executor and the pipe its workers hang on; `prepare` runs in each of them first."""

    def __init__(
        self, workers: int, logs: LogOptions, prepare: Callable[[], None] = _nothing
    ) -> None:
        context = multiprocessing.get_context("spawn")
        self._far_end, self._near_end = context.Pipe(duplex=False)
        self.executor = ProcessPoolExecutor(
            workers,
            mp_context=context,
            initializer=_start_worker,
            initargs=(self._far_end, logs, prepare),
        )
        self.warming: list[Future[bool]] = [self.executor.submit(_is_warm) for _ in range(workers)]

    @property
    def is_warm(self) -> bool:
        """Whether every worker is there and has its kernels."""
        return all(future.done() and not future.exception() for future in self.warming)

    @property
    def is_lost(self) -> bool:
        """Whether a worker died warming up."""
        return any(future.done() and future.exception() for future in self.warming)

    def close(self) -> None:
        """End the workers at once, whatever they do."""
        self._near_end.close()
        self.executor.shutdown(wait=True, cancel_futures=True)
        self._far_end.close()


class SolvingService:
    """A pool of worker processes that is rebuilt when it breaks.

    Args:
        workers: how many processes.
        most_waiting: so many problems may wait for one of them.
        measures: who counts what they do.
        logs: how they log.
    """

    def __init__(
        self,
        workers: int,
        most_waiting: int,
        measures: Measures | None = None,
        logs: LogOptions | None = None,
    ) -> None:
        self._workers = workers
        self._most_waiting = most_waiting
        self._measures = measures or NoMeasures()
        self._logs = logs or LogOptions()
        self._tasks = self._solving = 0
        self._pool = Pool(workers, self._logs)
        self._lock = threading.Lock()

    async def is_ready(self) -> bool:
        """Whether the workers are there and warm; a pool that died warming up is started again."""
        if self._pool.is_lost:
            await asyncio.to_thread(self._replace, self._pool)
        return self._pool.is_warm

    async def solve(self, problem: Problem, plan_id: str) -> bytes:
        """The answer's body for a problem.

        Raises:
            ProblemError: 503, the worker died over it, or too many are waiting.
        """
        if self._solving >= self._workers + self._most_waiting:
            raise ProblemError(
                503, "overloaded", "Too many plans are waiting.", retry_after_s=OVERLOAD_RETRY_S
            )
        self._solving += 1
        try:
            answer, figures = await self._solve(problem, plan_id)
        except SolverLost:
            raise ProblemError(
                503, "solver_unavailable", "The solver was lost; it has been started again."
            ) from None
        except asyncio.CancelledError:
            # Only the server's shutdown cancels a request; its client still gets an answer.
            raise ProblemError(503, "solver_unavailable", "The service is shutting down.") from None
        finally:
            self._solving -= 1
        self._measures.solved(figures)
        return answer

    async def _solve(self, problem: Problem, plan_id: str) -> tuple[bytes, PlanFigures]:
        shared = self._workers > 1 and len(problem.targets) >= SHARED_TARGETS
        if not (shared and plans_together(problem)):
            return await self._run(lambda pool: pool.submit(solve_to_json, problem, plan_id))
        size = -(-len(problem.targets) // self._workers)
        shares = [
            replace(problem, targets=problem.targets[first : first + size])
            for first in range(0, len(problem.targets), size)
        ]
        solved = await asyncio.gather(*(self._share(share) for share in shares))
        figures = added(part.figures for part in solved)
        totals = Totals(
            figures.planned,
            figures.targets - figures.planned,
            sum(part.effort for part in solved),
            figures.elapsed_s,
        )
        head = head_of(problem, plan_id, totals)
        return b"".join(joined(head, (part.approaches for part in solved))), figures

    async def _share(self, share: Problem) -> SolvedPart:
        return await self._run(lambda pool: pool.submit(solve_share, share))

    async def motions(
        self, request: str, answer: str, execution_id: str
    ) -> tuple[str, ...] | Failure:
        """A stored plan's motions, verified anew; see `app.services.motions`.

        Raises:
            SolverLost: the worker died over it.
        """
        return await self._run(
            lambda pool: pool.submit(target_motions, request, answer, execution_id)
        )

    async def compare(self, order: ComparisonOrder) -> tuple[bytes, str]:
        """A comparison's JSON and page.

        Raises:
            SolverLost: the worker died over it.
        """
        return await self._run(lambda pool: pool.submit(compare_to_bytes, order))

    async def _run(self, submit: Callable[[ProcessPoolExecutor], Future[Result]]) -> Result:
        pool = self._pool
        self._count(1)
        try:
            try:
                future = submit(pool.executor)
            except BrokenProcessPool:
                # A worker died idle: nothing was lost, so the request need not know.
                pool = await asyncio.to_thread(self._replace, pool)
                future = submit(pool.executor)
            return await asyncio.wrap_future(future)
        except BrokenProcessPool:
            self._measures.solver_lost()
            await asyncio.to_thread(self._replace, pool)
            raise SolverLost from None
        finally:
            self._count(-1)

    def _count(self, change: int) -> None:
        self._tasks += change
        running = min(self._tasks, self._workers)
        self._measures.solver_load(running, self._tasks - running)

    def _replace(self, broken: Pool) -> Pool:
        with self._lock:
            if self._pool is broken:
                logger.error("a solver process died; the pool is rebuilt")
                self._pool = Pool(self._workers, self._logs)
                broken.close()
            return self._pool

    def close(self) -> None:
        """End the workers at once, whatever they do."""
        with self._lock:
            self._pool.close()
