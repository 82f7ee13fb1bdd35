"""Jobs: large batches that are answered later, solved part by part, and never twice.

A job is stored before it is accepted, and every part as soon as it is solved. Whatever ends the
service, the next start goes on behind the last part.
"""

import asyncio
import contextlib
import logging
import uuid
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass, field
from typing import Final

from sqlalchemy.exc import SQLAlchemyError

from app.observation.logs import LogOptions
from app.observation.measures import Measures
from app.services.exceptions import Conflict, NotFound, Unavailable
from app.services.jobs.process import JobProcess
from app.services.plans.batch_reading import JobOrder
from app.services.solving.pool import RESTART_S
from app.services.solving.process import SolverLost, SolverNotStarted
from app.services.store_calls import store_call
from app.store import ACCEPTED, JobEnded, JobRow, JobStore, KeyTaken, NewKey, new_entry
from app.store.failures import StoreBusy
from app.store.jobs import CANCELED, FAILED

logger = logging.getLogger(__name__)

PAUSES_S: Final = (0.0, 1.0, 5.0, 15.0)
"""Before the next tries of a part whose process died. It need not be to blame: when memory runs
out, whatever runs is killed, and that may go on for a while."""

FULL_RETRY_S: Final = 30
STORE_RETRY_S: Final = 2.0


@dataclass
class _Active:
    """A job that is waiting or running. `changed` is set, and renewed, with every change."""

    process: JobProcess | None = None
    canceled: bool = False
    changed: asyncio.Event = field(default_factory=asyncio.Event)

    def tell(self) -> None:
        self.changed.set()
        self.changed = asyncio.Event()


