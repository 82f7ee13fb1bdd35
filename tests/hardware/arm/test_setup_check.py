"""What a servo has to be and how it has to be set up before the arm is used."""

import math
from collections.abc import Mapping

import pytest

from hardware.arm.servo_chain import ServoChain
from hardware.arm.setup_check import check_model, check_pair, check_setup, is_simulated
from hardware.exceptions import (
    BusLost,
    HardwareError,
    PairDisagreement,
    ServoAlarm,
    ServoMissing,
    WrongSetting,
)
from hardware.servos.control_tables import SIMULATED_FIRMWARE
from hardware.servos.joints import SYNC_CABLE, calibrated
from tests.hardware.parts import Bench, make_bench

IDS = (11, 21, 22, 31, 32, 41, 51, 61)


@pytest.fixture
def bench() -> Bench:
    return make_bench(noise_ticks=0)


def check(bench: Bench) -> None:
    check_setup(bench.robot, bench.arm.chain)


def passes(bench: Bench, servo_id: int, registers: Mapping[str, int]) -> bool:
    """Whether the setup is right with these registers; if not, that servo has to be named."""
    for name, value in registers.items():
        bench.servo(servo_id).table[name] = value
    named = None
    try:
        check(bench)
    except WrongSetting as error:
        named = error.servo_id
    assert named in (None, servo_id)
    return named is None


@pytest.mark.parametrize("servo_id", IDS)
@pytest.mark.parametrize(
    ("register", "value", "said"),
    [
        ("model_number", 12, "is model 12, the arm file says "),
        ("status_return_level", 1, "status return level is 1, needs 2"),
        ("status_return_level", 3, "status return level is 3, needs 2"),
        ("torque_limit", 0, "torque limit is 0"),
        ("ccw_angle_limit", 0, "both angle limits are 0"),
    ],
)
def test_every_servo_is_checked_and_the_wrong_one_named(
    bench: Bench, servo_id: int, register: str, value: int, said: str
) -> None:
    check(bench)
    bench.servo(servo_id).table[register] = value
    with pytest.raises(WrongSetting, match=f"servo {servo_id}.*{said}") as caught:
        check(bench)
    assert caught.value.servo_id == servo_id


def test_the_first_of_several_wrong_servos_is_named(bench: Bench) -> None:
    for servo_id in (61, 32, 41):
        bench.servo(servo_id).table["torque_limit"] = 0
    with pytest.raises(WrongSetting) as caught:
        check(bench)
    assert caught.value.servo_id == 32


@pytest.mark.parametrize(
    ("command", "error"),
    [
        ("missing 61", ServoMissing),
        ("voltage 22", ServoAlarm),
        ("slip 22 47", PairDisagreement),
        ("slip 32 10", PairDisagreement),
    ],
)
def test_health_and_pairs_are_checked_too(
    bench: Bench, command: str, error: type[HardwareError]
) -> None:
    bench.fault(command)
    with pytest.raises(error):
        check(bench)


def test_the_least_torque_limit_that_is_none_of_a_shutdown_is_accepted(bench: Bench) -> None:
    assert passes(bench, 41, {"torque_limit": 1})


@pytest.mark.parametrize("servo_id", [21, 22])
@pytest.mark.parametrize("mode", range(4))
def test_servos_that_both_get_goals_are_neither_master_nor_slave(
    bench: Bench, servo_id: int, mode: int
) -> None:
    assert passes(bench, servo_id, {"drive_mode": mode}) == (mode == 0)


@pytest.mark.parametrize(("servo_id", "wanted"), [(21, 0), (22, 2)])
@pytest.mark.parametrize("mode", range(4))
def test_on_a_sync_cable_the_partner_is_the_slave(servo_id: int, wanted: int, mode: int) -> None:
    bench = make_bench(coupling_of_joint_2=SYNC_CABLE, noise_ticks=0)
    assert passes(bench, servo_id, {"drive_mode": mode}) == (mode == wanted)


