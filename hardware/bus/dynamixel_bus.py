"""The bus through the vendor's SDK, on a serial device or a pseudo-terminal.

What the SDK leaves to its user is done here: one opening at the right rate and with exclusive
access, time-outs on a clock that cannot be set, a port that stays usable after an exception, every
error bit, bounded repetition.
"""

import errno
import os
import select
import termios
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Final

import serial
from dynamixel_sdk import (
    COMM_RX_CORRUPT,
    COMM_RX_TIMEOUT,
    COMM_SUCCESS,
    PacketHandler,
    PortHandler,
)

from hardware.bus.bus import StatusReply
from hardware.bus.packets import error_names
from hardware.exceptions import (
    BusLost,
    CorruptPackets,
    HardwareError,
    PortUnavailable,
    ServoMissing,
)
from hardware.tolerances import ATTEMPTS, REPLY_TIMEOUT_S, SERIAL_POLL_S, WRITE_TIMEOUT_S

BAUD_RATE: Final = 1_000_000
PROTOCOL: Final = 1.0
# A servo that could not read our packet, or not what was in it: worth sending again.
GARBLED: Final = frozenset({"checksum", "instruction"})


class DynamixelBus:
    """A `hardware.bus.bus.ServoBus` on a device path.

    Raises:
        PortUnavailable: the device cannot be opened.
    """

    def __init__(self, device: str, baud_rate: int = BAUD_RATE) -> None:
        self._port = _Port(device)
        self._port.baudrate = baud_rate
        self._packets = PacketHandler(PROTOCOL)
        self._retries: Counter[int] = Counter()
        self.reopen()

    @property
    def device(self) -> str:
        """The serial device."""
        return str(self._port.port_name)

    @property
    def retries(self) -> Mapping[int, int]:
        """Packets that had to be repeated so far, by servo id."""
        return self._retries

    def read(self, servo_id: int, address: int, size: int) -> StatusReply:
        """`size` bytes of its control table from `address` on."""

        def attempt() -> tuple[int, int, bytes]:
            data, result, error = self._packets.readTxRx(self._port, servo_id, address, size)
            if result == COMM_SUCCESS and len(data) != size:
                result = COMM_RX_CORRUPT
            return result, error, bytes(data)

        return self._repeat(servo_id, attempt)

    def write(self, servo_id: int, address: int, data: bytes) -> StatusReply:
        """Write bytes from `address` on."""

        def attempt() -> tuple[int, int, bytes]:
            result, error = self._packets.writeTxRx(
                self._port, servo_id, address, len(data), list(data)
            )
            return result, error, b""

        return self._repeat(servo_id, attempt)

    def sync_write(self, address: int, rows: Mapping[int, bytes]) -> None:
        """Write to many servos in one packet that none of them answers."""
        (size,) = {len(data) for data in rows.values()}
        parameters = [byte for servo_id, data in rows.items() for byte in (servo_id, *data)]
        with self._using():
            result = self._packets.syncWriteTxOnly(
                self._port, address, size, parameters, len(parameters)
            )
        if result != COMM_SUCCESS:
            raise BusLost(f"{self.device}: {self._packets.getTxRxResult(result)}")

    def reopen(self) -> None:
        """Open the device again after it was lost."""
        self.close()
        try:
            opened = self._port.openPort()
        except (serial.SerialException, OSError, termios.error) as error:
            raise PortUnavailable(f"cannot open {self.device}: {_reason(error)}") from error
        if not opened:
            raise PortUnavailable(f"{self.device}: the SDK knows no rate of {self._port.baudrate}")

    def close(self) -> None:
        """Give the device back."""
        if self._port.ser is not None:
            self._port.closePort()

    def _repeat(self, servo_id: int, attempt: Callable[[], tuple[int, int, bytes]]) -> StatusReply:
        outcome: HardwareError = ServoMissing(servo_id, "")
        for _ in range(ATTEMPTS):
            with self._using():
                result, error, data = attempt()
            errors = error_names(error)
            if result == COMM_SUCCESS and not GARBLED & set(errors):
                return StatusReply(data, errors)
            self._retries[servo_id] += 1
            if result == COMM_RX_TIMEOUT:
                outcome = ServoMissing(servo_id, "does not answer")
            elif result in (COMM_SUCCESS, COMM_RX_CORRUPT):
                detail = "cannot read our packets" if errors else "answers unreadably"
                outcome = CorruptPackets(servo_id, detail)
            else:
                outcome = BusLost(f"{self.device}: {self._packets.getTxRxResult(result)}")
        raise outcome

    @contextmanager
    def _using(self) -> Iterator[None]:
        try:
            yield
        except (serial.SerialException, OSError, termios.error) as error:
            raise BusLost(f"{self.device} is gone: {error}") from error
        finally:
            # The SDK leaves this set when an exception passes through it.
            self._port.is_using = False


def _reason(error: Exception) -> str:
    # pyserial keeps the number of what failed, or hides it behind a sentence of its own.
    cause = error.__context__ if isinstance(error.__context__, termios.error) else error
    number = cause.args[0] if cause.args and isinstance(cause.args[0], int) else 0
    if number == errno.EAGAIN:
        return "another program has it"
    return os.strerror(number) if number else str(error)


class _Port(PortHandler):  # type: ignore[misc]
    """The SDK's port, with its names: exclusive, waiting for bytes instead of spinning."""

    def setupPort(self, cflag_baud: int) -> bool:
        self.ser: Any = serial.Serial(
            self.port_name,
            self.baudrate,
            timeout=SERIAL_POLL_S,
            exclusive=True,
        )
        self.is_open = True
        self._arrived: int | None = None
        self.tx_time_per_byte = 10 * 1000 / self.baudrate
        return True

    def readPort(self, length: int) -> bytes:
        if self.getTimeSinceStart() <= self.packet_timeout:
            return bytes(self.ser.read(length))
        # This process may have stood still: what has come by now is an answer in time. No more is
        # waited for, as the SDK looks at the time only when it is short of bytes, which a line that
        # babbles never is.
        if self._arrived is None:
            self._arrived = self.ser.in_waiting
        found = bytes(self.ser.read(min(length, self._arrived)))
        self._arrived -= len(found)
        return found

    def writePort(self, packet: list[int]) -> int:
        # pyserial looks at its clock even when all is written, and calls a port lost over which
        # this process stood still.
        rest = memoryview(bytes(packet))
        while rest:
            _, writable, _ = select.select([], [self.ser], [], WRITE_TIMEOUT_S)
            if not writable:
                raise serial.SerialTimeoutException(f"it takes no bytes for {WRITE_TIMEOUT_S:g} s")
            rest = rest[os.write(self.ser.fileno(), rest) :]
        return len(packet)

    def getCurrentTime(self) -> float:
        return time.monotonic() * 1000

    def setPacketTimeout(self, packet_length: int) -> None:
        self._arrived = None
        self.setPacketTimeoutMillis(self.tx_time_per_byte * packet_length + REPLY_TIMEOUT_S * 1000)
