"""Orders carried out on simulated servos, in time that passes tick by tick."""

import math
from dataclasses import replace

import numpy as np
import pytest

from hardware.bus.packets import SYNC_WRITE, WRITE
from hardware.end_effector.end_effectors import OFF, ON
from hardware.exceptions import (
    Canceled,
    EndEffectorFailed,
    FollowingError,
    HardwareError,
    OrderRefused,
    PairDisagreement,
    ServoAlarm,
    ServoMissing,
    TorqueLost,
    UnsafeGoal,
)
from hardware.link.messages import (
    CANCELED,
    COMPLETED,
    DONE,
    EXECUTING,
    FAILED,
    NOT_STARTED,
    PAUSED,
    SKIPPED,
    UNKNOWN,
)
from hardware.servos.joints import MIRRORED, SYNC_CABLE
from hardware.tolerances import TICK_S
from hardware.worker.order import Order, build_order
from tests.hardware.parts import Bench, goals_sent, make_bench, messages_of, plan_of_data_set_3
from tests.hardware.worker.runs import Run, make_run, tool_of

START_OFFSET = (0.15, -0.1, 0.2, -0.1, -0.2, 0.3)
MOST_ERROR_M = 0.003


def order_for(bench: Bench, **changes: object) -> Order:
    execute, motions = messages_of(plan_of_data_set_3())
    execute = replace(execute, **changes)  # type: ignore[arg-type]
    return build_order(bench.robot, tool_of(bench.robot), bench.map, execute, motions)


def start_run(seed: int = 0, coupling_of_joint_2: str = MIRRORED) -> Run:
    home = make_bench().robot.home_joints
    bench = make_bench(
        tuple(a + b for a, b in zip(home, START_OFFSET, strict=True)),
        seed=seed,
        coupling_of_joint_2=coupling_of_joint_2,
    )
    return make_run(bench, order_for(bench))


@pytest.fixture(scope="module")
def finished() -> Run:
    run = start_run()
    run.finish()
    return run


def test_every_target_is_done_and_measured_within_three_millimetres(finished: Run) -> None:
    account = finished.execution.account
    assert account.status == COMPLETED
    assert account.error is None
    assert [target.status for target in account.targets] == [DONE] * 5
    for target in account.targets:
        assert target.standby_error_m is not None
        assert target.target_error_m is not None
        # Not zero either: counts are whole numbers, and reads are noisy.
        assert 0 < target.standby_error_m < MOST_ERROR_M
        assert 0 < target.target_error_m < MOST_ERROR_M


@pytest.mark.parametrize("seed", range(1, 7))
def test_errors_stay_within_three_millimetres_whatever_the_noise(seed: int) -> None:
    run = start_run(seed)
    run.finish()
    errors = [
        error
        for target in run.execution.account.targets
        for error in (target.standby_error_m, target.target_error_m)
    ]
    assert max(error for error in errors if error is not None) < MOST_ERROR_M
    assert None not in errors


def test_a_pair_on_a_sync_cable_gets_goals_for_its_master_alone() -> None:
    run = start_run(coupling_of_joint_2=SYNC_CABLE)
    run.finish()
    assert run.execution.account.status == COMPLETED
    assert max(t.target_error_m or 1 for t in run.execution.account.targets) < MOST_ERROR_M
    assert {tuple(packet) for packet in goals_sent(run.bench.bus.sent)} == {
        (11, 21, 31, 32, 41, 51, 61)
    }


def test_it_ends_holding_at_the_last_standby(finished: Run) -> None:
    standby = plan_of_data_set_3().approaches[-1].standby_joints
    assert standby is not None
    assert np.abs(np.array(finished.bench.true_joints()) - standby).max() < 0.006
    assert all(servo.table["torque_enable"] == 1 for servo in finished.bench.bus.simulated.servos)


def test_the_end_effector_is_on_for_each_dwell_and_never_else(finished: Run) -> None:
    assert finished.end_effector.changes == [("dwell", ON), ("dwell", OFF)] * 5


def test_the_arm_follows_the_plan(finished: Run) -> None:
    """Where the servos truly were, tick by tick, is close to some posture of the planned motion."""
    planned = np.concatenate(
        [a.trajectory.joints for a in plan_of_data_set_3().approaches if a.trajectory is not None]
    )
    kept = [
        posture
        for posture, segment in zip(finished.postures, finished.segments, strict=True)
        if segment in ("transfer", "cut_in", "dwell", "retreat")
    ]
    assert len(kept) > 300
    furthest = max(np.abs(planned - posture).max(axis=1).min() for posture in kept)
    assert furthest < 0.06


