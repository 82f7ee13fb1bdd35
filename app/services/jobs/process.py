"""One process for jobs: at low priority, one job at a time, and ended at once to cancel."""

import asyncio
from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from app.observation.logs import LogOptions
from app.observation.measures import PlanFigures
from app.services.jobs.work import choose_for_job, load_job, plan_head, solve_part
from app.services.plans.parts import Totals
from app.services.solving.process import SolverLost, SolverProcess
from app.services.solving.work import prepare
from app.store import JobRow, JobWork, NewPart

Result = TypeVar("Result")

NICENESS = 15
"""Added to the niceness of the service: a job takes what plans and the service itself leave."""


class JobProcess:
    """For the event loop only.

    Args:
        logs: how the process logs.
    """

    def __init__(self, logs: LogOptions) -> None:
        self._logs = logs
        self._process: SolverProcess | None = None

    async def load(self, job_id: str, work: JobWork) -> str:
        """Make a job ready; what its batch decided as one, as text.

        Raises:
            SolverNotStarted: there is no process now.
            SolverLost: the process died, or was ended.
        """
        if self._process is not None and not self._process.is_alive:
            await self.end()  # it died idle, and no job is to blame
        if self._process is None:
            self._process = SolverProcess(partial(prepare, self._logs), NICENESS)
        await self._run(load_job, job_id, work.request, work.choice)
        if work.choice is not None:
            return work.choice
        return await self._run(choose_for_job, job_id)

    async def part(
        self, job_id: str, number: int, first: int, reference: str | None
    ) -> tuple[NewPart, PlanFigures]:
        """The next part of the job that is loaded.

        Raises:
            SolverLost: the process died, or was ended.
        """
        return await self._run(solve_part, job_id, number, first, reference)

    async def head(self, job: JobRow) -> str:
        """The answer of the loaded job's plan without its approaches.

        Raises:
            SolverLost: the process died, or was ended.
        """
        totals = Totals(job.planned, job.infeasible, job.total_effort, job.elapsed_s)
        return await self._run(plan_head, job.id, totals)

    async def _run(self, work: Callable[..., Result], *arguments: Any) -> Result:
        if self._process is None:
            raise SolverLost  # ended between two calls, and a new one would not have the job
        try:
            return await self._process.call(work, *arguments)
        except SolverLost:
            await self.end()
            raise

    async def end(self) -> None:
        """End the process at once, whatever it does; the next job starts another."""
        process, self._process = self._process, None
        if process is not None:
            await asyncio.to_thread(process.end)
