"""The course of an order: segment by segment, tick by tick, and what the account says of it."""

import numpy as np
import pytest

from hardware.end_effector.end_effectors import OFF, ON
from hardware.exceptions import Canceled, FollowingError, OutsideLimits, ServoMissing, Stopped
from hardware.link.messages import (
    CANCELED,
    COMPLETED,
    DONE,
    EXECUTING,
    FAILED,
    NOT_STARTED,
    SKIPPED,
    UNKNOWN,
)
from hardware.tolerances import TICK_S
from solver import forward_kinematics
from tests.hardware.parts import Bench, goals_sent, make_bench
from tests.hardware.worker.runs import Run, make_run, tool_of
from tests.hardware.worker.short_orders import CUT_IN, STEP, TICKS, built, standby

HOME = np.array(make_bench().robot.home_joints)
FAR = np.array([1.5, -0.7, 0.9, -1.2, -1.0, 1.4])
RX_COUNT_RAD = np.radians(300 / 1023)


def short_run(bench: Bench | None = None, targets: int = 2) -> Run:
    bench = bench or make_bench(noise_ticks=0)
    return make_run(bench, built(bench, tool_of(bench.robot), targets=targets))


@pytest.fixture
def run() -> Run:
    return short_run()


@pytest.fixture(scope="module")
def finished() -> Run:
    run = short_run()
    run.finish()
    return run


def test_segments_follow_each_other_and_their_end_is_told(finished: Run) -> None:
    segments = [account.segment for account in finished.accounts]
    course = [b for a, b in zip([None, *segments], segments, strict=False) if a != b]
    thinned = ["transfer", "cut_in", "dwell", "retreat"]
    assert course == ["approach", *thinned, *thinned, None]
    assert finished.accounts[-1].status == COMPLETED
    assert {account.status for account in finished.accounts[:-1]} == {EXECUTING}
    assert {account.execution_id for account in finished.accounts} == {"e1"}


def test_only_changes_are_told(finished: Run) -> None:
    for before, after in zip(finished.accounts, finished.accounts[1:], strict=False):
        assert before != after


def test_a_target_is_told_step_by_step(finished: Run) -> None:
    """Executing, measured at the stand-by posture, measured at the peduncle, done, withdrawn."""
    course: list[tuple[str, bool, bool, str | None]] = []
    for account in finished.accounts:
        first = account.targets[0]
        step = (
            first.status,
            first.standby_error_m is not None,
            first.target_error_m is not None,
            account.segment,
        )
        if account.targets[1].status == NOT_STARTED and [step] != course[-1:]:
            course.append(step)
    assert course == [
        (NOT_STARTED, False, False, "approach"),
        (EXECUTING, False, False, "approach"),
        (EXECUTING, False, False, "transfer"),
        (EXECUTING, True, False, "transfer"),
        (EXECUTING, True, False, "cut_in"),
        (EXECUTING, True, True, "cut_in"),
        (EXECUTING, True, True, "dwell"),
        (DONE, True, True, "dwell"),
        (DONE, True, True, "retreat"),
    ]
    assert [target.target_id for target in finished.accounts[-1].targets] == ["t1", "t2"]


def test_segments_take_the_ticks_that_their_time_needs(finished: Run) -> None:
    """With the five reads of a measurement at the end of a transfer and of a cut-in."""
    ticks = [finished.segments.count(name) / 2 for name in ("transfer", "cut_in", "retreat")]
    assert ticks == [TICKS["transfer"] + 5, TICKS["cut_in"] + 5, TICKS["retreat"]]
    # A dwell of 0.15 s: at the end of its eighth tick it is over.
    assert finished.segments.count("dwell") == 2 * 8


