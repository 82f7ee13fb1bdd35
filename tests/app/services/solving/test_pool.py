import asyncio
import functools
import os
import signal
from collections.abc import Awaitable, Callable
from multiprocessing.context import SpawnProcess
from pathlib import Path

import pytest

from app.services.solving.pool import SolverPool
from app.services.solving.process import SolverLost
from tests.app.conftest import lives
from tests.app.services.solving import work


async def until(condition: Callable[[], bool]) -> None:
    while not condition():
        await asyncio.sleep(0.01)


def run(test: Callable[[SolverPool], Awaitable[None]], workers: int = 1) -> None:
    async def with_pool() -> None:
        pool = SolverPool(workers, work.nothing)
        try:
            async with asyncio.timeout(60):
                await test(pool)
        finally:
            await pool.close()

    asyncio.run(with_pool())


def test_tasks_are_shared_by_the_processes(tmp_path: Path) -> None:
    async def test(pool: SolverPool) -> None:
        tasks = (pool.run(work.pid_when_all_are_there, str(tmp_path), 2) for _ in range(2))
        assert len(set(await asyncio.gather(*tasks))) == 2
        assert pool.is_warm

    run(test, workers=2)


def test_one_task_fails_alone() -> None:
    async def test(pool: SolverPool) -> None:
        with pytest.raises(ValueError, match="just so"):
            await pool.run(work.fail, "just so")
        assert await pool.run(work.pid) > 0

    run(test)


def test_a_process_that_dies_takes_its_own_task_with_it_and_no_other(tmp_path: Path) -> None:
    async def test(pool: SolverPool) -> None:
        doomed, begun = await pool.run(work.pid), tmp_path / "begun"
        never = str(tmp_path / "never")
        over_it = asyncio.ensure_future(pool.run(work.pid_when_told, str(begun), never))
        behind_it = asyncio.ensure_future(pool.run(work.pid))
        await until(begun.exists)
        os.kill(doomed, signal.SIGKILL)
        with pytest.raises(SolverLost):
            await over_it
        assert await behind_it != doomed

    run(test)


def test_one_that_dies_idle_costs_nobody_anything() -> None:
    async def test(pool: SolverPool) -> None:
        doomed = await pool.run(work.pid)
        os.kill(doomed, signal.SIGKILL)
        await until(lambda: not lives(doomed))
        assert await pool.run(work.pid) != doomed

    run(test)


def test_one_that_dies_idle_is_replaced_before_anybody_asks() -> None:
    async def test(pool: SolverPool) -> None:
        doomed = await pool.run(work.pid)
        os.kill(doomed, signal.SIGKILL)
        await until(lambda: not pool.is_warm)
        await until(lambda: pool.is_warm)
        assert await pool.run(work.pid) != doomed

    run(test)


def test_what_nobody_waits_for_is_not_begun(tmp_path: Path) -> None:
    begun, told, wrong = tmp_path / "begun", tmp_path / "told", tmp_path / "wrong"

    async def test(pool: SolverPool) -> None:
        first = asyncio.ensure_future(pool.run(work.pid_when_told, str(begun), str(told)))
        given_up = asyncio.ensure_future(pool.run(work.pid_when_told, str(wrong), str(told)))
        await until(begun.exists)
        given_up.cancel()
        told.touch()
        assert await pool.run(work.pid) == await first
        assert not wrong.exists()

    run(test)


def test_closing_ends_what_runs_and_what_waits(tmp_path: Path) -> None:
    begun, never = tmp_path / "begun", str(tmp_path / "never")

    async def test() -> None:
        pool = SolverPool(1, work.nothing)
        tasks = [
            asyncio.ensure_future(pool.run(work.pid_when_told, str(begun), never)) for _ in range(3)
        ]
        await until(begun.exists)
        async with asyncio.timeout(10):
            await pool.close()
            ends = await asyncio.gather(*tasks, return_exceptions=True)
        assert [type(end) for end in ends] == [asyncio.CancelledError] * 3

    asyncio.run(test())


def test_a_system_that_starts_no_process_is_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    async def test(pool: SolverPool) -> None:
        doomed = await pool.run(work.pid)
        refusals = iter([OSError("no more processes")] * 2)
        start = SpawnProcess.start

        def start_later(process: SpawnProcess) -> None:
            for refusal in refusals:
                raise refusal
            start(process)

        monkeypatch.setattr(SpawnProcess, "start", start_later)
        os.kill(doomed, signal.SIGKILL)
        await until(lambda: not lives(doomed))
        assert await pool.run(work.pid) != doomed
        assert next(refusals, None) is None

    run(test)


def test_one_that_cannot_be_prepared_is_started_again(tmp_path: Path) -> None:
    async def test() -> None:
        pool = SolverPool(1, functools.partial(work.die_once, str(tmp_path / "mark")))
        try:
            async with asyncio.timeout(60):
                assert not pool.is_warm
                assert await pool.run(work.pid) > 0
                assert pool.is_warm
        finally:
            await pool.close()

    asyncio.run(test())