def test_the_way_to_the_start_is_slow(finished: Run) -> None:
    rows = np.array(
        [p for p, s in zip(finished.postures, finished.segments, strict=True) if s == "approach"]
    )
    speeds = np.abs(np.diff(rows, axis=0)) / TICK_S
    assert 0.2 < speeds.max() < finished.bench.robot.velocity.max() * 0.25 * 1.5


def test_every_packet_is_safe(finished: Run) -> None:
    """Pairs mirrored, speeds above zero and below the limits, goals inside the joint limits."""
    bench = finished.bench
    packets = goals_sent(finished.bench.bus.sent)
    assert len(packets) > 400
    for packet in packets:
        assert list(packet) == [11, 21, 22, 31, 32, 41, 51, 61]
        assert packet[21][0] + packet[22][0] == 4095
        assert packet[31][0] + packet[32][0] == 1023
        assert packet[21][1] == packet[22][1]
        assert packet[31][1] == packet[32][1]
        goals = {servo_id: goal for servo_id, (goal, _) in packet.items()}
        joints = bench.map.joints(goals)
        assert (joints > bench.robot.lower - 0.011).all()
        assert (joints < bench.robot.upper + 0.011).all()
        for _, speed in packet.values():
            assert 0 < speed * 0.111 * 2 * math.pi / 60 < bench.robot.velocity.max() * 1.3


def test_nothing_but_goals_speeds_and_torque_is_ever_written(finished: Run) -> None:
    writes = [packet for packet in finished.bench.bus.sent if packet[4] == WRITE]
    assert len(writes) == 8
    assert {(packet[5], packet[6]) for packet in writes} == {(24, 1)}
    instructions = {packet[4] for packet in finished.bench.bus.sent}
    assert instructions == {2, WRITE, SYNC_WRITE}


def test_torque_comes_on_after_the_present_position_was_sent_and_read_back(finished: Run) -> None:
    sent = finished.bench.bus.sent
    first_goal = next(i for i, packet in enumerate(sent) if packet[4] == SYNC_WRITE)
    first_torque = next(i for i, packet in enumerate(sent) if packet[4] == WRITE)
    between = sent[first_goal:first_torque]
    for servo_id in (11, 21, 22, 31, 32, 41, 51, 61):
        for address in (30, 32):
            assert any(
                packet[2] == servo_id and packet[4:6] == bytes((2, address)) for packet in between
            )
    assert np.abs(np.array(finished.postures[0]) - finished.postures[1]).max() < 0.02


def test_a_pause_stands_on_the_path_and_goes_on() -> None:
    run = start_run()
    run.until("cut_in", 5)
    run.execution.pause()
    for _ in range(30):
        assert run.tick()
    assert run.execution.account.status == PAUSED
    stood = run.bench.true_joints()
    for _ in range(50):
        assert run.tick()
    assert np.abs(np.array(run.bench.true_joints()) - stood).max() < 0.006
    run.execution.resume()
    run.finish()
    assert run.execution.account.status == COMPLETED
    statuses = [account.status for account in run.accounts]
    first = statuses.index(PAUSED)
    assert EXECUTING in statuses[first:]


def test_a_pause_in_the_dwell_switches_off_and_the_rest_is_dwelt_later() -> None:
    run = start_run()
    run.until("dwell", 3)
    assert run.end_effector.state == ON
    run.execution.pause()
    assert run.tick()
    assert run.end_effector.state == OFF
    for _ in range(40):
        assert run.tick()
    assert run.execution.account.status == PAUSED
    run.execution.resume()
    run.finish()
    assert run.end_effector.changes[:4] == [("dwell", ON), ("dwell", OFF)] * 2
    assert [target.status for target in run.execution.account.targets] == [DONE] * 5


@pytest.mark.parametrize("segment", ["approach", "transfer", "cut_in", "dwell", "retreat"])
def test_cancel_ends_on_the_path(segment: str) -> None:
    run = start_run()
    run.until(segment, 3)
    run.execution.cancel()

    def to_the_end() -> None:
        while run.tick():
            pass

    with pytest.raises(Canceled) as caught:
        to_the_end()
    run.execution.end(caught.value)
    account = run.execution.account
    assert account.status == CANCELED
    first = {"approach": NOT_STARTED, "dwell": UNKNOWN, "retreat": DONE}.get(segment, SKIPPED)
    assert [target.status for target in account.targets] == [first, *[NOT_STARTED] * 4]
    assert run.end_effector.state == OFF
    assert run.bench.arm.hold().still