def test_the_goals_are_on_the_planned_rows_and_reach_their_ends(finished: Run) -> None:
    goals = [
        finished.bench.map.joints({servo_id: goal for servo_id, (goal, _) in rows.items()})
        for rows in goals_sent(finished.bench.bus.sent)
    ]
    per_target = sum(TICKS.values())
    goals = goals[-2 * per_target :]
    for index in range(2):
        of_target = goals[index * per_target :][:per_target]
        here = standby(finished.bench.robot, index)
        for posture, planned in (
            (of_target[0], here - STEP + 0.6 * STEP * TICK_S / 0.08),
            (of_target[3], here - 0.4 * STEP),
            (of_target[5], here),
            (of_target[6], here + CUT_IN * TICK_S / 0.09),
            (of_target[10], here + CUT_IN),
            (of_target[11], here + 0.6 * CUT_IN),
            (of_target[13], here),
        ):
            assert posture == pytest.approx(planned, abs=RX_COUNT_RAD / 2 + 1e-9)


def test_it_ends_holding_at_the_last_standby_posture(finished: Run) -> None:
    assert finished.bench.arm.commanded == pytest.approx(standby(finished.bench.robot, 1))
    assert finished.bench.arm.torque == "on"


# --- The way to the start -------------------------------------------------------------------------
def test_the_way_to_the_start_is_at_a_quarter_of_the_limits() -> None:
    bench = make_bench(tuple(HOME + FAR), noise_ticks=0)
    run = short_run(bench)
    commanded = []
    while run.execution.account.segment in (None, "approach"):
        assert run.tick()
        commanded.append(bench.arm.commanded)
    ticks = np.array(commanded)
    ticks = ticks[: np.flatnonzero(np.abs(np.diff(ticks, axis=0)).max(axis=1) > 0)[-1] - 1]
    velocity = np.abs(np.diff(ticks, axis=0)) / TICK_S
    acceleration = np.abs(np.diff(ticks, 2, axis=0)) / TICK_S**2
    limits = np.array([joint.acceleration for joint in bench.robot.joints])
    share = (velocity / bench.robot.velocity).max()
    assert share == pytest.approx(0.25, rel=0.03)
    assert (acceleration / limits).max() == pytest.approx(0.25, rel=0.25)


def test_an_arm_that_is_elsewhere_goes_to_the_start_first() -> None:
    bench = make_bench(tuple(HOME + 0.2 * np.sign(STEP)), noise_ticks=0)
    run = short_run(bench)
    run.until("transfer")
    ways = goals_sent(bench.bus.sent)
    start = bench.map.joints({servo_id: goal for servo_id, (goal, _) in ways[-2].items()})
    assert start == pytest.approx(HOME, abs=RX_COUNT_RAD / 2 + 1e-9)
    assert run.segments.count("approach") > 20


def test_nothing_moves_where_the_arm_may_not_be() -> None:
    home = list(HOME)
    home[1] = 1.9
    bench = make_bench(tuple(home))
    run = short_run(bench)
    with pytest.raises(OutsideLimits) as caught:
        run.tick()
    run.execution.end(caught.value)
    assert goals_sent(bench.bus.sent) == []
    # It was told to be under way before the servos were asked for anything.
    course = [(account.status, account.segment) for account in run.accounts]
    assert course == [(EXECUTING, "approach"), (FAILED, None)]


# --- Arrival --------------------------------------------------------------------------------------
@pytest.mark.parametrize("segment", ["approach", "transfer", "cut_in", "retreat"])
def test_a_joint_that_does_not_arrive_in_two_seconds_ends_it(segment: str) -> None:
    """After the way to the start, before each measurement and at the very end."""
    bench = make_bench(tuple(HOME + 0.1 * np.sign(STEP)), noise_ticks=0)
    run = short_run(bench, targets=1)
    run.until(segment, 1)
    bench.fault("slip 41 10")
    goals: list[np.ndarray] = []

    def to_the_end() -> None:
        while run.tick():
            goals.append(bench.arm.commanded)

    with pytest.raises(FollowingError, match="joint_4: did not arrive"):
        to_the_end()
    ticks = sum((goal == goals[-1]).all() for goal in goals) - 1
    assert ticks * TICK_S == pytest.approx(2.0)


