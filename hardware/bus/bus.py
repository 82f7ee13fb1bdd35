"""A bus of servos, as the arm sees it. Simulated and real ones are held to the same tests."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True)
class StatusReply:
    """A servo's answer: the bytes asked for, and the names of all error bits that are set."""

    data: bytes
    errors: tuple[str, ...]


class ServoBus(Protocol):
    """Reads and writes of control tables over Protocol 1.0.

    Every call but `sync_write` is answered by the servo, is repeated a bounded number of times, and
    raises ServoMissing, CorruptPackets or BusLost when that did not help. A repeated write is the
    same write.
    """

    @property
    def device(self) -> str:
        """The serial device."""

    @property
    def retries(self) -> Mapping[int, int]:
        """Packets that had to be repeated so far, by servo id."""

    def read(self, servo_id: int, address: int, size: int) -> StatusReply:
        """`size` bytes of its control table from `address` on."""

    def write(self, servo_id: int, address: int, data: bytes) -> StatusReply:
        """Write bytes from `address` on; the answer carries no data."""

    def sync_write(self, address: int, rows: Mapping[int, bytes]) -> None:
        """Write to many servos in one packet that none of them answers."""

    def reopen(self) -> None:
        """Open the device again after it was lost; PortUnavailable if that fails."""

    def close(self) -> None:
        """Give the device back; the servos go on holding their goals."""
