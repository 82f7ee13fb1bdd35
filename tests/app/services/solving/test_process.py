import asyncio
import contextlib
import os
import random
import resource
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Future
from pathlib import Path
from typing import Any, NoReturn

import pytest

from app.services.solving.process import SolverLost, SolverNotStarted, SolverProcess
from tests.app.conftest import REPOSITORY, lives, wait_until
from tests.app.services.solving import work

END_S = 30


@contextlib.contextmanager
def running() -> Iterator[SolverProcess]:
    process = SolverProcess(prepare=work.nothing)
    try:
        yield process
    finally:
        process.end()


def call(process: SolverProcess, function: Any, *arguments: Any) -> Future[Any]:
    """The answer, awaited on a loop of its own, so that the caller can go on."""
    answer: Future[Any] = Future()

    async def wait() -> None:
        try:
            answer.set_result(await process.call(function, *arguments))
        except BaseException as error:
            answer.set_exception(error)

    threading.Thread(target=lambda: asyncio.run(wait())).start()
    return answer


def test_answers_come_one_after_another() -> None:
    with running() as process:
        answers = [call(process, work.count_bytes, count) for count in (3, 10_000_000, 0)]
        assert sorted(len(answer.result(END_S)) for answer in answers) == [0, 3, 10_000_000]
        assert process.is_warm


def test_what_the_work_raises_is_raised_here_with_its_place() -> None:
    with running() as process:
        with pytest.raises(ValueError, match="just so") as caught:
            call(process, work.fail, "just so").result(END_S)
        assert "in fail" in "".join(caught.value.__notes__)
        # It could not be built again on this side.
        with pytest.raises(RuntimeError, match="Particular: particular case"):
            call(process, work.fail_particularly).result(END_S)
        with pytest.raises(Exception, match="pickle"):
            call(process, work.unsendable).result(END_S)
        with pytest.raises(Exception, match="pickle"):
            call(process, work.count_bytes, threading.Lock()).result(END_S)
        assert call(process, work.count_bytes, 1).result(END_S) == b"\0"


def test_one_that_is_ended_over_its_work_is_lost(tmp_path: Path) -> None:
    begun = tmp_path / "begun"
    with running() as process:
        answer = call(process, work.begin_and_sleep, str(begun))
        wait_until(begun.exists, END_S)
        process.end()
        with pytest.raises(SolverLost):
            answer.result(END_S)
        with pytest.raises(SolverLost):
            call(process, work.pid).result(END_S)
        process.end()
    assert not process.is_alive


def test_what_cannot_even_be_started_is_said_so(monkeypatch: pytest.MonkeyPatch) -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (3, hard))  # no file more
    try:
        with pytest.raises(SolverNotStarted):
            SolverProcess(prepare=work.nothing)
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))

    def fail(*_: Any) -> NoReturn:
        raise RuntimeError("can't start new thread")

    for broken in ("multiprocessing.context.SpawnProcess.start", "threading.Thread.start"):
        with monkeypatch.context() as patch:
            patch.setattr(broken, fail)
            with pytest.raises(SolverNotStarted):
                SolverProcess(prepare=work.nothing)
    with running() as process:
        assert call(process, work.count_bytes, 1).result(END_S) == b"\0"


def test_one_that_cannot_start_is_lost() -> None:
    process = SolverProcess(prepare=work.fail_to_start)
    with pytest.raises(SolverLost):
        call(process, work.pid).result(END_S)
    assert not process.is_warm
    process.end()


@pytest.mark.parametrize("seed", range(8))
def test_one_that_dies_over_a_long_answer_is_lost_and_not_waited_for(seed: int) -> None:
    """The standard library's pool waits for ever for the second half of what it began to send."""
    with running() as process:
        pid = call(process, work.pid).result(END_S)
        answer = call(process, work.count_bytes, 100_000_000)
        time.sleep(random.Random(seed).uniform(0.0, 0.1))
        os.kill(pid, signal.SIGKILL)
        with contextlib.suppress(SolverLost):
            answer.result(END_S)
        with pytest.raises(SolverLost):
            call(process, work.pid).result(END_S)


def test_it_ends_with_the_process_that_started_it_whatever_it_does(tmp_path: Path) -> None:
    program = """
import asyncio, os, signal, sys
from app.services.solving.process import SolverProcess
from tests.app.services.solving import work

async def begin():
    process = SolverProcess(prepare=work.nothing)
    print(await process.call(work.pid), flush=True)
    asyncio.get_running_loop().call_later(0.5, os.kill, os.getpid(), signal.SIGKILL)
    await process.call(work.begin_and_sleep, sys.argv[1])

if __name__ == "__main__":
    asyncio.run(begin())
"""
    command = [sys.executable, "-c", program, str(tmp_path / "begun")]
    started = subprocess.run(command, cwd=REPOSITORY, stdout=subprocess.PIPE, check=False)
    assert started.returncode == -signal.SIGKILL
    wait_until(lambda: not lives(int(started.stdout)), END_S)
