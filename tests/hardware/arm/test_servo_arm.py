import numpy as np
import pytest

from hardware.exceptions import (
    FollowingError,
    HardwareError,
    OutsideLimits,
    PairDisagreement,
    ServoAlarm,
    ServoMissing,
    TorqueLost,
    UnsafeGoal,
)
from hardware.tolerances import TICK_S
from tests.hardware.parts import Bench, make_bench


@pytest.fixture
def bench() -> Bench:
    it = make_bench()
    it.arm.check()
    return it


def set_register(bench: Bench, servo_id: int, name: str, value: int) -> None:
    servo = bench.bus.simulated.servo(servo_id)
    assert servo is not None
    servo.table[name] = value


def test_a_check_writes_nothing_and_learns_whether_torque_is_on(bench: Bench) -> None:
    assert bench.arm.torque == "off"
    bench.arm.enable_torque()
    sent = len(bench.bus.sent)
    bench.arm.check()
    assert bench.arm.torque == "on"
    assert {packet[4] for packet in bench.bus.sent[sent:]} == {2}
    set_register(bench, 41, "torque_enable", 0)
    bench.arm.check()
    assert bench.arm.torque == "partly"


@pytest.mark.parametrize(
    ("command", "error"),
    [
        ("missing 31", ServoMissing),
        ("overload 31", ServoAlarm),
        ("slip 22 100", PairDisagreement),
    ],
)
def test_a_check_finds_what_is_wrong(
    bench: Bench, command: str, error: type[HardwareError]
) -> None:
    bench.fault(command)
    with pytest.raises(error):
        bench.arm.check()


def test_torque_comes_on_where_the_arm_stands_whatever_stale_goal_there_was(
    bench: Bench,
) -> None:
    for servo in bench.bus.simulated.servos:
        servo.table["goal_position"] = 100
        servo.table["moving_speed"] = 0
    before = bench.true_joints()
    bench.arm.enable_torque()
    bench.time.sleep(10)
    assert np.abs(np.array(bench.true_joints()) - before).max() < 0.011
    assert all(servo.table["torque_enable"] == 1 for servo in bench.bus.simulated.servos)


def test_torque_stays_off_outside_the_joint_limits() -> None:
    home = list(make_bench().robot.home_joints)
    bench = make_bench((*home[:1], 1.9, *home[2:]))
    bench.arm.check()
    with pytest.raises(OutsideLimits, match="joint_2"):
        bench.arm.enable_torque()
    assert {packet[4] for packet in bench.bus.sent} == {2}


def test_a_goal_needs_torque_first(bench: Bench) -> None:
    with pytest.raises(RuntimeError):
        bench.arm.command(np.array(bench.robot.home_joints), TICK_S)


def test_a_refused_goal_is_not_sent_and_not_remembered(bench: Bench) -> None:
    bench.arm.enable_torque()
    here = bench.arm.read_joints()
    sent = len(bench.bus.sent)
    with pytest.raises(UnsafeGoal):
        bench.arm.command(here + 0.5, TICK_S)
    assert len(bench.bus.sent) == sent
    bench.arm.command(here, TICK_S)
    assert len(bench.bus.sent) == sent + 1


def test_the_arm_arrives_where_it_is_sent(bench: Bench) -> None:
    bench.arm.enable_torque()
    start = bench.arm.read_joints()
    way = 0.01 * np.array([-1, -1, 1, 1, -1, 1])
    for tick in range(1, 41):
        bench.arm.command(start + tick * way, TICK_S)
        bench.time.sleep(TICK_S)
    bench.time.sleep(0.2)
    assert np.abs(np.array(bench.true_joints()) - (start + 40 * way)).max() < 0.003
    assert bench.arm.has_arrived(bench.arm.chain.sweep())


def test_arrival_names_the_joint_that_is_not_there(bench: Bench) -> None:
    bench.arm.enable_torque()
    start = bench.arm.read_joints()
    bench.fault("jam 41")
    for tick in range(1, 11):
        bench.arm.command(start - 0.01 * tick, TICK_S)
        bench.time.sleep(TICK_S)
    bench.time.sleep(0.2)
    positions = bench.arm.chain.sweep()
    assert not bench.arm.has_arrived(positions)
    with pytest.raises(FollowingError, match="did not arrive") as caught:
        bench.arm.check_arrived(positions)
    assert caught.value.joint == "joint_4"
    assert caught.value.error_rad == pytest.approx(0.1, abs=0.02)


def test_one_stray_reading_is_no_fault_and_three_are(bench: Bench) -> None:
    bench.arm.enable_torque()
    joints = len(bench.map.drives)
    for stray_rounds in (1, 2):
        bench.fault("slip 41 100")
        for _ in range(stray_rounds * joints):
            bench.arm.poll()
        bench.fault("heal")
        for _ in range(joints):
            bench.arm.poll()
    bench.fault("slip 41 100")
    for _ in range(3 * joints - 3):
        bench.arm.poll()
    with pytest.raises(FollowingError, match="joint_4"):
        bench.arm.poll()


