from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hardware.arm.servo_arm import HeldPosture
from hardware.end_effector.end_effectors import OFF, GuardedEndEffector, NoEndEffector
from hardware.exceptions import EndEffectorFailed
from hardware.worker.safe_state import SafeState, make_safe, stop_report
from tests.hardware.end_effector.test_end_effectors import changes
from tests.hardware.parts import Bench, goals_sent, make_bench


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


class Switch(NoEndEffector):
    """An end-effector that notes what it is told, and fails as it is asked to."""

    def __init__(self, *broken: str) -> None:
        self.broken = broken
        self.told: list[str] = []

    def switch(self, *, on: bool) -> None:
        self._do("on" if on else "off")

    def recover(self) -> None:
        self._do("recover")

    def _do(self, what: str) -> None:
        self.told.append(what)
        if what in self.broken:
            raise EndEffectorFailed(f"it does not {what}")


@pytest.mark.parametrize(
    ("broken", "told", "trouble"),
    [
        ((), ["off"], ()),
        (("off",), ["off", "recover"], ("it does not off", "another guard switched it off")),
        (("off", "recover"), ["off", "recover"], ("it does not off", "it does not recover")),
    ],
)
def test_the_arm_is_held_whatever_the_end_effector_does(
    bench: Bench, broken: tuple[str, ...], told: list[str], trouble: tuple[str, ...]
) -> None:
    end_effector = Switch(*broken)
    bench.bus.sent.clear()
    safe = make_safe(bench.arm, end_effector)
    assert end_effector.told == told
    assert safe.trouble == trouble
    assert safe.held is not None
    assert safe.held.still
    assert len(goals_sent(bench.bus.sent)) == 1
    report = stop_report("s1", safe, bench.arm.torque)
    assert report.request_id == "s1"
    assert (report.stopped, report.verified) == (True, not trouble)
    assert report.detail == ("; ".join(trouble) or "the arm holds where it stands")


def test_all_that_went_wrong_is_told_in_the_order_in_which_it_did(bench: Bench) -> None:
    bench.bus.gone = True
    safe = make_safe(bench.arm, Switch("off"))
    assert safe.held is None
    assert safe.trouble == (
        "it does not off",
        "another guard switched it off",
        "the arm could not be told to hold: in-process is gone",
    )
    report = stop_report("s1", safe, "unknown")
    assert report.detail == "; ".join(safe.trouble)
    assert (report.stopped, report.verified) == (False, False)
    assert (report.joints, report.joints_read_at) == (None, None)


def test_doubts_of_the_hold_are_trouble(bench: Bench) -> None:
    bench.fault("missing 41")
    safe = make_safe(bench.arm, NoEndEffector())
    assert safe.trouble == ("these servos cannot be read: 41",)
    report = stop_report("s1", safe, bench.arm.torque)
    assert (report.stopped, report.verified, report.joints) == (False, False, None)
    bench.fault("heal")
    bench.servo(41).table["torque_limit"] = 0
    report = stop_report("s1", make_safe(bench.arm, NoEndEffector()), bench.arm.torque)
    assert (report.stopped, report.verified) == (True, False)
    assert report.detail == "these servos have no torque and are not held: 41"


@pytest.mark.parametrize(
    ("torque", "said"),
    [
        ("on", "the arm holds where it stands"),
        ("off", "torque is off: nothing was held, and nothing moves"),
        ("unknown", "it is not known where torque is on; nothing moves"),
    ],
)
def test_without_trouble_a_report_says_what_torque_means(
    bench: Bench, torque: str, said: str
) -> None:
    held = HeldPosture(True, np.arange(6.0), "")
    report = stop_report("s1", SafeState(held, ()), torque)
    assert report.detail == said
    assert (report.stopped, report.verified) == (True, True)
    assert report.joints == (0.0, 1.0, 2.0, 3.0, 4.0, 5.0)
    assert report.joints_read_at is not None
    assert report.joints_read_at.endswith("Z")
    moving = SafeState(replace(held, still=False), ("the arm still moves",))
    report = stop_report("s1", moving, torque)
    assert (report.stopped, report.verified) == (False, False)
    assert report.detail == "the arm still moves"
    assert report.joints is not None
