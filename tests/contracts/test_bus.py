"""What every bus keeps: the simulated one always, and a real port when PRUNUS_PORT names it.

Nothing here moves a servo: the only register that is written is the LED's.
"""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from hardware.bus.bus import ServoBus
from hardware.bus.dynamixel_bus import DynamixelBus
from hardware.exceptions import PortUnavailable, ServoMissing
from hardware.servos.instances import load_instance
from hardware.servos.joints import ArmMap, load_arm
from tests.conftest import SERVO_PORT

REPOSITORY = Path(__file__).parents[2]
ABSENT_ID = 200


@contextmanager
def servo_bus(
    *arguments: str, stderr: int | None = None
) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """The program `prunus servo-bus`: its device, and the process, whose input takes faults."""
    command = [sys.executable, "-m", "app", "servo-bus", *arguments]
    with subprocess.Popen(
        command,
        cwd=REPOSITORY,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=stderr,
        text=True,
    ) as process:
        try:
            assert process.stdout is not None
            yield process.stdout.readline().strip(), process
        finally:
            process.terminate()


@pytest.fixture(scope="module", params=["simulated", "real"])
def device(request: pytest.FixtureRequest) -> Iterator[str]:
    if request.param == "simulated":
        with servo_bus() as (path, _):
            yield path
    elif SERVO_PORT:
        yield SERVO_PORT
    else:
        pytest.skip("PRUNUS_PORT names no real port")


@pytest.fixture
def bus(device: str) -> Iterator[ServoBus]:
    opened = DynamixelBus(device)
    yield opened
    opened.close()


@pytest.fixture(scope="module")
def arm() -> ArmMap:
    return load_arm(load_instance("tabletop").robot, "tabletop")


def test_every_servo_answers_with_its_model(bus: ServoBus, arm: ArmMap) -> None:
    for motor in arm.motors:
        reply = bus.read(motor.id, 0, 2)
        assert int.from_bytes(reply.data, "little") == motor.servo.model_number
        assert reply.errors == ()


def test_reads_have_the_size_asked_for(bus: ServoBus, arm: ArmMap) -> None:
    for motor in arm.motors:
        for address, size in ((0, 3), (36, 8), (24, 1), (0, 50)):
            assert len(bus.read(motor.id, address, size).data) == size


def test_positions_are_in_range_and_stand(bus: ServoBus, arm: ArmMap) -> None:
    for motor in arm.motors:
        reads = [int.from_bytes(bus.read(motor.id, 36, 2).data, "little") for _ in range(10)]
        assert min(reads) >= 0
        assert max(reads) <= motor.servo.highest_position
        assert max(reads) - min(reads) <= 3


def test_what_is_written_is_read_back(bus: ServoBus, arm: ArmMap) -> None:
    for motor in arm.motors:
        led = motor.servo.registers["led"]
        for value in (1, 0):
            assert bus.write(motor.id, led.address, led.encode(value)).errors == ()
            assert bus.read(motor.id, led.address, led.size).data == led.encode(value)


def test_one_packet_writes_to_all(bus: ServoBus, arm: ArmMap) -> None:
    led = arm.motors[0].servo.registers["led"]
    for value in (1, 0):
        bus.sync_write(led.address, {motor.id: led.encode(value) for motor in arm.motors})
        for motor in arm.motors:
            assert bus.read(motor.id, led.address, led.size).data == led.encode(value)


def test_a_refused_write_names_its_error_and_changes_nothing(bus: ServoBus, arm: ArmMap) -> None:
    motor = arm.motors[0]
    before = bus.read(motor.id, 0, 2).data
    assert "range" in bus.write(motor.id, 25, b"\x07").errors
    assert bus.read(motor.id, 0, 2).data == before
    assert bus.read(motor.id, 25, 1).data == b"\x00"


def test_a_missing_servo_is_named_after_bounded_tries(bus: ServoBus) -> None:
    before = bus.retries.get(ABSENT_ID, 0)
    with pytest.raises(ServoMissing) as caught:
        bus.read(ABSENT_ID, 36, 2)
    assert caught.value.servo_id == ABSENT_ID
    assert 1 <= bus.retries[ABSENT_ID] - before <= 5
    with pytest.raises(ServoMissing):
        bus.write(ABSENT_ID, 25, b"\x00")


def test_a_port_is_used_by_one_program(bus: ServoBus) -> None:
    with pytest.raises(PortUnavailable) as caught:
        DynamixelBus(bus.device)
    assert bus.device in caught.value.detail


def test_a_port_can_be_closed_and_opened_again(bus: ServoBus, arm: ArmMap) -> None:
    bus.close()
    bus.reopen()
    assert bus.read(arm.motors[0].id, 0, 2).errors == ()
