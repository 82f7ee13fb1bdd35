"""The end-effector: something at the tool that is on for the dwell, and off otherwise.

Its output belongs to a guard process (`hardware.end_effector.guard`) that switches it off when the
worker dies, hangs, or forgets to say that it shall stay on: off is commanded and verified, never
assumed from a process that is gone. A new kind is an output for the guard and a row here.
"""

import contextlib
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from selectors import EVENT_READ, DefaultSelector
from types import MappingProxyType
from typing import Final, Protocol

from hardware.exceptions import EndEffectorFailed
from hardware.tolerances import GUARD_ANSWER_S, GUARD_START_S, RENEW_S

ON: Final = "on"
OFF: Final = "off"
NONE: Final = "none"
UNKNOWN: Final = "unknown"
GUARD_GONE: Final = "the end-effector's guard is gone; its state is unknown"


class EndEffector(Protocol):
    """What the worker needs of an end-effector."""

    @property
    def state(self) -> str:
        """What was verified last: on, off, none (there is none), or unknown."""

    def switch(self, *, on: bool) -> None:
        """Switch it, and verify; EndEffectorFailed if it is not as commanded."""

    def stay_on(self) -> None:
        """To be called every tick while it is on; EndEffectorFailed if it is not on any more."""

    def check(self) -> None:
        """To be called every tick; EndEffectorFailed if nobody can switch it any more."""

    def recover(self) -> None:
        """Make it work again, and verify that it is off; EndEffectorFailed if it does not."""

    def close(self) -> None:
        """Off, and no more calls."""


class NoEndEffector:
    """Nothing is mounted: the dwell is a wait."""

    state = NONE

    def switch(self, *, on: bool) -> None:
        """Nothing to switch."""

    def stay_on(self) -> None:
        """Nothing to renew."""

    def check(self) -> None:
        """Nothing to check."""

    def recover(self) -> None:
        """Nothing to recover."""

    def close(self) -> None:
        """Nothing to close."""


class GuardedEndEffector:
    """An output in the hands of a guard process.

    Args:
        output: name of the output, see `hardware.end_effector.guard`.
        record: file to which the guard writes every change, or None.

    Raises:
        EndEffectorFailed: the record cannot be written, or the guard does not start with the
            output off.
    """

    def __init__(self, output: str, record: Path | None) -> None:
        self._command = [sys.executable, "-m", "hardware.end_effector.guard", output]
        if record is not None:
            try:
                record.open("a").close()
            except OSError as error:
                raise EndEffectorFailed(f"{record}: {error.strerror}") from error
            self._command.append(str(record))
        self._start()

    @property
    def state(self) -> str:
        """What was verified last."""
        return self._state

    def switch(self, *, on: bool) -> None:
        """Switch it, and verify."""
        self._ask(ON if on else OFF, wanted=ON if on else OFF)

    def stay_on(self) -> None:
        """Tell the guard, often enough, that it shall stay on."""
        if time.monotonic() - self._told >= RENEW_S:
            self._ask("stay", wanted=ON)

    def check(self) -> None:
        """Whether the guard is there."""
        if self._guard.poll() is not None:
            self._state = UNKNOWN
            raise EndEffectorFailed(GUARD_GONE)

    def recover(self) -> None:
        """Another guard, which begins by switching off."""
        self._end_guard()
        self._start()

    def close(self) -> None:
        """Off: the guard ends when nobody talks to it any more."""
        if not self._end_guard():
            # One that is told nothing begins and ends with off.
            with contextlib.suppress(subprocess.TimeoutExpired):
                last = subprocess.run(
                    self._command,
                    input=b"",
                    stdout=subprocess.DEVNULL,
                    timeout=GUARD_START_S,
                    check=False,
                )
                self._state = OFF if last.returncode == 0 else UNKNOWN

    def _end_guard(self) -> bool:
        """Whether it ended as it should, which switches off."""
        for pipe in (self._guard.stdin, self._guard.stdout):
            if pipe is not None:
                pipe.close()
        try:
            self._guard.wait(GUARD_ANSWER_S)
        except subprocess.TimeoutExpired:
            self._guard.kill()
            self._guard.wait()
        ended = self._guard.returncode == 0
        self._state = OFF if ended else UNKNOWN
        return ended

    def _start(self) -> None:
        # Unbuffered: a word is with the guard, or it is an error, when the call returns.
        self._guard = subprocess.Popen(
            self._command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0
        )
        self._state = UNKNOWN
        self._told = 0.0
        self._number = 0
        self._await(wanted=OFF, timeout_s=GUARD_START_S)

    def _ask(self, word: str, *, wanted: str) -> None:
        self._state = UNKNOWN
        self._number += 1
        try:
            if self._guard.stdin is not None:
                self._guard.stdin.write(f"{self._number} {word}\n".encode())
        except OSError as error:
            raise EndEffectorFailed(GUARD_GONE) from error
        self._await(wanted=wanted, timeout_s=GUARD_ANSWER_S)
        self._told = time.monotonic()

    def _await(self, *, wanted: str, timeout_s: float) -> None:
        """Read up to the answer to the last word; earlier ones came too late to be of use."""
        deadline = time.monotonic() + timeout_s
        number, answer = "", ""
        with DefaultSelector() as selector:
            stdout = self._guard.stdout
            if stdout is None:
                return
            selector.register(stdout, EVENT_READ)
            while number != str(self._number):
                if not selector.select(max(0.0, deadline - time.monotonic())):
                    raise EndEffectorFailed(
                        f"the end-effector was to be {wanted}; its guard does not answer"
                    )
                number, _, answer = stdout.readline().decode().strip().partition(" ")
                if not number:
                    raise EndEffectorFailed(GUARD_GONE)
        self._state = answer
        if answer != wanted:
            raise EndEffectorFailed(f"the end-effector was to be {wanted}; its guard says {answer}")


Factory = Callable[[Path | None], EndEffector]

END_EFFECTORS: Final[Mapping[str, Factory]] = MappingProxyType(
    {
        "none": lambda record: NoEndEffector(),
        "simulated": lambda record: GuardedEndEffector("simulated", record),
    }
)
