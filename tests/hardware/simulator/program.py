"""The program `prunus servo-bus` as a process, and the vendor's library on its device."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from dynamixel_sdk import COMM_SUCCESS, PacketHandler, PortHandler

REPOSITORY = Path(__file__).parents[3]
COMMAND = (sys.executable, "-m", "app", "servo-bus")
PATIENCE_S = 60
TRIES = 100

Process = subprocess.Popen[str]
Start = Callable[..., tuple[Process, str]]


class Port:
    """The vendor's library on a device. It gives up after 34 ms of wall-clock time: so retry."""

    def __init__(self, device: str) -> None:
        self.handler = PortHandler(device)
        self.packets = PacketHandler(1.0)
        assert self.handler.openPort()
        assert self.handler.setBaudRate(1_000_000)

    def read(self, servo_id: int, address: int, size: int) -> bytes:
        for _ in range(TRIES):
            data, result, error = self.packets.readTxRx(self.handler, servo_id, address, size)
            if result == COMM_SUCCESS:
                assert error == 0
                return bytes(data)
        raise AssertionError(f"servo {servo_id} does not answer")

    def ping(self, servo_id: int) -> int:
        for _ in range(TRIES):
            model, result, error = self.packets.ping(self.handler, servo_id)
            if result == COMM_SUCCESS:
                assert error == 0
                return int(model)
        raise AssertionError(f"servo {servo_id} does not answer")

    def close(self) -> None:
        self.handler.closePort()


def finish(process: Process, text: str | None = None) -> tuple[str, str]:
    """The rest of both streams, after the process has ended with 0."""
    out, err = process.communicate(text, timeout=PATIENCE_S)
    assert process.returncode == 0, err
    assert "Traceback" not in err
    return out, err
