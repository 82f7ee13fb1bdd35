"""Offsets measured read by read, and the file that a calibration leaves, without a real bus."""

import tomllib
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from hardware.arm import calibrating
from hardware.arm.calibrating import calibrate_arm, calibration_file, measure_offsets
from hardware.bus.bus import StatusReply
from hardware.exceptions import (
    HardwareError,
    OutsideLimits,
    PairDisagreement,
    ServoAlarm,
    ServoMissing,
    WrongSetting,
)
from hardware.options import BadOption
from hardware.servos.joints import ArmMap, calibrated, load_arm
from solver import Robot
from tests.hardware.parts import Bench, InProcessBus, make_bench, told

IDS = (11, 21, 22, 31, 32, 41, 51, 61)
HOME_DEG = "0,90,-90.3,0,90.3,0"
RX_COUNT_DEG = 300 / 1023


@pytest.fixture
def bench() -> Bench:
    return make_bench(noise_ticks=0)


def stands_at(bench: Bench) -> list[float]:
    return list(bench.true_joints())


# --- Measuring ------------------------------------------------------------------------------------
def test_models_are_checked_first_and_then_all_is_read_five_times(bench: Bench) -> None:
    measure_offsets(bench.arm.chain, stands_at(bench))
    models = [(servo_id, 0) for servo_id in IDS]
    reads = [(servo_id, 24) for servo_id in IDS] * 5
    assert [(sent.servo_id, sent.address) for sent in told(bench.bus.sent)] == models + reads


@pytest.mark.parametrize("servo_id", IDS)
def test_a_servo_of_another_model_is_not_measured(bench: Bench, servo_id: int) -> None:
    bench.servo(servo_id).table["model_number"] = 12
    with pytest.raises(WrongSetting, match=f"servo {servo_id}.*is model 12"):
        measure_offsets(bench.arm.chain, stands_at(bench))


@pytest.mark.parametrize(
    ("fault", "error"), [("missing 61", ServoMissing), ("voltage 22", ServoAlarm)]
)
def test_a_servo_in_trouble_is_not_measured(
    bench: Bench, fault: str, error: type[HardwareError]
) -> None:
    bench.fault(fault)
    with pytest.raises(error):
        measure_offsets(bench.arm.chain, stands_at(bench))


def at_read(bench: Bench, of: int, wanted: int, fault: str) -> None:
    """A fault from one of the reads of a servo's health on, counted from 1."""
    real, reads = bench.bus.read, 0

    def read(servo_id: int, address: int, size: int) -> StatusReply:
        nonlocal reads
        reads += (servo_id, address) == (of, 24)
        if reads == wanted:
            bench.fault(fault)
        return real(servo_id, address, size)

    bench.bus.read = read  # type: ignore[method-assign]


@pytest.mark.parametrize("wanted", [1, 5])
def test_a_pair_has_to_agree_at_every_read(bench: Bench, wanted: int) -> None:
    at_read(bench, 32, wanted, "slip 32 10")
    with pytest.raises(PairDisagreement, match="joint_3"):
        measure_offsets(bench.arm.chain, stands_at(bench))


def test_an_offset_is_the_mean_of_its_reads(bench: Bench) -> None:
    at_read(bench, 41, 4, "slip 41 5")
    offsets = measure_offsets(bench.arm.chain, stands_at(bench))
    assert np.degrees(offsets) == pytest.approx([0, 0, 0, 2 * RX_COUNT_DEG, 0, 0], abs=1e-9)


@pytest.mark.parametrize("joint", range(6))
@pytest.mark.parametrize("side", [-1, 1])
def test_offsets_are_signed_along_the_servo_and_at_most_ten_degrees(
    bench: Bench, joint: int, side: int
) -> None:
    """Joint 3 turns against its servo: 0.169 rad are a calibration, 0.171 are none."""
    true = stands_at(bench)
    sign = -1 if joint == 2 else 1
    true[joint] -= side * 0.169
    expected = np.zeros(6)
    expected[joint] = sign * side * 0.169
    offsets = measure_offsets(bench.arm.chain, true)
    assert offsets == pytest.approx(expected, abs=1e-9)
    true[joint] -= side * 0.002
    said = f"joint_{joint + 1}: reads {sign * side * 0.171:.3f} rad off"
    with pytest.raises(OutsideLimits, match=said):
        measure_offsets(bench.arm.chain, true)


