"""A hold: who gets a goal, when the arm counts as standing, and what keeps it from being held."""

from collections.abc import Callable

import numpy as np
import pytest

from hardware.bus.bus import StatusReply
from hardware.bus.packets import READ
from hardware.exceptions import BusLost
from hardware.servos.joints import SYNC_CABLE
from hardware.servos.units import speed_ticks
from hardware.tolerances import TICK_S
from tests.hardware.parts import Bench, goals_sent, make_bench, told

HOLD_SPEED = speed_ticks(0.3)
INTERVAL_S = 0.1


@pytest.fixture
def bench() -> Bench:
    it = make_bench(noise_ticks=0)
    it.arm.enable_torque()
    it.bus.sent.clear()
    return it


def on_read(bench: Bench, of: int, then: Callable[[int], None]) -> None:
    """Something happens before each read of a servo; it is told which read it is, from 0."""
    real, reads = bench.bus.read, 0

    def read(servo_id: int, address: int, size: int) -> StatusReply:
        nonlocal reads
        if servo_id == of:
            then(reads)
            reads += 1
        return real(servo_id, address, size)

    bench.bus.read = read  # type: ignore[method-assign]


def stands_off_its_goal(bench: Bench, servo_id: int, counts: int) -> None:
    bench.fault(f"jam {servo_id}")
    bench.fault(f"slip {servo_id} {counts}")


def test_every_servo_is_told_to_stand_where_it_stands(bench: Bench) -> None:
    stands_off_its_goal(bench, 41, 30)
    held = bench.arm.hold()
    assert (held.still, held.detail) == (True, "")
    (rows,) = goals_sent(bench.bus.sent)
    assert rows[41] == (542, HOLD_SPEED)
    assert rows[11] == (512, HOLD_SPEED)
    assert (rows[21], rows[22]) == ((3516, HOLD_SPEED), (579, HOLD_SPEED))
    # Read once to know where, once more to know that it stands.
    first, *rest = told(bench.bus.sent)
    assert [sent.servo_id for sent in told(bench.bus.sent)].count(41) == 2
    assert first.instruction == READ
    assert len(rest) == 2 * 8


def test_after_a_hold_motion_goes_on_from_where_the_arm_stands(bench: Bench) -> None:
    stands_off_its_goal(bench, 41, 30)
    held = bench.arm.hold()
    assert held.joints is not None
    assert held.joints[3] == pytest.approx(bench.map.drives[3].angle(542))
    assert (bench.arm.commanded == held.joints).all()
    bench.arm.command(held.joints + 0.01 * np.eye(6)[3], TICK_S)


def test_a_hold_of_an_arm_that_was_under_power_before_commands_nothing_later() -> None:
    bench = make_bench(noise_ticks=0)
    for servo in bench.bus.simulated.servos:
        servo.table["torque_enable"] = 1
    held = bench.arm.hold()
    assert held.still
    assert len(goals_sent(bench.bus.sent)) == 1
    with pytest.raises(RuntimeError):
        _ = bench.arm.commanded


def test_after_a_hold_of_an_arm_that_lost_its_torque_there_is_no_goal(bench: Bench) -> None:
    bench.fault("power-cycle")
    held = bench.arm.hold()
    assert (held.still, held.detail, bench.arm.torque) == (True, "", "off")
    assert goals_sent(bench.bus.sent) == []
    with pytest.raises(RuntimeError):
        _ = bench.arm.commanded


@pytest.mark.parametrize("servo_id", [11, 22])
def test_after_a_hold_without_full_torque_there_is_no_goal(bench: Bench, servo_id: int) -> None:
    bench.servo(servo_id).table["torque_enable"] = 0
    held = bench.arm.hold()
    assert held.still
    assert held.detail == f"these servos have no torque and are not held: {servo_id}"
    with pytest.raises(RuntimeError):
        _ = bench.arm.commanded


@pytest.mark.parametrize(("counts", "still"), [(3, True), (-3, True), (4, False), (-4, False)])
@pytest.mark.parametrize("servo_id", [11, 61])
def test_still_is_within_three_counts_between_two_reads(
    bench: Bench, servo_id: int, counts: int, still: bool
) -> None:
    start = bench.time.now_s
    on_read(bench, servo_id, lambda k: bench.fault(f"slip {servo_id} {k * counts}"))
    held = bench.arm.hold()
    assert held.still == still
    assert held.joints is not None
    # Read every tenth of a second, for a second and a half or until it stands.
    passed = bench.time.now_s - start
    assert passed == pytest.approx(INTERVAL_S if still else 1.5, abs=INTERVAL_S / 2)
    assert held.detail == ("" if still else "the arm still moves")


