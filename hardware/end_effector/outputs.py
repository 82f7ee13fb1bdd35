"""The outputs that a guard may own, a row each: `hardware.end_effector.guard`."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final, Protocol

from hardware.clock import timestamp


class Output(Protocol):
    """A pin, a relay, a servo: something that is on or off and can tell which."""

    def set(self, *, on: bool, why: str) -> None:
        """Switch it."""

    def is_on(self) -> bool:
        """Read it back."""


class SimulatedOutput:
    """An output that writes each change to a file, one line: instant, state, why."""

    def __init__(self, record: Path | None) -> None:
        self._on = False
        self._record = record

    def set(self, *, on: bool, why: str) -> None:
        """Switch it."""
        self._on = on
        if self._record is not None:
            with self._record.open("a", encoding="utf-8") as file:
                file.write(f"{timestamp()} {word(on)} {why}\n")

    def is_on(self) -> bool:
        """Read it back."""
        return self._on


OUTPUTS: Final[Mapping[str, Callable[[Path | None], Output]]] = MappingProxyType(
    {"simulated": SimulatedOutput}
)


def word(on: bool) -> str:
    """As it is commanded and answered."""
    return "on" if on else "off"
