from pathlib import Path

import pytest

from hardware.end_effector.end_effectors import OFF, GuardedEndEffector, NoEndEffector
from hardware.exceptions import EndEffectorFailed
from hardware.worker.safe_state import make_safe, stop_report
from tests.hardware.end_effector.test_end_effectors import changes
from tests.hardware.parts import Bench, make_bench


@pytest.fixture
def bench() -> Bench:
    it = make_bench()
    it.arm.check()
    it.arm.enable_torque()
    return it


@pytest.mark.parametrize("slip", ["slip 31 200", "slip 32 40", "slip 22 900"])
def test_a_pair_that_disagrees_is_held_without_driving_it_and_not_verified(
    bench: Bench, slip: str
) -> None:
    stood = {servo.servo_id: servo.position for servo in bench.bus.simulated.servos}
    bench.fault(slip)
    for _ in range(3):
        safe = make_safe(bench.arm, NoEndEffector())
        bench.time.sleep(5)
        report = stop_report("s1", safe, bench.arm.torque)
        assert not report.verified
        assert "two servos" in report.detail
    slipped = int(slip.split()[1])
    for servo in bench.bus.simulated.servos:
        # A real one whose sensor is wrong stands still at a goal that its sensor says; the
        # simulated one turns by its true position.
        if servo.servo_id != slipped:
            assert abs(servo.position - stood[servo.servo_id]) <= 3


def test_a_position_that_no_servo_can_have_is_no_reading(bench: Bench) -> None:
    real = bench.bus.read

    def forged(servo_id: int, address: int, size: int) -> object:
        reply = real(servo_id, address, size)
        if servo_id != 51 or address != 24:
            return reply
        return type(reply)(reply.data[:12] + b"\xff\xff" + reply.data[14:], reply.errors)

    bench.bus.read = forged  # type: ignore[method-assign, assignment]
    safe = make_safe(bench.arm, NoEndEffector())
    assert safe.held is not None
    assert safe.held.joints is None
    assert "51" in stop_report("s1", safe, bench.arm.torque).detail


def test_a_guard_that_died_is_replaced_by_one_that_switches_off(
    bench: Bench, tmp_path: Path
) -> None:
    record = tmp_path / "record.txt"
    laser = GuardedEndEffector("simulated", record)
    laser.switch(on=True)
    laser._guard.kill()
    laser._guard.wait()
    safe = make_safe(bench.arm, laser)
    assert laser.state == OFF
    assert changes(record)[-1] == (OFF, "start")
    assert not stop_report("s1", safe, bench.arm.torque).verified
    laser.close()


def test_the_last_thing_a_worker_leaves_is_off(tmp_path: Path) -> None:
    record = tmp_path / "record.txt"
    laser = GuardedEndEffector("simulated", record)
    laser.switch(on=True)
    laser._guard.kill()
    laser._guard.wait()
    laser.close()
    assert laser.state == OFF
    assert changes(record)[-1] == (OFF, "end")


def test_a_record_that_is_a_folder_is_named(tmp_path: Path) -> None:
    with pytest.raises(EndEffectorFailed, match="directory"):
        GuardedEndEffector("simulated", tmp_path)


def test_without_a_bus_nothing_is_claimed(bench: Bench) -> None:
    bench.bus.gone = True
    report = stop_report("s1", make_safe(bench.arm, NoEndEffector()), bench.arm.torque)
    assert not report.stopped
    assert not report.verified
    assert report.joints is None
    assert bench.arm.torque == "unknown"


def test_torque_is_unknown_until_every_servo_was_read() -> None:
    assert make_bench().arm.torque == "unknown"
