"""Telemetry says what was read last and which state wins; nothing is read for it."""

import pytest

from hardware.end_effector.end_effectors import NoEndEffector
from hardware.link.messages import PAUSED, ExecutionAccount, Failure
from hardware.worker.telemetry import telemetry
from tests.hardware.parts import Bench, make_bench

ACCOUNT = ExecutionAccount("e1", PAUSED, ())
FAULTS = (Failure("bus_lost", "gone", "now"),)


@pytest.fixture
def bench() -> Bench:
    return make_bench(noise_ticks=0)


@pytest.mark.parametrize(
    ("faults", "account", "status"),
    [
        ((), None, "idle"),
        ((), ACCOUNT, "paused"),
        (FAULTS, None, "fault"),
        (FAULTS, ACCOUNT, "fault"),
    ],
)
def test_a_fault_goes_before_an_execution_and_that_before_idle(
    bench: Bench, faults: tuple[Failure, ...], account: ExecutionAccount | None, status: str
) -> None:
    said = telemetry(bench.arm, NoEndEffector(), faults, account, 7)
    assert said.status == status
    assert said.faults == faults
    assert said.execution_id == (None if account is None else "e1")
    assert said.overruns == 7
    assert said.end_effector_state == "none"


def test_joints_are_told_once_every_servo_was_read(bench: Bench) -> None:
    for _ in range(5):
        bench.arm.poll()
    said = telemetry(bench.arm, NoEndEffector(), (), None, 0)
    assert (said.joints, said.joints_read_at, said.torque) == (None, None, "unknown")
    assert len(said.servos) == 7
    bench.arm.poll()
    sent = len(bench.bus.sent)
    said = telemetry(bench.arm, NoEndEffector(), (), None, 0)
    assert said.joints == pytest.approx(bench.true_joints())
    assert said.joints_read_at is not None
    assert said.torque == "off"
    assert [servo.id for servo in said.servos] == [11, 21, 22, 31, 32, 41, 51, 61]
    assert len(bench.bus.sent) == sent