def test_the_largest_offset_itself_is_one(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    true = stands_at(bench)
    true[3] += 0.1
    largest = float(np.abs(measure_offsets(bench.arm.chain, true)).max())
    monkeypatch.setattr(calibrating, "LARGEST_CALIBRATION_RAD", largest)
    assert np.abs(measure_offsets(bench.arm.chain, true)).max() == largest


# --- The file -------------------------------------------------------------------------------------
def test_the_file_has_degrees_by_joint_for_this_robot(bench: Bench) -> None:
    offsets = np.radians([1.0, -2.5, 0.0, 0.1234, -0.0004, 9.0])
    document = calibration_file(bench.map, offsets, "by hand")
    assert document.endswith(b"\n")
    assert tomllib.loads(document.decode()) == {
        "robot": "tabletop",
        "note": "by hand",
        "offset_deg": {
            "joint_1": 1.0,
            "joint_2": -2.5,
            "joint_3": 0.0,
            "joint_4": 0.123,
            "joint_5": 0.0,
            "joint_6": 9.0,
        },
    }
    assert calibrated(bench.map, document).calibration_rad == pytest.approx(offsets, abs=1e-5)


class Opened(InProcessBus):
    """A bus that tells whether it was closed, and what it was opened with."""

    arguments: tuple[str, int] = ("", 0)
    closed: int = 0

    def close(self) -> None:
        self.closed += 1


@pytest.fixture
def bus(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> Opened:
    """What `calibrate_arm` opens: servos that stand at home, joint 4 two degrees off."""
    opened = Opened(bench.bus.simulated)
    bench.fault("slip 41 7")

    def open_bus(port: str, baud_rate: int) -> Opened:
        opened.arguments = (port, baud_rate)
        return opened

    monkeypatch.setattr(calibrating, "DynamixelBus", open_bus)
    return opened


def test_a_calibration_is_written_whole_and_told(bus: Opened, tmp_path: Path) -> None:
    output = tmp_path / "calibration.toml"
    output.write_text("an earlier one")
    days = [datetime.now(UTC).date().isoformat()]
    told_offsets = calibrate_arm("tabletop", "/dev/servos", 57600, HOME_DEG, output)
    days.append(datetime.now(UTC).date().isoformat())
    assert bus.arguments == ("/dev/servos", 57600)
    assert bus.closed == 1
    assert list(told_offsets) == [f"joint_{k}" for k in range(1, 7)]
    assert told_offsets["joint_4"] == pytest.approx(np.radians(7.5 * RX_COUNT_DEG), abs=1e-6)
    written = tomllib.loads(output.read_text())
    assert written["note"] in {f"measured {day}" for day in days}
    assert written["offset_deg"]["joint_4"] == pytest.approx(7.5 * RX_COUNT_DEG, abs=0.001)
    assert list(tmp_path.iterdir()) == [output]


def test_what_was_calibrated_before_does_not_count(
    bus: Opened, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The offsets are from the servos' zeros, not from an earlier calibration."""
    plain = calibrate_arm("tabletop", "", 1, HOME_DEG, tmp_path / "first.toml")

    def load_calibrated(robot: Robot, model: str) -> ArmMap:
        arm = load_arm(robot, model)
        drives = tuple(replace(drive, calibration_rad=0.1) for drive in arm.drives)
        return replace(arm, drives=drives)

    monkeypatch.setattr(calibrating, "load_arm", load_calibrated)
    again = calibrate_arm("tabletop", "", 1, HOME_DEG, tmp_path / "second.toml")
    assert again == pytest.approx(plain, abs=1e-9)


def test_a_calibration_that_fails_closes_the_bus_and_keeps_the_file(
    bench: Bench, bus: Opened, tmp_path: Path
) -> None:
    output = tmp_path / "calibration.toml"
    output.write_text("an earlier one")
    bench.fault("missing 61")
    with pytest.raises(ServoMissing):
        calibrate_arm("tabletop", "", 1, HOME_DEG, output)
    assert bus.closed == 1
    assert output.read_text() == "an earlier one"
    assert list(tmp_path.iterdir()) == [output]


def test_a_posture_that_is_none_is_refused_before_a_bus_is_opened(
    bus: Opened, tmp_path: Path
) -> None:
    with pytest.raises(BadOption):
        calibrate_arm("tabletop", "", 1, "1,2,3", tmp_path / "calibration.toml")
    assert (bus.arguments, bus.closed, bus.sent) == (("", 0), 0, [])
