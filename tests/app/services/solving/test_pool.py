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
from tests.app.conftest import lives


def _nothing() -> None:
    pass


def _pid() -> int:
    return os.getpid()


def _fail() -> None:
    raise ValueError("just so")


def _pid_when_all_are_there(folder: str, count: int) -> int:
    """The process's number, after so many processes are at work at the same time."""
    (Path(folder) / str(os.getpid())).touch()
    _wait(lambda: len(list(Path(folder).iterdir())) >= count)
    return os.getpid()


def _pid_when_told(begun: str, told: str) -> int:
    """The process's number, once a file is there; another one tells that it has begun."""
    Path(begun).touch()
    _wait(Path(told).exists)
    return os.getpid()


def _wait(condition: Callable[[], bool]) -> None:
    while not condition():
        time.sleep(0.01)


async def until(condition: Callable[[], bool]) -> None:
    while not condition():
        await asyncio.sleep(0.01)


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


def test_tasks_are_shared_by_the_processes(tmp_path: Path) -> None:
    async def test(pool: SolverPool) -> None:
        tasks = (pool.run(_pid_when_all_are_there, str(tmp_path), 2) for _ in range(2))
        assert len(set(await asyncio.gather(*tasks))) == 2
        assert pool.is_warm

    run(test, workers=2)


def test_one_task_fails_alone() -> None:
    async def test(pool: SolverPool) -> None:
        with pytest.raises(ValueError, match="just so"):
            await pool.run(_fail)
        assert await pool.run(_pid) > 0

    run(test)


def test_a_process_that_dies_takes_its_own_task_with_it_and_no_other(tmp_path: Path) -> None:
    async def test(pool: SolverPool) -> None:
        doomed, begun = await pool.run(_pid), tmp_path / "begun"
        never = str(tmp_path / "never")
        over_it = asyncio.ensure_future(pool.run(_pid_when_told, str(begun), never))
        behind_it = asyncio.ensure_future(pool.run(_pid))
        await until(begun.exists)
        os.kill(doomed, signal.SIGKILL)
        with pytest.raises(SolverLost):
            await over_it
        assert await behind_it != doomed

    run(test)


def test_one_that_dies_idle_costs_nobody_anything() -> None:
    async def test(pool: SolverPool) -> None:
        doomed = await pool.run(_pid)
        os.kill(doomed, signal.SIGKILL)
        await until(lambda: not lives(doomed))
        assert await pool.run(_pid) != doomed

    run(test)


def test_one_that_dies_idle_is_replaced_before_anybody_asks() -> None:
    async def test(pool: SolverPool) -> None:
        doomed = await pool.run(_pid)
        os.kill(doomed, signal.SIGKILL)
        await until(lambda: not pool.is_warm)
        await until(lambda: pool.is_warm)
        assert await pool.run(_pid) != doomed

    run(test)


def test_what_nobody_waits_for_is_not_begun(tmp_path: Path) -> None:
    begun, told, wrong = tmp_path / "begun", tmp_path / "told", tmp_path / "wrong"

    async def test(pool: SolverPool) -> None:
        first = asyncio.ensure_future(pool.run(_pid_when_told, str(begun), str(told)))
        given_up = asyncio.ensure_future(pool.run(_pid_when_told, str(wrong), str(told)))
        await until(begun.exists)
        given_up.cancel()
        told.touch()
        assert await pool.run(_pid) == await first
        assert not wrong.exists()

    run(test)


def test_closing_ends_what_runs_and_what_waits(tmp_path: Path) -> None:
    begun, never = tmp_path / "begun", str(tmp_path / "never")

    async def test() -> None:
        pool = SolverPool(1, _nothing)
        tasks = [
            asyncio.ensure_future(pool.run(_pid_when_told, str(begun), never)) for _ in range(3)
        ]
        await until(begun.exists)
        async with asyncio.timeout(10):
            await pool.close()
            ends = await asyncio.gather(*tasks, return_exceptions=True)
        assert [type(end) for end in ends] == [asyncio.CancelledError] * 3

    asyncio.run(test())


def test_a_system_that_starts_no_process_is_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    async def test(pool: SolverPool) -> None:
        doomed = await pool.run(_pid)
        refusals = iter([OSError("no more processes")] * 2)
        start = SpawnProcess.start

        def start_later(process: SpawnProcess) -> None:
            for refusal in refusals:
                raise refusal
            start(process)

        monkeypatch.setattr(SpawnProcess, "start", start_later)
        os.kill(doomed, signal.SIGKILL)
        await until(lambda: not lives(doomed))
        assert await pool.run(_pid) != doomed
        assert next(refusals, None) is None

    run(test)


def test_one_that_cannot_be_prepared_is_started_again(tmp_path: Path) -> None:
    async def test() -> None:
        pool = SolverPool(1, functools.partial(_die_once, str(tmp_path / "mark")))
        try:
            async with asyncio.timeout(60):
                assert not pool.is_warm
                assert await pool.run(_pid) > 0
                assert pool.is_warm
        finally:
            await pool.close()

    asyncio.run(test())
