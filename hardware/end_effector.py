"""The end-effector: something at the tool that is on for the dwell, and off otherwise.

Its output belongs to a guard process (`hardware.end_effector_guard`) that switches it off when the
worker dies, hangs, or forgets to say that it shall stay on: off is commanded and verified, never
assumed from a process that is gone. A new kind is an output for the guard and a row here.
"""

import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from selectors import EVENT_READ, DefaultSelector
from types import MappingProxyType
from typing import Final, Protocol

from hardware.exceptions import EndEffectorFailed
from hardware.tolerances import GUARD_ANSWER_S, RENEW_S

ON: Final = "on"
OFF: Final = "off"
NONE: Final = "none"
UNKNOWN: Final = "unknown"


class EndEffector(Protocol):
    """What the worker needs of an end-effector."""

    @property
    def state(self) -> str:
        """What was verified last: on, off, none (there is none), or unknown."""

    def switch(self, *, on: bool) -> None:
        """Switch it, and verify; EndEffectorFailed if it is not as commanded."""

    def stay_on(self) -> None:
        """To be called every tick while it is on; EndEffectorFailed if it is not on any more."""

    def close(self) -> None:
        """Off, and no more calls."""


class NoEndEffector:
    """Nothing is mounted: the dwell is a wait."""

    state = NONE

    def switch(self, *, on: bool) -> None:
        """Nothing to switch."""

    def stay_on(self) -> None:
        """Nothing to renew."""

    def close(self) -> None:
        """Nothing to close."""


class GuardedEndEffector:
    """An output in the hands of a guard process.

    Args:
        output: name of the output, see `hardware.end_effector_guard`.
        record: file to which the guard writes every change, or None.

    Raises:
        EndEffectorFailed: the guard does not start with the output off.
    """

    def __init__(self, output: str, record: Path | None) -> None:
        command = [sys.executable, "-m", "hardware.end_effector_guard", output]
        if record is not None:
            command.append(str(record))
        # Unbuffered: a word is with the guard, or it is an error, when the call returns.
        self._guard = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0
        )
        self._state = UNKNOWN
        self._renewed = 0.0
        self._expect(OFF)

    @property
    def state(self) -> str:
        """What was verified last."""
        return self._state

    def switch(self, *, on: bool) -> None:
        """Switch it, and verify."""
        wanted = ON if on else OFF
        self._tell(wanted)
        self._expect(wanted)
        self._renewed = time.monotonic()

    def stay_on(self) -> None:
        """Tell the guard, often enough, that it shall stay on."""
        if time.monotonic() - self._renewed >= RENEW_S:
            self._tell("stay")
            self._expect(ON)
            self._renewed = time.monotonic()

    def close(self) -> None:
        """Off: the guard ends when nobody talks to it any more."""
        for pipe in (self._guard.stdin, self._guard.stdout):
            if pipe is not None:
                pipe.close()
        self._guard.wait(GUARD_ANSWER_S)
        self._state = OFF if self._guard.returncode == 0 else UNKNOWN

    def _tell(self, word: str) -> None:
        self._state = UNKNOWN
        try:
            if self._guard.stdin is not None:
                self._guard.stdin.write(f"{word}\n".encode())
        except OSError as error:
            detail = "the end-effector's guard is gone; its state is unknown"
            raise EndEffectorFailed(detail) from error

    def _expect(self, wanted: str) -> None:
        with DefaultSelector() as selector:
            stdout = self._guard.stdout
            if stdout is None:
                return
            selector.register(stdout, EVENT_READ)
            answered = bool(selector.select(GUARD_ANSWER_S))
            answer = stdout.readline().decode().strip() if answered else ""
        if answer in (ON, OFF):
            self._state = answer
        if answer != wanted:
            said = f"says {answer!r}" if answer else "does not answer"
            raise EndEffectorFailed(f"the end-effector was to be {wanted}; its guard {said}")


Factory = Callable[[Path | None], EndEffector]

END_EFFECTORS: Final[Mapping[str, Factory]] = MappingProxyType(
    {
        "none": lambda record: NoEndEffector(),
        "simulated": lambda record: GuardedEndEffector("simulated", record),
    }
)
