"""Goals in small steps, and how reads of the arm are judged against them."""

import math

import numpy as np
import pytest

from hardware.exceptions import (
    FollowingError,
    PairDisagreement,
    ServoAlarm,
    TorqueLost,
    UnsafeGoal,
)
from hardware.servos.units import SPEED_UNIT_RAD_S, ticks_per_radian
from hardware.tolerances import TICK_S
from tests.hardware.parts import Bench, goals_sent, make_bench, told

JOINTS = 6
INWARDS = np.array([1, -1, 1, 1, -1, 1])
"""Away from the limits that are near home."""
RX_COUNT_RAD = math.radians(300 / 1023)


@pytest.fixture
def bench() -> Bench:
    it = make_bench(noise_ticks=0)
    it.arm.enable_torque()
    it.bus.sent.clear()
    return it


def poll_round(bench: Bench, rounds: int = 1) -> None:
    for _ in range(rounds * JOINTS):
        bench.arm.poll()


# --- Goals ----------------------------------------------------------------------------------------
def test_a_goal_is_reached_in_its_step_with_a_tenth_to_spare(bench: Bench) -> None:
    start = bench.arm.commanded
    bench.arm.command(start + np.array([0.02, -0.03, 0.01, 0.0, 0.0001, -0.04]), TICK_S)
    (rows,) = goals_sent(bench.bus.sent)
    # Never slower than 0.1 rad/s: a goal less than a count away is reached all the same.
    needed = {11: 1.1, 21: 1.65, 22: 1.65, 31: 0.55, 32: 0.55, 41: 0.1, 51: 0.1, 61: 2.2}
    speeds = {servo_id: speed for servo_id, (_, speed) in rows.items()}
    wanted = {servo_id: math.ceil(speed / SPEED_UNIT_RAD_S) for servo_id, speed in needed.items()}
    assert speeds == wanted
    goals = {servo_id: goal for servo_id, (goal, _) in rows.items()}
    assert goals == bench.map.goals(bench.arm.commanded)
    assert goals[21] + goals[22] == 4095
    assert goals[31] + goals[32] == 1023


def test_a_longer_step_is_slower(bench: Bench) -> None:
    bench.arm.command(bench.arm.commanded + 0.5 * INWARDS, 1.0)
    (rows,) = goals_sent(bench.bus.sent)
    assert {speed for _, speed in rows.values()} == {math.ceil(0.55 / SPEED_UNIT_RAD_S)}


def test_each_step_counts_from_the_goal_before(bench: Bench) -> None:
    start, way = bench.arm.commanded, 0.03 * INWARDS
    bench.arm.command(start + way, TICK_S)
    bench.arm.command(start + 2 * way, TICK_S)
    first, second = goals_sent(bench.bus.sent)
    assert [speed for _, speed in first.values()] == [speed for _, speed in second.values()]
    with pytest.raises(UnsafeGoal, match="too fast"):
        bench.arm.command(start - way, TICK_S)
    assert bench.arm.commanded == pytest.approx(start + 2 * way)
    assert len(goals_sent(bench.bus.sent)) == 2


def test_a_goal_is_kept_as_it_was_when_it_was_sent(bench: Bench) -> None:
    goal = bench.arm.commanded + 0.01
    bench.arm.command(goal, TICK_S)
    kept = bench.arm.commanded.copy()
    goal += 1.0
    assert (bench.arm.commanded == kept).all()


# --- Arrival --------------------------------------------------------------------------------------
@pytest.mark.parametrize("servo_id", [11, 22, 32, 61])
@pytest.mark.parametrize(("counts", "arrived"), [(3, True), (-3, True), (4, False), (-4, False)])
def test_a_servo_within_three_counts_of_its_goal_has_arrived(
    bench: Bench, servo_id: int, counts: int, arrived: bool
) -> None:
    bench.fault(f"slip {servo_id} {counts}")
    positions = bench.arm.chain.sweep()
    assert bench.arm.has_arrived(positions) == arrived
    if arrived:
        bench.arm.check_arrived(positions)
    else:
        with pytest.raises(FollowingError, match="did not arrive"):
            bench.arm.check_arrived(positions)


