import asyncio
import functools
import os
import signal
import time
from collections.abc import Awaitable, Callable
from multiprocessing.context import SpawnProcess
from pathlib import Path

import pytest

from app.services.solving.pool import SolverPool
from app.services.solving.process import SolverLost


def _nothing() -> None:
    pass


def _pid_after(seconds: float) -> int:
    time.sleep(seconds)
    return os.getpid()


def _fail() -> None:
    raise ValueError("just so")


def _long_answer() -> bytes:
    return bytes(100_000_000)


def _die_once(mark: str) -> None:
    """Preparation that fails the first time."""
    if not Path(mark).exists():
        Path(mark).touch()
        os._exit(1)


def run(test: Callable[[SolverPool], Awaitable[None]], workers: int = 1) -> None:
    async def with_pool() -> None:
        pool = SolverPool(workers, _nothing)
        try:
            async with asyncio.timeout(60):
                await test(pool)
        finally:
            await pool.close()

    asyncio.run(with_pool())


def test_tasks_are_shared_by_the_processes() -> None:
    async def test(pool: SolverPool) -> None:
        pids = await asyncio.gather(*(pool.run(_pid_after, 0.3) for _ in range(6)))
        assert len(set(pids)) == 2
        assert pool.is_warm

    run(test, workers=2)


def test_one_task_fails_alone() -> None:
    async def test(pool: SolverPool) -> None:
        with pytest.raises(ValueError, match="just so"):
            await pool.run(_fail)
        assert await pool.run(_pid_after, 0.0) > 0

    run(test)


def test_a_process_that_dies_takes_its_own_task_with_it_and_no_other() -> None:
    async def test(pool: SolverPool) -> None:
        doomed = await pool.run(_pid_after, 0.0)
        over_it = asyncio.ensure_future(pool.run(_long_answer))
        behind_it = asyncio.ensure_future(pool.run(_pid_after, 0.0))
        await asyncio.sleep(0.03)
        os.kill(doomed, signal.SIGKILL)
        with pytest.raises(SolverLost):
            await over_it
        assert await behind_it != doomed

    run(test)


def test_one_that_dies_idle_costs_nobody_anything() -> None:
    async def test(pool: SolverPool) -> None:
        doomed = await pool.run(_pid_after, 0.0)
        os.kill(doomed, signal.SIGKILL)
        await asyncio.sleep(0.3)
        assert not pool.is_warm
        assert await pool.run(_pid_after, 0.0) != doomed

    run(test)


def test_one_that_dies_idle_is_replaced_before_anybody_asks() -> None:
    async def test(pool: SolverPool) -> None:
        doomed = await pool.run(_pid_after, 0.0)
        os.kill(doomed, signal.SIGKILL)
        while pool.is_warm:
            await asyncio.sleep(0.01)
        while not pool.is_warm:
            await asyncio.sleep(0.01)
        assert await pool.run(_pid_after, 0.0) != doomed

    run(test)


def test_what_nobody_waits_for_is_not_begun() -> None:
    async def test(pool: SolverPool) -> None:
        first = asyncio.ensure_future(pool.run(_pid_after, 1.0))
        given_up = asyncio.ensure_future(pool.run(_pid_after, 50.0))
        await asyncio.sleep(0.2)
        given_up.cancel()
        assert await pool.run(_pid_after, 0.0) == await first

    run(test)


def test_closing_ends_what_runs_and_what_waits() -> None:
    async def test() -> None:
        pool = SolverPool(1, _nothing)
        await pool.run(_pid_after, 0.0)
        tasks = [asyncio.ensure_future(pool.run(_pid_after, 60.0)) for _ in range(3)]
        await asyncio.sleep(0.2)
        async with asyncio.timeout(10):
            await pool.close()
            ends = await asyncio.gather(*tasks, return_exceptions=True)
        assert [type(end) for end in ends] == [asyncio.CancelledError] * 3

    asyncio.run(test())


def test_a_system_that_starts_no_process_is_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    async def test(pool: SolverPool) -> None:
        doomed = await pool.run(_pid_after, 0.0)
        refusals = iter([OSError("no more processes")] * 2)
        start = SpawnProcess.start

        def start_later(process: SpawnProcess) -> None:
            for refusal in refusals:
                raise refusal
            start(process)

        monkeypatch.setattr(SpawnProcess, "start", start_later)
        os.kill(doomed, signal.SIGKILL)
        await asyncio.sleep(0.3)
        assert await pool.run(_pid_after, 0.0) != doomed
        assert next(refusals, None) is None

    run(test)


def test_one_that_cannot_be_prepared_is_started_again(tmp_path: Path) -> None:
    async def test() -> None:
        pool = SolverPool(1, functools.partial(_die_once, str(tmp_path / "mark")))
        try:
            async with asyncio.timeout(60):
                assert not pool.is_warm
                assert await pool.run(_pid_after, 0.0) > 0
                assert pool.is_warm
        finally:
            await pool.close()

    asyncio.run(test())