@pytest.mark.parametrize("moves", [1, 5, 13])
def test_an_arm_that_comes_to_a_stand_is_waited_for(bench: Bench, moves: int) -> None:
    """The last posture read is told, and the goals are those of the first."""
    start = bench.time.now_s
    on_read(bench, 51, lambda k: bench.fault(f"slip 51 {-20 * min(k, moves)}"))
    held = bench.arm.hold()
    assert held.still
    assert bench.time.now_s - start == pytest.approx((moves + 1) * INTERVAL_S)
    assert held.joints is not None
    assert held.joints[4] == pytest.approx(bench.map.drives[4].angle(819 - 20 * moves))
    assert goals_sent(bench.bus.sent)[0][51][0] == 819
    assert len(goals_sent(bench.bus.sent)) == 1


def test_a_servo_that_is_lost_while_it_is_waited_for_ends_the_wait(bench: Bench) -> None:
    start = bench.time.now_s

    def then(k: int) -> None:
        bench.fault(f"slip 11 {20 * k}")
        if k == 3:
            bench.fault("missing 51")
            bench.fault("missing 22")

    on_read(bench, 11, then)
    held = bench.arm.hold()
    assert not held.still
    assert held.joints is None
    assert held.detail == "these servos cannot be read: 22, 51"
    assert bench.time.now_s - start == pytest.approx(3 * INTERVAL_S)


@pytest.mark.parametrize(
    ("lost", "told_to_hold"),
    [
        (11, [21, 22, 31, 32, 41, 51, 61]),
        (22, [11, 31, 32, 41, 51, 61]),
        (31, [11, 21, 22, 41, 51, 61]),
    ],
)
def test_a_joint_of_which_a_servo_is_lost_keeps_its_last_goal(
    bench: Bench, lost: int, told_to_hold: list[int]
) -> None:
    """The middle of a pair is not known by one of the two."""
    bench.fault(f"missing {lost}")
    held = bench.arm.hold()
    assert held.detail == f"these servos cannot be read: {lost}"
    (rows,) = goals_sent(bench.bus.sent)
    assert list(rows) == told_to_hold


def test_a_hold_that_sees_no_servo_sends_nothing(bench: Bench) -> None:
    bench.fault("silent")
    held = bench.arm.hold()
    assert (held.still, held.joints) == (False, None)
    assert goals_sent(bench.bus.sent) == []
    bench.bus.gone = True
    with pytest.raises(BusLost):
        bench.arm.hold()


def test_a_pair_gets_the_middle_of_what_its_servos_say(bench: Bench) -> None:
    bench.fault("slip 22 20")
    held = bench.arm.hold()
    assert held.detail == ""
    (rows,) = goals_sent(bench.bus.sent)
    assert (rows[21][0], rows[22][0]) == (3506, 589)


def test_each_of_a_pair_that_disagrees_stays_where_it_says_it_stands(bench: Bench) -> None:
    bench.fault("slip 31 40")
    held = bench.arm.hold()
    assert held.still
    assert held.detail.startswith("joint_3: its two servos are ")
    (rows,) = goals_sent(bench.bus.sent)
    assert (rows[31], rows[32]) == ((552, HOLD_SPEED), (511, HOLD_SPEED))


def test_the_slave_of_a_sync_cable_gets_no_goal_even_then() -> None:
    bench = make_bench(coupling_of_joint_2=SYNC_CABLE, noise_ticks=0)
    bench.arm.enable_torque()
    bench.fault("slip 21 100")
    bench.bus.sent.clear()
    assert "joint_2" in bench.arm.hold().detail
    (rows,) = goals_sent(bench.bus.sent)
    assert 22 not in rows
    assert rows[21][0] == 3616


def test_every_doubt_is_told(bench: Bench) -> None:
    bench.fault("slip 22 100")
    bench.fault("slip 32 40")
    bench.servo(11).table["torque_enable"] = 0
    bench.servo(41).table["torque_limit"] = 0
    on_read(bench, 51, lambda k: bench.fault(f"slip 51 {k * -8}"))
    held = bench.arm.hold()
    assert not held.still
    moves, torque, *pairs = held.detail.split("; ")
    assert moves == "the arm still moves"
    assert torque == "these servos have no torque and are not held: 11, 41"
    assert [pair.partition(":")[0] for pair in pairs] == ["joint_2", "joint_3"]


def test_an_alarm_does_not_keep_an_arm_from_being_held(bench: Bench) -> None:
    bench.fault("voltage 41")
    held = bench.arm.hold()
    assert (held.still, held.detail) == (True, "")
    assert 41 in goals_sent(bench.bus.sent)[0]


def test_the_posture_of_a_hold_is_that_of_both_servos_of_a_pair(bench: Bench) -> None:
    stands_off_its_goal(bench, 22, 20)
    held = bench.arm.hold()
    assert held.joints is not None
    counts = {servo.servo_id: servo.position for servo in bench.bus.simulated.servos}
    middle = bench.map.joints(counts | {21: 3506, 22: 589})
    assert held.joints == pytest.approx(middle, abs=1e-9)