def test_a_hold_stops_a_motion_at_once(bench: Bench) -> None:
    bench.arm.enable_torque()
    # A long way at speed, as no plan would ask for: the servos themselves would go on.
    bench.arm.chain.send({11: 1000}, {11: 200})
    bench.time.sleep(0.1)
    moving = bench.true_joints()[0]
    held = bench.arm.hold()
    assert held.still
    assert held.joints is not None
    assert abs(bench.true_joints()[0] - moving) < 0.02
    stood = bench.true_joints()
    bench.time.sleep(10)
    assert bench.true_joints() == stood


def test_a_hold_without_torque_sends_nothing(bench: Bench) -> None:
    held = bench.arm.hold()
    assert held.still
    assert {packet[4] for packet in bench.bus.sent} == {2}


def test_a_hold_with_a_missing_servo_holds_the_others_and_says_so(bench: Bench) -> None:
    bench.arm.enable_torque()
    bench.arm.chain.send({11: 1000, 61: 1000}, {11: 200, 61: 200})
    bench.time.sleep(0.1)
    bench.fault("missing 61")
    held = bench.arm.hold()
    assert not held.still
    assert held.joints is None
    assert "61" in held.detail
    stood = bench.true_joints()[0]
    bench.time.sleep(10)
    assert bench.true_joints()[0] == pytest.approx(stood, abs=0.006)


def test_a_posture_is_known_once_every_servo_was_read() -> None:
    bench = make_bench()
    assert bench.arm.chain.last_posture() is None
    assert bench.arm.chain.health() == ()
    for _ in bench.map.drives:
        bench.arm.poll()
    posture = bench.arm.chain.last_posture()
    assert posture is not None
    joints, read_at = posture
    assert joints == pytest.approx(bench.robot.home_joints, abs=0.011)
    assert read_at.endswith("Z")
    assert [health.id for health in bench.arm.chain.health()] == [11, 21, 22, 31, 32, 41, 51, 61]
    assert {health.voltage_v for health in bench.arm.chain.health()} == {16.0}


def test_torque_that_is_lost_is_noticed_and_the_state_says_so(bench: Bench) -> None:
    bench.arm.enable_torque()
    bench.fault("power-cycle")
    with pytest.raises(TorqueLost):
        bench.arm.poll()
    assert bench.arm.torque == "partly"
    sent = len(bench.bus.sent)
    held = bench.arm.hold()
    assert held.still
    assert bench.arm.torque == "off"
    # A goal would put the servos under power again.
    assert {packet[4] for packet in bench.bus.sent[sent:]} == {2}
    for _ in range(30):
        bench.arm.poll()


def test_a_hold_sends_goals_only_to_servos_under_power(bench: Bench) -> None:
    bench.arm.enable_torque()
    set_register(bench, 41, "torque_enable", 0)
    set_register(bench, 22, "torque_limit", 0)
    held = bench.arm.hold()
    assert "22, 41" in held.detail
    assert bench.arm.torque == "partly"
    servo = bench.bus.simulated.servo(41)
    assert servo is not None
    assert servo.table["torque_enable"] == 0
    packet = next(packet for packet in reversed(bench.bus.sent) if packet[4] == 0x83)
    assert packet[7:-1:5] == bytes((11, 21, 31, 32, 51, 61))


def test_a_check_that_fails_still_learns_where_torque_is_on(bench: Bench) -> None:
    bench.arm.enable_torque()
    bench.fault("voltage 41")
    with pytest.raises(ServoAlarm):
        bench.arm.check()
    assert bench.arm.torque == "on"
    assert bench.arm.hold().still


def test_after_a_bus_came_back_with_other_servos_nothing_lags(bench: Bench) -> None:
    bench.arm.enable_torque()
    bench.fault("power-cycle")
    bench.arm.check()
    assert bench.arm.torque == "off"
    set_register(bench, 51, "goal_position", 300)
    servo = bench.bus.simulated.servo(51)
    assert servo is not None
    servo._position = 300
    for _ in range(30):
        bench.arm.poll()


@pytest.mark.parametrize("seed", range(5))
def test_an_arm_at_its_limits_can_leave_them(seed: int) -> None:
    robot = make_bench().robot
    bench = make_bench(tuple(robot.upper.tolist()), seed=seed)
    bench.arm.enable_torque()
    before = np.array(bench.true_joints())
    bench.arm.command(bench.arm.commanded - 0.01, TICK_S)
    bench.time.sleep(1)
    assert (np.array(bench.true_joints()) < before).all()