class JobService:
    """The jobs of the service. It lives on the event loop and is used there only.

    Args:
        store: where they are kept.
        workers: how many run at once, each in a process of its own.
        most_waiting: so many may wait or run.
        logs: how the processes log.
        measures: who counts what they do.
        stopping: set when the service begins to end.
    """

    def __init__(
        self,
        store: JobStore,
        *,
        workers: int,
        most_waiting: int,
        logs: LogOptions,
        measures: Measures,
        stopping: asyncio.Event,
    ) -> None:
        self._store = store
        self._workers = workers
        self._most_waiting = most_waiting
        self._logs = logs
        self._measures = measures
        self._stopping = stopping
        self._queue: asyncio.Queue[str] = asyncio.Queue()
        self._active: dict[str, _Active] = {}
        self._tasks: list[asyncio.Task[None]] = []

    async def start(self) -> None:
        """Take up what an earlier run of the service left, and begin to work."""
        for job_id in await store_call(self._store.active):
            self._enqueue(job_id)
        for _ in range(self._workers):
            self._tasks.append(asyncio.create_task(self._work(JobProcess(self._logs))))

    def _enqueue(self, job_id: str) -> None:
        self._active[job_id] = _Active()
        self._queue.put_nowait(job_id)

    async def create(
        self,
        order: JobOrder,
        answer_to: Callable[[JobRow], str],
        key: NewKey | None,
    ) -> JobRow:
        """Take on a job; it is stored as queued when this returns.

        Args:
            order: what is asked.
            answer_to: the body of the answer, which is kept under the key.
            key: that it was asked for under, if any.

        Raises:
            Unavailable: too many are waiting.
            KeyTaken: something was created under the key before.
        """
        if len(self._active) >= self._most_waiting:
            raise Unavailable(
                "jobs_full",
                f"{self._most_waiting} jobs are waiting or running.",
                retry_after_s=FULL_RETRY_S,
            )
        job_id = uuid.uuid4().hex
        # The place is taken before the job is stored, so that a burst does not overrun the limit.
        self._active[job_id] = _Active()
        try:
            job = await store_call(
                self._store.add,
                job_id,
                robot=order.robot,
                targets=order.targets,
                request=order.request,
                entry=lambda row: new_entry(key, ACCEPTED, f"/v1/jobs/{job_id}", answer_to(row)),
            )
        except (StoreBusy, KeyTaken):
            del self._active[job_id]
            raise
        except BaseException:
            # It may be stored all the same, and then its key answers for it.
            self._queue.put_nowait(job_id)
            raise
        self._queue.put_nowait(job_id)
        return job

    async def job(self, job_id: str) -> JobRow:
        """The job as it stands.

        Raises:
            NotFound: there is none of this id.
        """
        job = await store_call(self._store.job, job_id)
        if job is None:
            raise NotFound("not_found", "There is no job of this id.")
        return job

    async def newest(self) -> list[JobRow]:
        """The newest ones, newest first."""
        return await store_call(self._store.newest)

    async def cancel(self, job_id: str) -> JobRow:
        """End a job at once, whatever it does; what is solved stays.

        Raises:
            NotFound: there is none of this id.
            Conflict: it has ended.
        """
        job = await self.job(job_id)
        try:
            await store_call(self._store.end, job_id, CANCELED)
        except JobEnded:
            detail = f"The job is {(await self.job(job_id)).status}; this needs an active one."
            raise Conflict("wrong_state", detail) from None
        active = self._active.pop(job_id, None)
        if active is not None:
            active.canceled = True
            active.tell()
            if active.process is not None:
                await active.process.end()
        logger.info("job canceled", extra={"job_id": job.id})
        return await self.job(job_id)

    async def changes(self, job_id: str, heartbeat_s: float) -> AsyncIterator[JobRow | None]:
        """The job now and after every change until it has ended; None when nothing changed.

        It also ends when the service does.

        Raises:
            NotFound: there is none of this id.
        """
        while True:
            active = self._active.get(job_id)
            changed = None if active is None else active.changed
            job = await self.job(job_id)
            yield job
            if not job.active:
                return
            if changed is None:
                # Not this service's any more: it is just ending.
                if await self._wait(asyncio.Event(), STORE_RETRY_S):
                    return
                continue
            while not changed.is_set():
                if await self._wait(changed, heartbeat_s):
                    return
                if not changed.is_set():
                    yield None

    async def _wait(self, changed: asyncio.Event, seconds: float) -> bool:
        """Wait for a change; whether the service is ending."""
        waits = [asyncio.ensure_future(event.wait()) for event in (changed, self._stopping)]
        try:
            await asyncio.wait(waits, timeout=seconds, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for wait in waits:
                wait.cancel()
        return self._stopping.is_set()

    async def _work(self, process: JobProcess) -> None:
        try:
            while True:
                job_id = await self._queue.get()
                active = self._active.get(job_id)
                if active is None:
                    continue  # canceled while it waited
                active.process = process
                await self._run(job_id, active, process)
                active.process = None
                self._active.pop(job_id, None)
                active.tell()
        finally:
            await process.end()

    async def _run(self, job_id: str, active: _Active, process: JobProcess) -> None:
        """Work on a job until it has ended, whatever happens on the way."""
        died = 0
        progress = -1
        while True:
            try:
                await self._solve(job_id, active, process)
                return
            except JobEnded:
                return
            except SQLAlchemyError:
                # What is stored is whole. Nothing is lost by waiting until the store is back.
                logger.exception("the store failed job", extra={"job_id": job_id})
                await asyncio.sleep(STORE_RETRY_S)
            except SolverNotStarted:
                logger.exception("no process for jobs can be started", extra={"job_id": job_id})
                await asyncio.sleep(RESTART_S)
            except SolverLost:
                if active.canceled:
                    return
                self._measures.solver_lost()
                with contextlib.suppress(SQLAlchemyError):
                    done = (await self.job(job_id)).done
                    died, progress = (died + 1, done) if done == progress else (1, done)
                if died > len(PAUSES_S):
                    await self._fail(job_id, f"the solver was lost over it {died} times")
                    return
                await self._wait(active.changed, PAUSES_S[died - 1])  # a cancel is a change
            except Exception:
                logger.exception("job could not be solved", extra={"job_id": job_id})
                await self._fail(job_id, "it could not be solved; the service's log says more")
                return

    async def _solve(self, job_id: str, active: _Active, process: JobProcess) -> None:
        await store_call(self._store.start, job_id)
        active.tell()
        work = await store_call(self._store.work, job_id)
        choice = await process.load(job_id, work)
        if work.choice is None:
            await store_call(self._store.save_choice, job_id, choice)
        job = await self.job(job_id)
        number, first, reference = work.parts, work.done, work.reference
        while first < job.targets:
            part, figures = await process.part(job_id, number, first, reference)
            await store_call(self._store.add_part, job_id, part)
            self._measures.solved(figures)
            logger.info("job part stored", extra={"job_id": job_id, "part": number})
            number, first, reference = number + 1, first + figures.targets, part.reference
            active.tell()
        job = await self.job(job_id)
        answer = await process.head(job)
        await store_call(
            self._store.complete, job_id, robot=job.robot, request=work.request, answer=answer
        )
        logger.info("job completed", extra={"job_id": job_id})

    async def _fail(self, job_id: str, detail: str) -> None:
        while True:
            try:
                await store_call(self._store.end, job_id, FAILED, detail)
            except SQLAlchemyError:
                logger.exception("the store failed job", extra={"job_id": job_id})
                await asyncio.sleep(STORE_RETRY_S)
            except JobEnded:
                return
            else:
                return

    async def close(self) -> None:
        """Drop what is being solved; the next start goes on with it."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
