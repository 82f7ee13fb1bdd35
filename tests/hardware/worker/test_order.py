"""What an order has to be before anything moves, and what it says at each instant."""

from dataclasses import replace

import numpy as np
import pytest

from hardware.exceptions import OrderRefused, UnsafeGoal
from hardware.link.messages import SegmentTimes, TargetMotion
from hardware.worker.order import Order, Segment
from tests.hardware.parts import make_bench
from tests.hardware.worker.runs import tool_of
from tests.hardware.worker.short_orders import CUT_IN, STEP, built, short_motion, standby

BENCH = make_bench()
ROBOT = BENCH.robot
HOME = np.array(ROBOT.home_joints)


def order(*motions: TargetMotion, **changes: object) -> Order:
    """The order with these motions, or with its own two."""
    own = list(motions) or [short_motion(ROBOT, 0), short_motion(ROBOT, 1)]
    changes = {"target_count": len(own), **changes}
    return built(BENCH, tool_of(ROBOT), motions=own, changes=changes)


def moved(motion: TargetMotion, row: int, by: float) -> TargetMotion:
    """With one row off in joint 4."""
    rows = [np.array(values) for values in motion.joints]
    rows[row] = rows[row] + by * np.eye(6)[3]
    return replace(motion, joints=tuple(tuple(values.tolist()) for values in rows))


# --- What is in it --------------------------------------------------------------------------------
def test_an_order_is_what_the_messages_say() -> None:
    it = order()
    assert it.execution_id == "e1"
    assert it.start == pytest.approx(HOME)
    assert [target.target_id for target in it.targets] == ["t1", "t2"]
    for index, target in enumerate(it.targets):
        here = standby(ROBOT, index)
        assert target.standby == pytest.approx(here)
        assert target.thinning == pytest.approx(here + CUT_IN)
        names = [segment.name for segment in target.segments]
        assert names == ["transfer", "cut_in", "dwell", "retreat"]


def test_segments_begin_at_zero_and_share_the_rows_where_they_join() -> None:
    (target, _) = order().targets
    here = standby(ROBOT, 0)
    times = [time for segment in target.segments for time in segment.times_s.tolist()]
    assert times == pytest.approx([0, 0.08, 0.11, 0, 0.09, 0, 0.15, 0, 0.05])
    ends = [(segment.rows[0], segment.rows[-1]) for segment in target.segments]
    expected = [
        (here - STEP, here),
        (here, here + CUT_IN),
        (here + CUT_IN, here + CUT_IN),
        (here + CUT_IN, here),
    ]
    for (first, last), (begins, finishes) in zip(ends, expected, strict=True):
        assert first == pytest.approx(begins)
        assert last == pytest.approx(finishes)
    durations = [segment.duration_s for segment in target.segments]
    assert durations == pytest.approx([0.11, 0.09, 0.15, 0.05])


def test_between_rows_postures_are_linear() -> None:
    rows = np.array([[0.0, 1.0], [1.0, 0.0], [1.0, -3.0]])
    segment = Segment("transfer", np.array([0.0, 0.5, 1.5]), rows)
    for time_s, expected in (
        (0.0, [0, 1]),
        (0.25, [0.5, 0.5]),
        (0.5, [1, 0]),
        (0.75, [1, -0.75]),
        (1.5, [1, -3]),
    ):
        assert segment.posture(time_s) == pytest.approx(expected)


# --- What it has to be ----------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"model_version": "another"}, "another version of the robot's model"),
        ({"tool": "scaffold"}, "the plan is for the tool scaffold, mounted is laser"),
        ({"target_count": 1}, "a target's motion is missing"),
        ({"target_count": 3}, "a target's motion is missing"),
        ({"start_joints": (0.0,) * 5}, "the start needs 6 joints"),
        ({"start_joints": (0.0,) * 7}, "the start needs 6 joints"),
    ],
)
def test_what_does_not_fit_the_arm_is_refused_and_told(
    changes: dict[str, object], said: str
) -> None:
    order()
    with pytest.raises(OrderRefused, match=said):
        order(**changes)


def test_motions_come_in_order_each_once() -> None:
    first, second = short_motion(ROBOT, 0), short_motion(ROBOT, 1)
    for motions in ((second, first), (first, first), (second, second), (replace(first, index=1),)):
        with pytest.raises(OrderRefused, match="motion is missing"):
            order(*motions)


def test_rows_have_as_many_joints_as_the_arm() -> None:
    motion = short_motion(ROBOT, 0)
    for count in (5, 7):
        values = (0.0,) * count
        for changed in (
            replace(motion, standby_joints=values),
            replace(motion, thinning_joints=values),
            replace(motion, joints=(*motion.joints[:-1], values)),
        ):
            with pytest.raises(OrderRefused, match="target t1: rows need 6 joints"):
                order(changed)