def test_a_cancel_cannot_be_taken_back() -> None:
    run = start_run()
    run.until("transfer", 5)
    run.execution.pause()
    for _ in range(30):
        assert run.tick()
    run.execution.cancel()
    run.execution.resume()
    run.execution.pause()
    with pytest.raises(Canceled):
        run.tick()


def test_a_dwell_lasts_as_long_as_asked_even_if_ticks_are_late() -> None:
    run = start_run()
    run.until("dwell")
    began = run.bench.time.now_s
    while run.execution.account.segment == "dwell":
        assert run.tick()
        run.bench.time.sleep(0.03)
    assert 0.2 <= run.bench.time.now_s - began < 0.2 + 2 * 0.05


@pytest.mark.parametrize(
    ("command", "error"),
    [
        ("missing 41", ServoMissing),
        ("overload 31", ServoAlarm),
        ("overheat 11", ServoAlarm),
        ("voltage 61", ServoAlarm),
        ("jam 11", FollowingError),
        ("jam 22", FollowingError),
        ("slip 32 40", PairDisagreement),
        ("silent", ServoMissing),
    ],
)
@pytest.mark.parametrize("segment", ["transfer", "cut_in", "dwell"])
def test_faults_in_the_middle_are_named(
    command: str, error: type[HardwareError], segment: str
) -> None:
    run = start_run()
    run.until(segment, 5)
    run.bench.fault(command)
    with pytest.raises(HardwareError) as caught:
        run.finish()
    assert isinstance(caught.value, error)
    run.execution.end(caught.value)
    account = run.execution.account
    assert account.status == FAILED
    assert account.error is not None
    assert account.error.code == caught.value.code
    assert account.error.detail


def test_a_servo_that_loses_its_power_in_a_dwell_is_named() -> None:
    """While goals are streamed the next one may put it under power again, and nobody can tell."""
    run = start_run()
    run.until("dwell", 3)
    run.bench.fault("power-cycle")
    with pytest.raises(TorqueLost):
        run.finish()


def test_a_dwell_over_which_the_light_went_out_is_no_dwell() -> None:
    """A worker that stood still: its guard has switched off, and the clock has gone on."""
    run = start_run()
    run.until("dwell", 1)
    run.end_effector.state = OFF
    run.bench.time.sleep(5)
    with pytest.raises(EndEffectorFailed):
        run.tick()


def test_orders_for_another_model_tool_or_incomplete_are_refused() -> None:
    bench = make_bench()
    for changes in (
        {"model_version": "another"},
        {"tool": "scaffold"},
        {"target_count": 6},
        {"start_joints": (0.0,) * 6},
    ):
        with pytest.raises(OrderRefused):
            order_for(bench, **changes)


def test_orders_with_an_unsafe_row_are_refused_before_anything_moves() -> None:
    bench = make_bench()
    execute, motions = messages_of(plan_of_data_set_3())
    for row, angle in ((40, 2.5), (40, math.nan), (3, 1.0)):
        rows = [list(values) for values in motions[2].joints]
        rows[row][0] = angle
        spoiled = [*motions]
        spoiled[2] = replace(motions[2], joints=tuple(map(tuple, rows)))
        with pytest.raises(UnsafeGoal):
            build_order(bench.robot, tool_of(bench.robot), bench.map, execute, spoiled)
    assert bench.bus.sent == []


def test_orders_of_another_shape_are_refused() -> None:
    bench = make_bench()
    execute, motions = messages_of(plan_of_data_set_3())
    first, *others = motions
    spoiled = (
        replace(first, standby_joints=first.standby_joints[:5]),
        replace(first, joints=(first.joints[0][:5], *first.joints[1:])),
        replace(first, times_s=first.times_s[:-1]),
        replace(first, segments=first.segments[:3]),
        replace(first, segments=()),
        replace(first, joints=(), times_s=()),
    )
    for motion in spoiled:
        with pytest.raises(OrderRefused):
            build_order(bench.robot, tool_of(bench.robot), bench.map, execute, [motion, *others])
    with pytest.raises(OrderRefused):
        order_for(bench, start_joints=(0.0,) * 5)


def test_orders_whose_times_do_not_rise_are_refused() -> None:
    bench = make_bench()
    execute, motions = messages_of(plan_of_data_set_3())
    times = list(motions[0].times_s)
    times[5] = times[4]
    spoiled = [replace(motions[0], times_s=tuple(times)), *motions[1:]]
    with pytest.raises(UnsafeGoal):
        build_order(bench.robot, tool_of(bench.robot), bench.map, execute, spoiled)
