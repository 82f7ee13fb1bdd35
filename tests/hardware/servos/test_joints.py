import math
from dataclasses import replace
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hardware.exceptions import InvalidArm
from hardware.servos.joints import MIRRORED, SYNC_CABLE, ArmMap, JointDrive, calibrated, load_arm
from hardware.servos.units import motor_angle
from solver import Robot, load_robot

ROBOT = load_robot("tabletop")
ARM = load_arm(ROBOT, "tabletop")
THESIS = resources.files("hardware.servos.calibrations") / "tabletop_thesis.toml"
every_drive = pytest.mark.parametrize("drive", ARM.drives, ids=lambda each: each.joint)
inside_limits = st.tuples(*(st.floats(joint.lower, joint.upper) for joint in ROBOT.joints))


def calibration(**changed_deg: float) -> bytes:
    offsets = {drive.joint: 0.0 for drive in ARM.drives} | changed_deg
    rows = "\n".join(f"{name} = {value}" for name, value in offsets.items())
    return f'robot = "tabletop"\n[offset_deg]\n{rows}\n'.encode()


@every_drive
def test_every_count_and_back(drive: JointDrive) -> None:
    for ticks in range(drive.servo.highest_position + 1):
        assert drive.ticks(drive.angle(ticks)) == ticks


@every_drive
def test_where_a_joint_reaches(drive: JointDrive) -> None:
    for ticks in (0, drive.servo.highest_position):
        assert drive.reaches(drive.angle(ticks))
    for ticks in (-1, drive.servo.highest_position + 1):
        assert not drive.reaches(drive.angle(ticks))


@every_drive
def test_positive_motion_has_the_sign_of_the_arm_file(drive: JointDrive) -> None:
    assert math.copysign(1, drive.ticks(0.5) - drive.ticks(-0.5)) == drive.sign
    assert drive.sign == (-1 if drive.joint == "joint_3" else 1)


@given(inside_limits)
def test_joints_inverts_goals_within_half_a_tick(q: tuple[float, ...]) -> None:
    found = ARM.joints(ARM.goals(q))
    half_ticks = [motor_angle(drive.servo, 0.5) for drive in ARM.drives]
    assert np.all(np.abs(found - q) <= np.array(half_ticks) + 1e-12)


@given(inside_limits)
def test_goals_of_a_pair_are_mirrors_and_everybody_gets_one(q: tuple[float, ...]) -> None:
    goals = ARM.goals(q)
    assert list(goals) == [11, 21, 22, 31, 32, 41, 51, 61]
    assert goals[21] + goals[22] == 4095
    assert goals[31] + goals[32] == 1023


def test_pairs_are_averaged() -> None:
    positions: dict[int, float] = dict(ARM.goals([0.0] * 6))
    before = ARM.joints(positions)
    positions[22] += 2
    moved = ARM.joints(positions) - before
    drive = ARM.drives[1]
    assert moved[1] == pytest.approx(-motor_angle(drive.servo, 1))
    assert np.delete(moved, 1) == pytest.approx(np.zeros(5))


def test_the_partner_on_a_sync_cable_gets_no_goal_but_is_read() -> None:
    drive = replace(ARM.drives[1], coupling=SYNC_CABLE)
    assert drive.goals(2000) == {21: 2000}
    assert drive.first_motor_ticks({21: 2000, 22: 2095}) == (2000, 2000)
    assert ARM.drives[1].coupling == MIRRORED


def test_limits_of_the_model_are_inside_the_servos_range() -> None:
    for joint, drive in zip(ROBOT.joints, ARM.drives, strict=True):
        ends = sorted((drive.ticks(joint.lower), drive.ticks(joint.upper)))
        assert 0 <= ends[0] < ends[1] <= drive.servo.highest_position, joint.name
        if joint.name in ("joint_4", "joint_6"):
            assert ends[0] <= 2
            assert ends[1] >= 1021


