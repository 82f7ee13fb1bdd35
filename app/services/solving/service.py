"""Solving in other processes, so that the event loop stays free and a crash stays outside."""

import asyncio
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager
from dataclasses import replace
from functools import partial
from typing import Any, TypeVar

from app.observation.logs import LogOptions
from app.observation.measures import Measures, PlanFigures
from app.services.exceptions import Unavailable
from app.services.plans.batch_reading import BatchLimits, JobOrder, PlanOrder, read_batch
from app.services.plans.parts import (
    Totals,
    added,
    head_of,
    joined,
)
from app.services.plans.selecting import selection_to_json
from app.services.solving.pool import SolverPool
from app.services.solving.process import SolverLost
from app.services.solving.work import prepare, solve_share, solve_to_json
from solver import Problem, RigidTransform, plans_together

Result = TypeVar("Result")

SHARED_TARGETS = 200
"""Independent batches from this size on are shared by all workers; below, sharing costs more."""

# A plan takes from milliseconds to seconds, so a queue of them is shorter after this.
OVERLOAD_RETRY_S = 2


class SolvingService:
    """What the solver processes do for the service. It lives on the event loop.

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
        measures: Measures,
        logs: LogOptions,
    ) -> None:
        self._workers = workers
        self._most_waiting = most_waiting
        self._measures = measures
        self._tasks = self._solving = 0
        self._pool = SolverPool(workers, partial(prepare, logs))

    @property
    def is_ready(self) -> bool:
        """Whether the processes have their kernels."""
        return self._pool.is_warm

    async def solve(self, problem: Problem, plan_id: str) -> bytes:
        """The answer's body for a problem.

        Raises:
            Unavailable: the worker died over it, or too many are waiting.
        """
        async with self._place():
            answer, figures = await self._solve(problem, plan_id)
        self._measures.solved(figures)
        return answer

    @asynccontextmanager
    async def _place(self) -> AsyncIterator[None]:
        """One of the places for batches; what ends the solver over it is told as Unavailable."""
        if self._solving >= self._workers + self._most_waiting:
            raise Unavailable(
                "overloaded", "Too many plans are waiting.", retry_after_s=OVERLOAD_RETRY_S
            )
        self._solving += 1
        try:
            yield
        except SolverLost:
            raise Unavailable(
                "solver_unavailable", "The solver was lost; it has been started again."
            ) from None
        except asyncio.CancelledError:
            # Only the server's shutdown cancels a request; its client still gets an answer.
            raise Unavailable("solver_unavailable", "The service is shutting down.") from None
        finally:
            self._solving -= 1

    async def _solve(self, problem: Problem, plan_id: str) -> tuple[bytes, PlanFigures]:
        independent = problem.options.order == "independent" and plans_together(problem)
        shared = self._workers > 1 and len(problem.targets) >= SHARED_TARGETS
        if not (shared and independent):
            return await self.run(solve_to_json, problem, plan_id)
        size = -(-len(problem.targets) // self._workers)
        shares = [
            replace(problem, targets=problem.targets[first : first + size])
            for first in range(0, len(problem.targets), size)
        ]
        solved = await asyncio.gather(*(self.run(solve_share, share) for share in shares))
        figures = added(part.figures for part in solved)
        totals = Totals(
            figures.planned,
            figures.targets - figures.planned,
            sum(part.effort for part in solved),
            figures.elapsed_s,
        )
        head = head_of(problem, plan_id, totals)
        return b"".join(joined(head, (part.approaches for part in solved))), figures

    async def read(
        self,
        body: bytes,
        limits: BatchLimits,
        as_job: bool,
        frames: Mapping[str, RigidTransform],
    ) -> PlanOrder | JobOrder:
        """What a large body asks for; see `app.services.plans.batch_reading.read_batch`.

        Raises:
            InvalidRequest: the request makes no sense.
            Unavailable: the worker died over it, or too many are waiting.
        """
        async with self._place():
            return await self.run(read_batch, body, limits, as_job, frames.get)

    async def select(self, body: bytes) -> bytes:
        """The answer to a large thinning selection; see `app.services.plans.selecting`.

        Raises:
            InvalidRequest: the request makes no sense.
            Unavailable: as for `read`.
        """
        async with self._place():
            return await self.run(selection_to_json, body)

    async def run(self, work: Callable[..., Result], *arguments: Any) -> Result:
        """A function's result, computed in a solver process; function and arguments are sent there.

        Raises:
            SolverLost: the worker died over it.
        """
        self._count(1)
        try:
            return await self._pool.run(work, *arguments)
        except SolverLost:
            self._measures.solver_lost()
            raise
        finally:
            self._count(-1)

    def _count(self, change: int) -> None:
        self._tasks += change
        running = min(self._tasks, self._workers)
        self._measures.solver_load(running, self._tasks - running)

    async def close(self) -> None:
        """End the processes at once, whatever they do."""
        await self._pool.close()