def test_there_is_a_time_for_each_row() -> None:
    motion = short_motion(ROBOT, 0)
    for times in (motion.times_s[:-1], (*motion.times_s, 9.0)):
        with pytest.raises(OrderRefused, match="target t1: rows and times differ in number"):
            order(replace(motion, times_s=times))


@pytest.mark.parametrize(
    "names",
    [
        ("transfer", "cut_in", "dwell"),
        ("transfer", "cut_in", "dwell", "retreat", "retreat"),
        ("transfer", "cut_in", "retreat", "dwell"),
        ("approach", "cut_in", "dwell", "retreat"),
        ("transfer", "zigzag", "dwell", "retreat"),
        (),
    ],
)
def test_a_motion_has_the_four_segments_in_order(names: tuple[str, ...]) -> None:
    motion = short_motion(ROBOT, 0)
    padded = (*motion.segments, motion.segments[-1])
    parts = tuple(replace(part, name=name) for part, name in zip(padded, names, strict=False))
    with pytest.raises(OrderRefused, match="target t1: the motion has other segments"):
        order(replace(motion, segments=parts))


@pytest.mark.parametrize(("start_s", "end_s"), [(0.12, 0.19), (0.5, 0.6), (0.2, 0.11)])
def test_a_segment_has_rows(start_s: float, end_s: float) -> None:
    motion = short_motion(ROBOT, 0)
    transfer, _, *rest = motion.segments
    empty = SegmentTimes("cut_in", start_s, end_s)
    with pytest.raises(OrderRefused, match="target t1: cut_in has no rows"):
        order(replace(motion, segments=(transfer, empty, *rest)))


# --- Without a gap --------------------------------------------------------------------------------
def test_the_first_row_is_the_start() -> None:
    for by, joins in ((0.9e-6, True), (-0.9e-6, True), (1.1e-6, False), (-1.1e-6, False)):
        motion = moved(short_motion(ROBOT, 0), 0, by)
        if joins:
            order(motion)
            continue
        with pytest.raises(OrderRefused, match="target t1: transfer begins elsewhere"):
            order(motion)


def test_a_target_begins_where_the_one_before_ended() -> None:
    first, second = short_motion(ROBOT, 0), short_motion(ROBOT, 1)
    order(first, moved(second, 0, 0.9e-6))
    with pytest.raises(OrderRefused, match="target t2: transfer begins elsewhere"):
        order(first, moved(second, 0, 1e-4))
    with pytest.raises(OrderRefused, match="target t2: transfer begins elsewhere"):
        order(moved(first, 5, 1e-4), second)


def test_a_segment_begins_where_the_one_before_ended() -> None:
    """Segments that leave out the rows between them."""
    motion = short_motion(ROBOT, 0)
    rows = list(motion.joints)
    rows.insert(3, tuple((np.array(rows[2]) + 1e-4).tolist()))
    times = (0.0, 0.08, 0.11, 0.112, 0.2, 0.35, 0.4)
    transfer, _, *rest = motion.segments
    cut_in = SegmentTimes("cut_in", 0.112, 0.2)
    gap = replace(motion, joints=tuple(rows), times_s=times, segments=(transfer, cut_in, *rest))
    with pytest.raises(OrderRefused, match="target t1: cut_in begins elsewhere"):
        order(gap)


# --- Safe, all of it ------------------------------------------------------------------------------
@pytest.mark.parametrize("row", range(6))
def test_every_row_is_checked_before_anything_moves(row: int) -> None:
    with pytest.raises(UnsafeGoal, match="joint_4"):
        order(moved(short_motion(ROBOT, 0), row, 3.0))


@pytest.mark.parametrize("row", [1, 2, 3, 4, 5])
def test_times_rise_from_row_to_row(row: int) -> None:
    motion = short_motion(ROBOT, 0)
    times = list(motion.times_s)
    times[row] = times[row - 1]
    own = tuple(SegmentTimes(part.name, part.start_s, part.end_s) for part in motion.segments)
    with pytest.raises((UnsafeGoal, OrderRefused)):
        order(replace(motion, times_s=tuple(times), segments=own))


def test_a_step_that_is_too_fast_in_one_segment_is_refused() -> None:
    motion = short_motion(ROBOT, 0)
    times = (0.0, 0.08, 0.11, 0.115, 0.35, 0.4)
    transfer, _, _, retreat = motion.segments
    quick = (transfer, SegmentTimes("cut_in", 0.11, 0.115), SegmentTimes("dwell", 0.115, 0.35))
    with pytest.raises(UnsafeGoal, match=r"joint_2: a step of 0\.0300 rad is too fast"):
        order(replace(motion, times_s=times, segments=(*quick, retreat)))