@every_drive
def test_known_counts(drive: JointDrive) -> None:
    """F. Ouyang's thesis, appendix B: motor degrees at joint angle 0, times counts a degree."""
    degrees = {"joint_2": 125.46, "joint_3": 60.0}.get(drive.joint, 150.0)
    per_degree = 4095 / 250.92 if drive.joint == "joint_2" else 1023 / 300
    assert drive.ticks(0) == math.floor(degrees * per_degree + 0.5)


def test_calibration_goes_both_ways() -> None:
    arm = calibrated(ARM, calibration(joint_2=2.0, joint_3=-3.0))
    assert arm.calibration_rad == pytest.approx((0, math.radians(2), math.radians(-3), 0, 0, 0))
    q = np.array([0.1, 0.2, -0.3, 0.4, 0.5, 0.6])
    goals, plain = arm.goals(q), ARM.goals(q)
    assert goals[21] - plain[21] == pytest.approx(2 * 4095 / 250.92, abs=1)
    assert goals[22] - plain[22] == pytest.approx(-2 * 4095 / 250.92, abs=1)
    assert goals[31] - plain[31] == pytest.approx(-3 * 1023 / 300, abs=1)
    assert arm.joints(goals) == pytest.approx(q, abs=motor_angle(ARM.drives[0].servo, 0.5))


def test_the_thesis_example_shifts_joint_1_by_a_degree() -> None:
    arm = calibrated(ARM, THESIS.read_bytes())
    assert np.degrees(arm.calibration_rad) == pytest.approx([1, 0, 0, 0, 0, 0])
    goals, plain = arm.goals([0.0] * 6), ARM.goals([0.0] * 6)
    assert goals[11] - plain[11] == pytest.approx(1023 / 300, abs=1)
    assert {**goals, 11: plain[11]} == plain


def test_what_ships_is_not_calibrated() -> None:
    assert ARM.calibration_rad == (0.0,) * 6


@pytest.mark.parametrize(
    "document",
    [
        b"",
        b"not TOML",
        b"\xff\xfe",
        calibration().replace(b"tabletop", b"other"),
        calibration().replace(b"joint_6", b"joint_7"),
        calibration() + b"joint_7 = 0.0\n",
        calibration(joint_1=math.inf),
        calibration(joint_1=45.0),
        calibration(joint_1=1e300),
        b'robot = "tabletop"\noffset_deg = ' + b"[" * 5000 + b"\n",
        calibration(joint_1=math.nan),
        b'robot = "tabletop"\n[offset_deg]\njoint_1 = "one"\n',
        b'robot = "tabletop"\noffset_deg = 3\n',
        b'robot = "tabletop"\noffset_deg = [1, 2]\n',
        b'robot = "tabletop"\n[offset_deg]\njoint_1 = ' + b"9" * 400 + b"\n",
    ],
)
def test_calibrations_that_are_none(document: bytes) -> None:
    with pytest.raises(InvalidArm):
        calibrated(ARM, document)


def test_a_calibration_file(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_bytes(calibration(joint_5=1.5))
    arm = load_arm(ROBOT, "tabletop", file)
    assert arm.calibration_rad[4] == pytest.approx(math.radians(1.5))


def test_a_calibration_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InvalidArm, match=r"absent\.toml"):
        load_arm(ROBOT, "tabletop", tmp_path / "absent.toml")


def test_a_robot_without_an_arm_file() -> None:
    with pytest.raises(InvalidArm, match="known: tabletop"):
        load_arm(ROBOT, "elsewhere")


def test_an_arm_file_for_other_joints(tabletop: Robot) -> None:
    fewer = replace(tabletop, joints=tabletop.joints[:5])
    with pytest.raises(InvalidArm, match="other joints"):
        load_arm(fewer, "tabletop")


def test_servo_ids_are_unique() -> None:
    arm: ArmMap = ARM
    ids = [motor.id for motor in arm.motors]
    assert len(set(ids)) == len(ids) == 8