@pytest.mark.parametrize("segment", ["approach", "transfer", "cut_in", "retreat"])
def test_a_joint_that_arrives_late_is_waited_for(segment: str) -> None:
    bench = make_bench(tuple(HOME + 0.1 * np.sign(STEP)), noise_ticks=0)
    run = short_run(bench, targets=1)
    run.until(segment, 2)
    bench.fault("slip 41 10")
    for _ in range(60):
        assert run.tick()
    assert run.execution.account.segment == segment
    bench.fault("slip 41 0")
    run.finish()
    (target,) = run.execution.account.targets
    for measured, planned in (
        (target.measured_standby_joints, standby(bench.robot, 0)),
        (target.measured_thinning_joints, standby(bench.robot, 0) + CUT_IN),
    ):
        assert measured == pytest.approx(planned, abs=RX_COUNT_RAD)


def test_a_measurement_is_the_mean_of_five_reads_a_tick_each(run: Run) -> None:
    reads: list[np.ndarray] = []
    ticks: list[int] = []

    def read_joints() -> np.ndarray:
        ticks.append(len(run.segments))
        reads.append(HOME + 0.01 * len(reads) ** 2)
        return reads[-1]

    run.bench.arm.read_joints = read_joints  # type: ignore[method-assign]
    while run.execution.account.targets[0].standby_error_m is None:
        assert run.tick()
    assert np.diff(ticks).tolist() == [1] * 4
    measured = run.execution.account.targets[0].measured_standby_joints
    assert measured == pytest.approx(HOME + 0.01 * (0 + 1 + 4 + 9 + 16) / 5)


def test_an_error_is_how_far_the_tool_is_from_where_it_is_due(finished: Run) -> None:
    robot = finished.bench.robot
    for index, target in enumerate(finished.execution.account.targets):
        here = standby(robot, index)
        for measured, planned, error_m in (
            (target.measured_standby_joints, here, target.standby_error_m),
            (target.measured_thinning_joints, here + CUT_IN, target.target_error_m),
        ):
            poses = forward_kinematics(robot, tool_of(robot), np.array([measured, planned]))
            apart = np.sqrt(np.sum((poses[0, :3, 3] - poses[1, :3, 3]) ** 2))
            assert error_m == pytest.approx(apart, abs=1e-12)
            assert 0 < apart < 0.002


# --- The end that is none -------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("segment", "target", "expected"),
    [
        ("approach", 0, [NOT_STARTED, NOT_STARTED]),
        ("transfer", 0, [SKIPPED, NOT_STARTED]),
        ("cut_in", 0, [SKIPPED, NOT_STARTED]),
        ("dwell", 0, [UNKNOWN, NOT_STARTED]),
        ("retreat", 0, [DONE, NOT_STARTED]),
        ("transfer", 1, [DONE, SKIPPED]),
        ("dwell", 1, [DONE, UNKNOWN]),
    ],
)
def test_what_became_of_each_target_when_it_fails(
    segment: str, target: int, expected: list[str]
) -> None:
    run = short_run()
    for _ in range(target):
        run.until("dwell")
        run.until("retreat")
    run.until(segment, 1)
    run.execution.end(ServoMissing(41, "does not answer"))
    account = run.execution.account
    assert account.status == FAILED
    assert account.segment is None
    assert account.error is not None
    assert (account.error.code, account.error.detail) == (
        "servo_missing",
        "servo 41: does not answer",
    )
    assert account.error.at.endswith("Z")
    assert [one.status for one in account.targets] == expected
    for one in account.targets:
        assert one.error == (account.error if one.status in (SKIPPED, UNKNOWN) else None)
    assert run.accounts[-1] == account


def test_what_is_done_stays_done_when_the_rest_fails() -> None:
    run = short_run()
    run.until("retreat")
    run.execution.end(ServoMissing(41, "does not answer"))
    first, second = run.execution.account.targets
    assert (first.status, first.error) == (DONE, None)
    assert (second.status, second.error) == (NOT_STARTED, None)


def test_only_a_cancel_is_canceled() -> None:
    for error, status in ((Canceled("on request"), CANCELED), (Stopped("on request"), FAILED)):
        run = short_run()
        run.execution.end(error)
        assert run.execution.account.status == status


def test_the_end_effector_is_off_but_for_the_dwells(finished: Run) -> None:
    assert finished.end_effector.changes == [("dwell", ON), ("dwell", OFF)] * 2
