"""A process that solves: one task at a time, and its death is noticed whenever it comes.

The standard library's pool keeps both ends of the pipes to its processes open. When one of them is
killed while it sends an answer, the pool waits for the rest of it for ever. Here the far end of a
process's pipe is open in that process alone.
"""

import asyncio
import contextlib
import logging
import multiprocessing
import os
import signal
import threading
import traceback
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from multiprocessing.connection import Connection
from multiprocessing.reduction import ForkingPickler
from queue import SimpleQueue
from typing import Any, TypeVar

logger = logging.getLogger(__name__)

Result = TypeVar("Result")


class SolverLost(Exception):
    """A solver process died, or was ended, over what it was given or before."""


class SolverNotStarted(SolverLost):
    """The system starts no process now; whatever it was for is not to blame."""


class SolverProcess:
    """Started at once; it ends with the process that started it, however that ends.

    Args:
        prepare: what it runs first; a function of a module, as it is sent there.
        niceness: added to that of this process, before anything is loaded there.

    Raises:
        SolverNotStarted: no process can be started.
    """

    def __init__(self, prepare: Callable[[], None], niceness: int = 0) -> None:
        context = multiprocessing.get_context("spawn")
        try:
            self._pipe, far_end = context.Pipe()
        except OSError as error:
            raise SolverNotStarted from error
        self._process = context.Process(target=_serve, args=(far_end, niceness), daemon=True)
        # Sending and receiving block, so they have a thread; it is also what keeps tasks in order.
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="solver-process")
        self._ending = threading.Lock()
        try:
            self._process.start()
            self._ready: Future[None] = self._thread.submit(self._begin, prepare)
        except (OSError, RuntimeError) as error:  # no process, or no thread
            self.end()
            raise SolverNotStarted from error
        finally:
            far_end.close()

    @property
    def is_alive(self) -> bool:
        """Whether it runs; one that just died may still be said to."""
        return self._process.is_alive()

    @property
    def is_warm(self) -> bool:
        """Whether it has been prepared and lives."""
        prepared = self._ready.done() and self._ready.exception() is None
        return prepared and self.is_alive

    async def ready(self) -> None:
        """Wait until it is prepared.

        Raises:
            SolverLost: it could not be, or died.
        """
        await asyncio.wrap_future(self._ready)

    async def call(self, work: Callable[..., Result], *arguments: Any) -> Result:
        """Run a function of a module there, after whatever was asked for before.

        Raises:
            SolverLost: the process is gone.
            Exception: whatever `work` raises, with its place there as a note.
        """
        try:
            task = self._thread.submit(self._call, work, arguments)
        except RuntimeError:
            raise SolverLost from None  # it was ended
        return await asyncio.wrap_future(task)

    def _begin(self, prepare: Callable[[], None]) -> None:
        try:
            self._call(prepare, ())
        except SolverLost:
            raise
        except Exception:
            logger.exception("a solver process could not be prepared")
            self._process.kill()
            raise SolverLost from None

    def _call(self, work: Callable[..., Result], arguments: tuple[Any, ...]) -> Result:
        try:
            self._pipe.send((work, arguments))
            succeeded, value = self._pipe.recv()
        except (EOFError, OSError):
            raise SolverLost from None
        if not succeeded:
            raise value
        result: Result = value
        return result

    def end(self) -> None:
        """End it at once, whatever it does; this blocks until it is gone, and may be repeated."""
        with self._ending:
            if self._process.pid is not None:
                self._process.kill()
                self._process.join()
            self._thread.shutdown()
            self._pipe.close()


def _serve(pipe: Connection, niceness: int) -> None:
    if niceness:
        os.nice(niceness)
        with contextlib.suppress(AttributeError, OSError):
            # Batch work is not preferred after waking up; without such a class, niceness is it.
            os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    # Ctrl-C reaches the whole process group; the service decides when its processes end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    tasks: SimpleQueue[bytes] = SimpleQueue()
    threading.Thread(target=_take, args=(pipe, tasks), daemon=True).start()
    while True:
        message = tasks.get()
        try:
            work, arguments = ForkingPickler.loads(message)
            pipe.send((True, work(*arguments)))
        except Exception as error:
            pipe.send((False, _sendable(error)))


def _sendable(error: Exception) -> Exception:
    place = traceback.format_exc()
    try:
        ForkingPickler.loads(ForkingPickler.dumps(error))
    except Exception:
        error = RuntimeError(f"{type(error).__name__}: {error}")
    error.add_note(place)
    return error


def _take(pipe: Connection, tasks: "SimpleQueue[bytes]") -> None:
    """Read what comes, while it works as well: that is how it sees its service end."""
    while True:
        try:
            tasks.put(pipe.recv_bytes())
        except (EOFError, OSError):
            os._exit(0)
