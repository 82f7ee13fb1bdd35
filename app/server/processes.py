"""Prunus's own commands as processes of their own, as the demonstration runs them."""

import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from queue import Empty, Queue

STOP_TIMEOUT_S = 15.0
# What `prunus serve` says first, before its address.
READY_LINE = "Prunus listens on "


class ProcessFailed(Exception):
    """A process did not do what it was started for, and what it did instead."""


class OwnProcess:
    """A command that runs; `first_line` waits for what it says first."""

    def __init__(self, name: str, process: "subprocess.Popen[str]") -> None:
        self._name = name
        self._process = process

    def first_line(self, timeout_s: float) -> str:
        """The first line of its standard output.

        Raises:
            ProcessFailed: it ended, or said nothing for `timeout_s`.
        """
        lines: Queue[str] = Queue()
        stdout = self._process.stdout
        if stdout is None:
            raise ProcessFailed(f"{self._name} has no standard output")
        threading.Thread(target=lambda: lines.put(stdout.readline()), daemon=True).start()
        try:
            line = lines.get(timeout=timeout_s)
        except Empty:
            raise ProcessFailed(f"{self._name} said nothing for {timeout_s:g} s") from None
        if not line:
            raise ProcessFailed(f"{self._name} ended at once")
        return line.rstrip("\n")

    @property
    def is_alive(self) -> bool:
        """Whether it has not ended."""
        return self._process.poll() is None


@contextmanager
def own_process(name: str, *arguments: str) -> Iterator[OwnProcess]:
    """Run `prunus NAME ...` until the block ends; what it complained of is shown if that fails."""
    command = [sys.executable, "-m", "app", name, *arguments]
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
        )
        try:
            yield OwnProcess(name, process)
        except BaseException:
            errors.seek(0)
            sys.stderr.write(errors.read().decode(errors="replace"))
            raise
        finally:
            process.terminate()
            try:
                process.wait(STOP_TIMEOUT_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            if process.stdout:
                process.stdout.close()
