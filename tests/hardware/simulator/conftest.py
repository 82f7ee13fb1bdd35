"""A clock to be moved by hand, and small buses."""

from collections.abc import Callable
from dataclasses import dataclass

import pytest

from hardware.bus.packets import (
    HEADER,
    READ,
    WRITE,
    checksum,
    instruction_packet,
)
from hardware.servos.control_tables import servo_model
from hardware.servos.joints import ArmMap, load_arm
from hardware.simulator import SimulatedBus, SimulatedServo, simulated_arm
from solver import Robot


class HandClock:
    """Time that passes only when a test says so."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        return self.now_s

    def pass_s(self, seconds: float) -> None:
        self.now_s += seconds


@dataclass(frozen=True)
class Answer:
    servo_id: int
    error: int
    parameters: bytes
    checksum_valid: bool = True


def answers(data: bytes) -> list[Answer]:
    """The status packets in these bytes, which are nothing else."""
    found = []
    while data:
        assert data[:2] == HEADER
        packet, data = data[: 4 + data[3]], data[4 + data[3] :]
        valid = packet[-1] == checksum(packet[2:-1])
        found.append(Answer(packet[2], packet[4], packet[5:-1], valid))
    return found


class Client:
    """Speaks to a simulated bus in registers' names."""

    def __init__(self, bus: SimulatedBus) -> None:
        self.bus = bus

    def ask(self, servo_id: int, instruction: int, parameters: bytes = b"") -> list[Answer]:
        return answers(self.bus.respond(instruction_packet(servo_id, instruction, parameters)))

    def write(self, servo_id: int, name: str, value: int) -> int:
        """The error bits of the answer."""
        register = self._simulated(servo_id).model.registers[name]
        data = bytes((register.address,)) + value.to_bytes(register.size, "little")
        (answer,) = self.ask(servo_id, WRITE, data)
        return answer.error

    def read(self, servo_id: int, name: str) -> int:
        register = self._simulated(servo_id).model.registers[name]
        (answer,) = self.ask(servo_id, READ, bytes((register.address, register.size)))
        assert len(answer.parameters) == register.size
        return int.from_bytes(answer.parameters, "little")

    def _simulated(self, servo_id: int) -> SimulatedServo:
        servo = self.bus.servo(servo_id)
        assert servo is not None
        return servo


MakeClient = Callable[..., Client]


@pytest.fixture
def clock() -> HandClock:
    return HandClock()


@pytest.fixture
def make_client(clock: HandClock) -> MakeClient:
    """Servos of one kind at some ids, all standing at one count."""

    def make(*ids: int, model: str = "RX-64", position: int = 512) -> Client:
        kind = servo_model(model)
        return Client(SimulatedBus([SimulatedServo(each, kind, position, clock) for each in ids]))

    return make


@pytest.fixture
def arm(tabletop: Robot) -> ArmMap:
    return load_arm(tabletop, "tabletop")


@pytest.fixture
def arm_client(arm: ArmMap, tabletop: Robot, clock: HandClock) -> Client:
    return Client(simulated_arm(arm, tabletop.home_joints, clock, noise_ticks=0))