@pytest.mark.parametrize(
    ("servo_id", "lowest", "highest"),
    [
        # Counts of the joint's limits: the joint's lower and upper end, partners mirrored; joint 3
        # turns the other way, and ends where its servos do.
        (11, 51, 972),
        (21, 1313, 3663),
        (22, 4095 - 3663, 4095 - 1313),
        (31, 0, 542),
        (32, 1023 - 542, 1023),
        (41, 0, 1023),
        (51, 201, 822),
    ],
)
def test_angle_limits_may_be_as_narrow_as_the_joint_and_no_narrower(
    bench: Bench, servo_id: int, lowest: int, highest: int
) -> None:
    assert passes(bench, servo_id, {"cw_angle_limit": lowest, "ccw_angle_limit": highest})
    narrower = {"cw_angle_limit": lowest + 1, "ccw_angle_limit": highest}
    assert not passes(bench, servo_id, narrower)
    narrower = {"cw_angle_limit": lowest, "ccw_angle_limit": highest - 1}
    assert not passes(bench, servo_id, narrower)


@pytest.mark.parametrize("offset_deg", [-1.0, 1.0])
def test_what_a_joint_cannot_reach_asks_for_no_wider_limits(
    bench: Bench, offset_deg: float
) -> None:
    """A calibration moves one end of joint 4's range a few counts beyond its servo's."""
    offsets = "".join(f"joint_{i} = {offset_deg if i == 4 else 0}\n" for i in range(1, 7))
    arm = calibrated(bench.map, f'robot = "tabletop"\n[offset_deg]\n{offsets}'.encode())
    check_setup(bench.robot, ServoChain(arm, bench.bus))


@pytest.mark.parametrize(
    ("lowest", "highest", "endless"), [(0, 0, True), (5, 5, False), (0, 1, False), (1, 0, False)]
)
def test_only_two_zeros_turn_without_end(
    bench: Bench, lowest: int, highest: int, endless: bool
) -> None:
    bench.servo(61).table["cw_angle_limit"] = lowest
    bench.servo(61).table["ccw_angle_limit"] = highest
    with pytest.raises(WrongSetting) as caught:
        check(bench)
    assert ("without end" in caught.value.detail) == endless
    assert endless or f"{lowest} to {highest}, cut into the range of joint_6" in caught.value.detail


@pytest.mark.parametrize(("joint", "most"), [(1, 46), (2, 9)])
def test_a_pair_may_be_three_degrees_apart_either_way(bench: Bench, joint: int, most: int) -> None:
    """0.05 rad are 46.8 counts of joint 2's servos and 9.8 of joint 3's."""
    drive = bench.map.drives[joint]
    for apart in (most, -most):
        check_pair(drive, (300, 300 + apart))
    for apart in (most + 1, -most - 1):
        with pytest.raises(PairDisagreement) as caught:
            check_pair(drive, (300, 300 + apart))
        assert caught.value.joint == drive.joint
        counts_a_degree = (4095 / 250.92, 1023 / 300)[joint - 1]
        assert caught.value.apart_rad == pytest.approx(math.radians((most + 1) / counts_a_degree))


def test_a_single_servo_agrees_with_itself(bench: Bench) -> None:
    check_pair(bench.map.drives[0], (700,))


@pytest.mark.parametrize("wrong_by", [-1, 1])
def test_a_model_is_the_arm_files_or_it_is_not(bench: Bench, wrong_by: int) -> None:
    motor = bench.map.motors[2]
    check_model(bench.arm.chain, motor)
    bench.servo(22).table["model_number"] += wrong_by
    with pytest.raises(WrongSetting, match=r"EX-106\+"):
        check_model(bench.arm.chain, motor)


@pytest.mark.parametrize("version", [0, 23, SIMULATED_FIRMWARE - 1])
def test_one_servo_that_is_not_simulated_makes_an_arm_real(bench: Bench, version: int) -> None:
    assert is_simulated(bench.arm.chain)
    bench.servo(61).table["firmware_version"] = version
    assert not is_simulated(bench.arm.chain)


def test_silent_servos_do_not_say_what_they_are(bench: Bench) -> None:
    bench.fault("missing 11")
    assert is_simulated(bench.arm.chain)
    bench.fault("silent")
    assert not is_simulated(bench.arm.chain)
    bench.bus.gone = True
    with pytest.raises(BusLost):
        is_simulated(bench.arm.chain)


def test_a_check_only_reads(bench: Bench) -> None:
    check(bench)
    assert {packet[4] for packet in bench.bus.sent} == {2}
