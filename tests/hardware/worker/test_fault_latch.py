"""Faults are kept, each once, in the order in which they came, until they are acknowledged."""

import logging

import pytest

from hardware.exceptions import (
    BusLost,
    CorruptPackets,
    FollowingError,
    HardwareError,
    PairDisagreement,
    ServoAlarm,
    ServoMissing,
)
from hardware.worker.fault_latch import FaultLatch


@pytest.fixture
def latch() -> FaultLatch:
    return FaultLatch()


def test_nothing_is_wrong_at_first(latch: FaultLatch) -> None:
    assert not latch
    assert (latch.failures, latch.codes) == ((), ())
    assert BusLost("gone") not in latch


def test_the_first_is_told_first_with_what_else_went_wrong(latch: FaultLatch) -> None:
    latch.latch(BusLost("gone"), ("the arm was not held", "the light is on"))
    latch.latch(ServoMissing(41, "does not answer"))
    assert latch
    assert latch.codes == ("bus_lost", "servo_missing")
    first, second = latch.failures
    assert first.detail == "gone; the arm was not held; the light is on"
    assert second.detail == "servo 41: does not answer"
    assert first.code == "bus_lost"
    assert first.at.endswith("Z")


@pytest.mark.parametrize(
    ("first", "again", "same"),
    [
        (BusLost("gone"), BusLost("gone again"), True),
        (ServoMissing(41, "a"), ServoMissing(41, "b"), True),
        (ServoMissing(41, "a"), ServoMissing(42, "a"), False),
        (ServoMissing(41, "a"), CorruptPackets(41, "a"), False),
        (ServoAlarm(41, ("overload",)), ServoAlarm(41, ("voltage",)), True),
        (PairDisagreement("joint_2", 0.1), PairDisagreement("joint_2", 0.2), True),
        (PairDisagreement("joint_2", 0.1), PairDisagreement("joint_3", 0.1), False),
        (FollowingError("joint_2", 0.1, "lags"), PairDisagreement("joint_2", 0.1), False),
    ],
)
def test_of_one_servo_or_joint_a_fault_is_kept_once(
    latch: FaultLatch, first: HardwareError, again: HardwareError, same: bool
) -> None:
    """Numbers in the text change from read to read."""
    latch.latch(first)
    assert (again in latch) == same
    latch.latch(again)
    assert [failure.detail for failure in latch.failures] == [
        first.detail,
        *([] if same else [again.detail]),
    ]


def test_each_is_in_the_log_once(latch: FaultLatch, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.ERROR):
        for _ in range(3):
            latch.latch(ServoMissing(41, "does not answer"), ("nor do others",))
    (record,) = caplog.records
    assert record.levelno == logging.ERROR
    assert record.getMessage() == "servo_missing: servo 41: does not answer; nor do others"


def test_what_was_acknowledged_may_come_again(latch: FaultLatch) -> None:
    latch.latch(BusLost("gone"))
    latch.clear()
    assert not latch
    latch.latch(BusLost("gone again"))
    assert [failure.detail for failure in latch.failures] == ["gone again"]
