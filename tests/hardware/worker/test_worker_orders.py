"""Orders and their steering: what begins, what is refused and why, and whom a word reaches."""

from dataclasses import replace
from pathlib import Path

import pytest

from hardware.exceptions import EndEffectorFailed
from hardware.link.messages import (
    CANCELED,
    COMPLETED,
    DONE,
    EXECUTING,
    FAILED,
    PAUSED,
    Cancel,
    Pause,
    Resume,
)
from tests.hardware.parts import goals_sent, make_bench
from tests.hardware.worker.scenes import Scene, make_scene
from tests.hardware.worker.short_orders import short_messages

LONG_S = 4.0
"""An order of two targets is done by then."""


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    return make_scene(tmp_path, make_bench(noise_ticks=0))


# --- Orders ---------------------------------------------------------------------------------------
def test_an_order_begins_when_all_of_it_is_there(scene: Scene) -> None:
    execute, motions = short_messages(scene.bench.robot)
    scene.link.at(0.5, execute)
    scene.link.at(1.0, motions[0])
    scene.link.at(1.5, lambda: events_before.extend(goals_sent(scene.bench.bus.sent)))
    scene.link.at(1.5, motions[1])
    events_before: list[object] = []
    scene.run(1.5 + LONG_S)
    assert events_before == []
    assert scene.accounts()[-1].status == COMPLETED
    assert [target.status for target in scene.accounts()[-1].targets] == [DONE, DONE]


def test_what_begins_and_ends_is_in_the_journal(scene: Scene) -> None:
    scene.short_order(0.5, "e1", 1)
    scene.short_order(4.0, "e2", 1)
    scene.link.at(4.5, Cancel("e2"))
    scene.run(6.0)
    assert scene.journaled() == ["started", COMPLETED, "started", CANCELED]
    assert scene.journal.unfinished == set()


def test_executions_follow_each_other(scene: Scene) -> None:
    scene.short_order(0.5, "e1", 1)
    scene.short_order(4.0, "e2", 1)
    scene.run(8.0)
    assert scene.ends() == {"e1": COMPLETED, "e2": COMPLETED}


def test_a_motion_without_an_order_is_nothing(scene: Scene) -> None:
    _, motions = short_messages(scene.bench.robot)
    scene.at_once(0.5, motions)
    scene.run(1.5)
    assert scene.accounts() == []
    assert scene.faults() == []


def test_an_order_takes_the_place_of_one_that_never_was_whole(scene: Scene) -> None:
    execute, motions = short_messages(scene.bench.robot, "e1")
    scene.at_once(0.5, (execute, motions[0]))
    scene.short_order(1.0, "e2", 1)
    scene.run(1.0 + LONG_S)
    assert scene.ends() == {"e2": COMPLETED}


def test_an_order_that_was_refused_leaves_no_trace_and_may_come_again(scene: Scene) -> None:
    execute, (motion,) = short_messages(scene.bench.robot, "e1", 1)
    scene.at_once(0.5, (execute, replace(motion, index=1)))
    scene.short_order(1.0, "e1", 1)
    scene.run(1.0 + LONG_S)
    first, *_, last = scene.accounts()
    assert (first.status, first.targets) == (FAILED, ())
    assert first.error is not None
    assert first.error.code == "order_refused"
    assert first.error.at.endswith("Z")
    assert last.status == COMPLETED
    assert scene.journaled() == ["started", COMPLETED]


def test_a_second_order_is_refused_and_told_why(scene: Scene) -> None:
    scene.short_order(0.5, "e1")
    scene.short_order(0.8, "e2")
    scene.run(0.8 + LONG_S)
    assert scene.ends() == {"e1": COMPLETED, "e2": FAILED}
    assert scene.reasons() == {"e2": "another execution is under way"}


def test_an_order_over_a_fault_is_refused_with_its_code(scene: Scene) -> None:
    scene.link.at(0.2, "voltage 61")
    scene.link.at(0.8, "missing 41")
    scene.short_order(1.5)
    scene.run(2.0)
    assert scene.reasons() == {"e1": "faults to acknowledge: servo_alarm, servo_missing"}
    assert goals_sent(scene.bench.bus.sent) == []


# --- Steering -------------------------------------------------------------------------------------
def test_pause_and_resume_reach_the_execution(scene: Scene) -> None:
    scene.short_order()
    scene.link.at(0.8, Pause("e1"))
    scene.link.at(2.0, Resume("e1"))
    scene.run(2.0 + LONG_S)
    statuses = [said.status for said in scene.telemetry()]
    course = [b for a, b in zip([None, *statuses], statuses, strict=False) if a != b]
    assert course == ["idle", EXECUTING, PAUSED, EXECUTING, "idle"]


@pytest.mark.parametrize("message", [Pause("e9"), Resume("e9"), Cancel("e9")])
def test_steering_reaches_only_the_execution_that_it_names(
    scene: Scene, message: Pause | Resume | Cancel
) -> None:
    scene.link.at(0.2, message)
    scene.short_order()
    scene.link.at(0.8, message)
    scene.run(LONG_S + 1.0)
    assert scene.ends() == {"e1": COMPLETED}
    assert PAUSED not in {account.status for account in scene.accounts()}


def test_an_order_that_is_not_whole_yet_can_be_canceled(scene: Scene) -> None:
    execute, motions = short_messages(scene.bench.robot)
    scene.at_once(0.5, (execute, motions[0]))
    scene.link.at(0.6, Pause("e1"))
    scene.link.at(0.7, Resume("e1"))
    scene.link.at(1.0, Cancel("e1"))
    scene.link.at(1.1, motions[1])
    scene.short_order(2.0, "e2", 1)
    scene.run(2.0 + LONG_S)
    first, *_ = scene.accounts()
    assert (first.execution_id, first.status) == ("e1", CANCELED)
    assert first.error is not None
    assert (first.error.code, first.error.detail) == ("canceled", "canceled before it began")
    assert scene.ends() == {"e1": CANCELED, "e2": COMPLETED}


def test_while_an_order_comes_the_one_under_way_can_be_steered(scene: Scene) -> None:
    scene.short_order(0.5, "e1")
    execute, motions = short_messages(scene.bench.robot, "e2")
    scene.at_once(0.7, (execute, motions[0]))
    scene.link.at(0.8, Pause("e2"))
    scene.link.at(0.9, Cancel("e1"))
    scene.run(2.5)
    assert scene.ends() == {"e1": CANCELED}


def test_a_cancel_is_no_fault_unless_something_goes_wrong_with_it(scene: Scene) -> None:
    scene.short_order(0.5, "e1")
    scene.link.at(0.7, Cancel("e1"))
    scene.run(2.0)
    assert scene.ends() == {"e1": CANCELED}
    assert scene.faults() == []


def test_a_cancel_after_which_the_end_effector_is_not_off_is_a_fault(scene: Scene) -> None:
    def switch(*, on: bool) -> None:
        raise EndEffectorFailed("it does not go off")

    scene.short_order(0.5, "e1")
    scene.link.at(0.7, Cancel("e1"))
    scene.link.at(0.8, lambda: setattr(scene.end_effector, "switch", switch))
    scene.run(2.0)
    assert scene.ends() == {"e1": CANCELED}
    (fault,) = scene.telemetry()[-1].faults
    assert fault.code == "canceled"
    assert "it does not go off" in fault.detail
