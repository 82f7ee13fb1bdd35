"""Solver processes and one queue of tasks for them; one that dies is started again."""

import asyncio
import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, TypeVar

from app.services.solving.process import SolverLost, SolverNotStarted, SolverProcess

logger = logging.getLogger(__name__)

Result = TypeVar("Result")

RESTART_S: Final = 1.0
"""Between two tries to start a process that cannot be prepared."""

IDLE_LOOK_S: Final = 1.0
"""So often one that has nothing to do is looked at; the service is not ready without it."""


@dataclass(frozen=True)
class _Task:
    work: Callable[..., Any]
    arguments: tuple[Any, ...]
    answer: asyncio.Future[Any]


class SolverPool:
    """It lives on the event loop and is used there only.

    Args:
        workers: how many processes.
        prepare: what each runs first; a function of a module, as it is sent there.
    """

    def __init__(self, workers: int, prepare: Callable[[], None]) -> None:
        self._prepare = prepare
        self._tasks: asyncio.Queue[_Task] = asyncio.Queue()
        self._processes = [SolverProcess(prepare) for _ in range(workers)]
        self._keepers = [asyncio.create_task(self._keep(slot)) for slot in range(workers)]

    @property
    def is_warm(self) -> bool:
        """Whether every process has been prepared and lives."""
        return all(process.is_warm for process in self._processes)

    async def run(self, work: Callable[..., Result], *arguments: Any) -> Result:
        """Run a function of a module in the first process that is free.

        Raises:
            SolverLost: the process died over it.
            Exception: whatever `work` raises.
        """
        answer: asyncio.Future[Result] = asyncio.get_running_loop().create_future()
        self._tasks.put_nowait(_Task(work, arguments, answer))
        return await answer

    async def _keep(self, slot: int) -> None:
        while True:
            process, warmed = self._processes[slot], False
            try:
                await process.ready()
                warmed = True
                await self._serve(process)
            except SolverLost:
                logger.error("a solver process died; another is started")
                if not warmed:
                    await asyncio.sleep(RESTART_S)
            await asyncio.to_thread(process.end)
            self._processes[slot] = await self._started()

    async def _started(self) -> SolverProcess:
        while True:
            try:
                return SolverProcess(self._prepare)
            except SolverNotStarted:
                logger.exception("no solver process can be started")
                await asyncio.sleep(RESTART_S)

    async def _serve(self, process: SolverProcess) -> None:
        while True:
            try:
                async with asyncio.timeout(IDLE_LOOK_S):
                    task = await self._tasks.get()
            except TimeoutError:
                if not process.is_alive:
                    raise SolverLost from None
                continue
            if task.answer.done():
                continue  # nobody waits for it any more
            if not process.is_alive:
                # It died idle: nothing was lost, so whoever asks need not know.
                self._tasks.put_nowait(task)
                raise SolverLost
            await _run(process, task)

    async def close(self) -> None:
        """End the processes at once, whatever they do."""
        for keeper in self._keepers:
            keeper.cancel()
        await asyncio.gather(*self._keepers, return_exceptions=True)
        while not self._tasks.empty():
            self._tasks.get_nowait().answer.cancel()
        await asyncio.gather(*(asyncio.to_thread(each.end) for each in self._processes))


async def _run(process: SolverProcess, task: _Task) -> None:
    try:
        result = await process.call(task.work, *task.arguments)
    except asyncio.CancelledError:
        task.answer.cancel()
        raise
    except Exception as error:
        if not task.answer.done():
            task.answer.set_exception(error)
        if isinstance(error, SolverLost):
            raise
    else:
        if not task.answer.done():
            task.answer.set_result(result)