def test_the_joint_furthest_off_is_named_with_how_far(bench: Bench) -> None:
    for fault in ("slip 11 5", "slip 41 -9", "slip 51 7"):
        bench.fault(fault)
    with pytest.raises(FollowingError) as caught:
        bench.arm.check_arrived(bench.arm.chain.sweep())
    assert caught.value.joint == "joint_4"
    assert caught.value.error_rad == pytest.approx(-9 * RX_COUNT_RAD)


def test_of_a_pair_the_servo_further_off_counts_in_the_joints_direction(bench: Bench) -> None:
    """Joint 3 turns against its first servo, and its second against that."""
    bench.fault("slip 31 4")
    bench.fault("slip 32 6")
    with pytest.raises(FollowingError) as caught:
        bench.arm.check_arrived(bench.arm.chain.sweep())
    assert caught.value.joint == "joint_3"
    assert caught.value.error_rad == pytest.approx(6 * RX_COUNT_RAD)
    bench.fault("slip 31 8")
    with pytest.raises(FollowingError) as caught:
        bench.arm.check_arrived(bench.arm.chain.sweep())
    assert caught.value.error_rad == pytest.approx(-8 * RX_COUNT_RAD)


def test_without_a_goal_an_arm_is_where_it_is_to_be() -> None:
    bench = make_bench()
    positions = bench.arm.chain.sweep()
    assert bench.arm.has_arrived(positions)
    bench.arm.check_arrived(positions)


# --- Polls ----------------------------------------------------------------------------------------
def test_polls_go_round_the_joints(bench: Bench) -> None:
    poll_round(bench, 2)
    ids = [11, 21, 22, 31, 32, 41, 51, 61]
    assert [sent.servo_id for sent in told(bench.bus.sent)] == 2 * ids


@pytest.mark.parametrize(("counts", "lags"), [(39, False), (-39, False), (40, True), (-40, True)])
def test_a_joint_may_be_a_fifth_of_a_radian_behind(bench: Bench, counts: int, lags: bool) -> None:
    assert 39 * RX_COUNT_RAD < 0.2 < 40 * RX_COUNT_RAD
    bench.fault(f"slip 41 {counts}")
    if not lags:
        poll_round(bench, 10)
        return
    poll_round(bench, 2)
    for _ in range(3):
        bench.arm.poll()
    with pytest.raises(FollowingError, match=r"lags behind its goal by 0\.20") as caught:
        bench.arm.poll()
    assert caught.value.joint == "joint_4"
    assert caught.value.error_rad == pytest.approx(counts * RX_COUNT_RAD, abs=1e-9)


def test_a_pair_lags_by_the_middle_of_what_its_servos_say(bench: Bench) -> None:
    """Joint 3 turns against the counts of its first servo."""
    bench.fault("slip 31 44")
    bench.fault("slip 32 -36")
    poll_round(bench, 2)
    with pytest.raises(FollowingError) as caught:
        poll_round(bench)
    assert caught.value.joint == "joint_3"
    assert caught.value.error_rad == pytest.approx(-40 * RX_COUNT_RAD, abs=1e-9)
    bench.fault("slip 31 43")
    bench.fault("slip 32 -35")
    poll_round(bench, 10)


def test_lagging_is_counted_for_each_joint_and_anew_after_a_fault(bench: Bench) -> None:
    bench.fault("slip 41 60")
    poll_round(bench)
    bench.fault("slip 11 60")
    poll_round(bench)
    for _ in range(3):
        bench.arm.poll()
    with pytest.raises(FollowingError, match="joint_4"):
        bench.arm.poll()
    # Joint 1 was known to lag twice: whoever is told of joint 4 looks at the whole arm.
    for _ in range(2 + 2 * JOINTS):
        bench.arm.poll()
    with pytest.raises(FollowingError, match="joint_1"):
        bench.arm.poll()


