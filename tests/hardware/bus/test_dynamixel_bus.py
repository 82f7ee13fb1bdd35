"""Troubles on the line, through the SDK; what goes well is in tests/contracts/test_bus.py."""

import contextlib
import os
import subprocess
import threading
import time
import tty
from collections.abc import Iterator

import pytest

from hardware.bus.dynamixel_bus import DynamixelBus
from hardware.exceptions import BusLost, CorruptPackets, PortUnavailable, ServoMissing
from hardware.tolerances import REPLY_TIMEOUT_S, WRITE_TIMEOUT_S
from tests.contracts.test_bus import servo_bus


class Line:
    """A bus on the simulated bus's program, and that program's standard input."""

    def __init__(self, device: str, process: "subprocess.Popen[str]") -> None:
        self.bus = DynamixelBus(device)
        self.process = process

    def fault(self, *commands: str) -> None:
        """Have faults, and wait until the program has read them, or has ended with the last."""
        assert self.process.stdin is not None
        assert self.process.stderr is not None
        # A line that is no fault is complained of, after all before it.
        lines = (*commands, "understood")
        self.process.stdin.write("".join(f"{line}\n" for line in lines))
        self.process.stdin.flush()
        while told := self.process.stderr.readline():
            if "understood" in told:
                return


@pytest.fixture
def line() -> Iterator[Line]:
    with servo_bus(stderr=subprocess.PIPE) as (device, process):
        it = Line(device, process)
        yield it
        it.bus.close()


def test_single_corrupt_packets_are_repeated_and_counted(line: Line) -> None:
    line.fault("corrupt-next 2")
    assert line.bus.read(41, 0, 2).data == bytes((64, 0))
    assert line.bus.retries == {41: 2}


def test_an_answer_that_came_while_the_program_stood_still_is_read(
    line: Line, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A busy machine may not run it for longer than an answer is waited for, after any packet."""
    port = line.bus._port
    begin = port.setPacketTimeout

    def begin_to_wait_and_stand_still(length: int) -> None:
        begin(length)
        time.sleep(2 * REPLY_TIMEOUT_S)

    monkeypatch.setattr(port, "setPacketTimeout", begin_to_wait_and_stand_still)
    assert line.bus.read(41, 0, 2).data == bytes((64, 0))
    assert not line.bus.retries


def test_a_program_that_stands_still_while_it_writes_has_not_lost_the_bus(
    line: Line, monkeypatch: pytest.MonkeyPatch
) -> None:
    write = os.write

    def write_and_stand_still(descriptor: int, data: bytes) -> int:
        monkeypatch.setattr(os, "write", write)
        written = write(descriptor, data)
        time.sleep(1.2 * WRITE_TIMEOUT_S)
        return written

    monkeypatch.setattr(os, "write", write_and_stand_still)
    line.bus.sync_write(30, {41: bytes((0, 2))})
    monkeypatch.setattr(os, "write", write_and_stand_still)
    assert line.bus.read(41, 30, 2).data == bytes((0, 2))


def test_a_port_that_takes_no_bytes_is_a_lost_bus() -> None:
    port, client = os.openpty()
    bus = DynamixelBus(os.ttyname(client))

    def write_on() -> None:
        # Nobody reads at the other end, where a pseudo-terminal keeps some kilobytes.
        for _ in range(10_000):
            bus.sync_write(30, {41: bytes((0, 2))})

    try:
        with pytest.raises(BusLost, match="takes no bytes"):
            write_on()
    finally:
        bus.close()
        os.close(port)
        os.close(client)


def test_a_tenth_of_corrupt_packets_is_survived(line: Line) -> None:
    line.fault("corrupt 0.1")
    answers = [line.bus.read(41, 0, 2).data for _ in range(60)]
    assert set(answers) == {bytes((64, 0))}
    assert line.bus.retries[41] > 0


def test_corrupt_packets_without_end_are_named(line: Line) -> None:
    line.fault("corrupt 1")
    with pytest.raises(CorruptPackets) as caught:
        line.bus.read(31, 36, 2)
    assert caught.value.servo_id == 31
    line.fault("heal")
    assert line.bus.read(31, 0, 2).errors == ()


def test_a_missing_servo_does_not_disturb_the_others(line: Line) -> None:
    line.fault("missing 41")
    with pytest.raises(ServoMissing):
        line.bus.read(41, 36, 2)
    assert line.bus.read(51, 0, 2).errors == ()


def test_all_error_bits_of_an_answer_are_named(line: Line) -> None:
    line.fault("overload 31", "overheat 31")
    assert set(line.bus.read(31, 36, 2).errors) == {"overload", "overheating"}


def test_an_unplugged_device_is_a_lost_bus_and_not_a_busy_port(line: Line) -> None:
    line.fault("unplug")
    for _ in range(2):
        with pytest.raises(BusLost):
            line.bus.read(31, 36, 2)
    with pytest.raises(BusLost):
        line.bus.sync_write(25, {31: b"\x00"})
    with pytest.raises(PortUnavailable):
        line.bus.reopen()


def test_a_device_that_is_not_there_is_named() -> None:
    with pytest.raises(PortUnavailable) as caught:
        DynamixelBus("/dev/no-such-device")
    assert "/dev/no-such-device" in caught.value.detail
    assert "No such file" in caught.value.detail


def test_something_else_than_a_serial_device_is_named() -> None:
    with pytest.raises(PortUnavailable) as caught:
        DynamixelBus("/dev/null")
    assert "Inappropriate ioctl" in caught.value.detail


@pytest.mark.parametrize("babble", [b"\xff", b"\xff\xff\x0b\xff", b"\x00\xff\xff\xfe"])
def test_a_babbling_line_is_corrupt_and_does_not_hold_anybody_up(babble: bytes) -> None:
    port, client = os.openpty()
    tty.setraw(client)
    os.set_blocking(port, False)
    over = threading.Event()

    def talk() -> None:
        while not over.is_set():
            with contextlib.suppress(BlockingIOError):
                os.write(port, babble * 64)
            with contextlib.suppress(BlockingIOError):
                os.read(port, 4096)

    talking = threading.Thread(target=talk)
    bus = DynamixelBus(os.ttyname(client))
    talking.start()
    try:
        with pytest.raises((CorruptPackets, ServoMissing)):
            bus.read(11, 36, 2)
    finally:
        over.set()
        talking.join()
        bus.close()
        os.close(port)
        os.close(client)


def test_a_rate_that_the_sdk_does_not_know_is_named(line: Line) -> None:
    with pytest.raises(PortUnavailable, match="57142"):
        DynamixelBus(line.bus.device, baud_rate=57142)
