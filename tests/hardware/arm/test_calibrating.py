import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hardware.arm.calibrating import calibration_file, measure_offsets
from hardware.exceptions import OutsideLimits, PairDisagreement
from hardware.servos.joints import ArmMap, calibrated
from hardware.servos.units import ticks_per_radian
from tests.contracts.test_bus import REPOSITORY, servo_bus
from tests.hardware.parts import Bench, make_bench

TRUE_DEG = "10,60,-40,20,30,-50"
THESIS = REPOSITORY / "hardware" / "servos" / "calibrations" / "tabletop_thesis.toml"


@pytest.fixture
def bench() -> Bench:
    return make_bench()


def resolution(arm: ArmMap) -> np.ndarray:
    """Half a count of rounding and a count of read noise of each joint's servo [rad]."""
    return np.array([1.5 / ticks_per_radian(drive.servo) for drive in arm.drives])


def test_offsets_are_what_the_servos_read_too_much(bench: Bench) -> None:
    signs = np.array([drive.sign for drive in bench.map.drives])
    wrong = np.array([0.02, -0.03, 0.05, 0.0, 0.1, -0.1])
    true = np.array(bench.robot.home_joints) - signs * wrong
    offsets = measure_offsets(bench.arm.chain, true.tolist())
    assert (np.abs(offsets - wrong) < resolution(bench.map)).all()
    assert {packet[4] for packet in bench.bus.sent} == {2}


def test_a_calibrated_arm_reads_the_posture_that_was_given(bench: Bench) -> None:
    true = np.array(bench.robot.home_joints) + 0.07
    offsets = measure_offsets(bench.arm.chain, true.tolist())
    arm = calibrated(bench.map, calibration_file(bench.map, offsets, "test"))
    # Noise of the measurement and noise of this one read.
    assert (np.abs(arm.joints(bench.arm.chain.sweep()) - true) < 2 * resolution(arm)).all()


def test_a_posture_far_from_what_is_read_is_refused(bench: Bench) -> None:
    true = np.array(bench.robot.home_joints)
    true[3] += 0.2
    with pytest.raises(OutsideLimits, match="joint_4"):
        measure_offsets(bench.arm.chain, true.tolist())


def test_a_pair_that_disagrees_is_refused(bench: Bench) -> None:
    bench.fault("slip 32 30")
    with pytest.raises(PairDisagreement):
        measure_offsets(bench.arm.chain, bench.robot.home_joints)


def calibrate(device: str, output: Path, joints_deg: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-m", "app", "calibrate", "--robot", "tabletop"]
    command += ["--port", device, f"--joints-deg={joints_deg}", "-o", str(output)]
    return subprocess.run(
        command, cwd=REPOSITORY, capture_output=True, text=True, timeout=60, check=False
    )


def test_the_command_finds_the_thesiss_degree(tmp_path: Path) -> None:
    output = tmp_path / "calibration.toml"
    with servo_bus("--calibration", str(THESIS), f"--joints-deg={TRUE_DEG}") as (device, _):
        finished = calibrate(device, output, TRUE_DEG)
    assert finished.returncode == 0, finished.stderr
    arm = calibrated(make_bench().map, output.read_bytes())
    wanted = np.radians([1.0, 0, 0, 0, 0, 0])
    assert (np.abs(np.array(arm.calibration_rad) - wanted) < resolution(arm)).all()
    assert len(finished.stdout.splitlines()) == 6


@pytest.mark.parametrize(
    ("joints_deg", "said"), [("1,2", "--joints-deg"), ("80,60,-40,20,30,-50", "joint_1")]
)
def test_the_command_says_in_one_line_why_not(tmp_path: Path, joints_deg: str, said: str) -> None:
    output = tmp_path / "calibration.toml"
    with servo_bus(f"--joints-deg={TRUE_DEG}") as (device, _):
        finished = calibrate(device, output, joints_deg)
    assert finished.returncode == 1
    assert said in finished.stderr
    assert len(finished.stderr.splitlines()) == 1
    assert not output.exists()