def test_reads_that_lag_have_to_follow_each_other(bench: Bench) -> None:
    for _ in range(3):
        bench.fault("slip 41 60")
        poll_round(bench, 2)
        bench.fault("slip 41 0")
        poll_round(bench)
    assert bench.arm.torque == "on"


def test_a_pair_has_to_disagree_three_times_in_succession(bench: Bench) -> None:
    for _ in range(3):
        bench.fault("slip 32 12")
        poll_round(bench, 2)
        bench.fault("slip 32 0")
        poll_round(bench)
    bench.fault("slip 32 12")
    poll_round(bench, 2)
    bench.arm.poll()
    bench.arm.poll()
    with pytest.raises(PairDisagreement) as caught:
        bench.arm.poll()
    assert caught.value.joint == "joint_3"
    # After it was told it is counted anew.
    poll_round(bench, 2)
    with pytest.raises(PairDisagreement):
        poll_round(bench)


def test_pairs_are_counted_each_by_itself(bench: Bench) -> None:
    bench.fault("slip 32 12")
    bench.fault("slip 22 60")
    poll_round(bench, 2)
    with pytest.raises(PairDisagreement, match="joint_2"):
        poll_round(bench)


def test_pairs_are_watched_without_torque_and_lag_is_not() -> None:
    bench = make_bench(noise_ticks=0)
    bench.fault("slip 41 100")
    poll_round(bench, 5)
    bench.fault("slip 32 12")
    poll_round(bench, 2)
    with pytest.raises(PairDisagreement):
        poll_round(bench)


@pytest.mark.parametrize("servo_id", [11, 22, 61])
def test_torque_that_is_lost_is_told_at_once_and_once(bench: Bench, servo_id: int) -> None:
    bench.servo(servo_id).table["torque_enable"] = 0
    with pytest.raises(TorqueLost) as caught:
        poll_round(bench)
    assert caught.value.servo_id == servo_id
    with pytest.raises(RuntimeError):
        _ = bench.arm.commanded
    bench.fault(f"slip {servo_id} 4")
    poll_round(bench, 5)


def test_what_was_counted_is_forgotten_with_the_goal(bench: Bench) -> None:
    """Other servos, or the same after a person turned them: two reads of before say nothing."""
    bench.fault("slip 32 12")
    bench.fault("slip 41 60")
    poll_round(bench, 2)
    bench.fault("power-cycle")
    with pytest.raises(TorqueLost):
        poll_round(bench)
    bench.fault("slip 41 0")
    bench.fault("slip 32 0")
    bench.arm.enable_torque()
    bench.fault("slip 32 12")
    bench.fault("slip 41 60")
    poll_round(bench, 2)


def test_torque_that_was_on_already_is_watched_after_a_check() -> None:
    bench = make_bench(noise_ticks=0)
    bench.arm.enable_torque()
    for held in (True, False):
        bench.arm.check()
        bench.servo(51).table["torque_enable"] = 0
        if held:
            with pytest.raises(TorqueLost, match="servo 51"):
                poll_round(bench)
        else:
            poll_round(bench, 4)


def test_an_alarm_is_told_by_the_poll_that_reads_it(bench: Bench) -> None:
    bench.fault("voltage 21")
    bench.arm.poll()
    with pytest.raises(ServoAlarm):
        bench.arm.poll()
    # The next poll goes on with the next joint.
    bench.bus.sent.clear()
    bench.arm.poll()
    assert [sent.servo_id for sent in told(bench.bus.sent)] == [31, 32]


def test_counts_of_the_larger_servo_are_finer(bench: Bench) -> None:
    assert ticks_per_radian(bench.map.drives[1].servo) == pytest.approx(935, abs=1)
    bench.fault("slip 21 4")
    with pytest.raises(FollowingError) as caught:
        bench.arm.check_arrived(bench.arm.chain.sweep())
    assert caught.value.error_rad == pytest.approx(math.radians(4 * 250.92 / 4095))
