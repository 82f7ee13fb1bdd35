"""Orders, steering, stops and acknowledgements: what each does, and what is said in which order."""

from pathlib import Path

import pytest

from hardware.exceptions import EndEffectorFailed, PortUnavailable
from hardware.link.messages import (
    CANCELED,
    COMPLETED,
    DONE,
    EXECUTING,
    FAILED,
    PAUSED,
    Acknowledge,
    AcknowledgeReport,
    Cancel,
    ExecutionAccount,
    Pause,
    Resume,
    Stop,
    StopReport,
    Telemetry,
)
from hardware.worker.journal import Journal
from tests.hardware.parts import goals_sent, make_bench, told
from tests.hardware.worker.scenes import Scene, make_scene
from tests.hardware.worker.short_orders import short_messages

LONG_S = 4.0
"""An order of two targets is done by then."""


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    return make_scene(tmp_path, make_bench(noise_ticks=0))


def ends(scene: Scene) -> dict[str, str]:
    """How each execution stands, by its id."""
    return {account.execution_id: account.status for account in scene.accounts()}


def reasons(scene: Scene) -> dict[str, str]:
    return {one.execution_id: one.error.detail for one in scene.accounts() if one.error}


def events(journal: Path) -> list[str]:
    return [line.split('"event":')[1].strip('"}') for line in journal.read_text().splitlines()]


def reports(scene: Scene) -> list[AcknowledgeReport]:
    return [said for said in scene.link.said if isinstance(said, AcknowledgeReport)]


def state_before(scene: Scene, kind: type) -> Telemetry:
    """What was said just before the first message of a kind."""
    at = next(k for k, said in enumerate(scene.link.said) if isinstance(said, kind))
    state = scene.link.said[at - 1]
    assert isinstance(state, Telemetry)
    return state


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


def test_what_begins_and_ends_is_in_the_journal(scene: Scene, tmp_path: Path) -> None:
    scene.short_order(0.5, "e1", 1)
    scene.short_order(4.0, "e2", 1)
    scene.link.at(4.5, Cancel("e2"))
    scene.run(6.0)
    assert events(tmp_path / "worker.journal") == ["started", COMPLETED, "started", CANCELED]
    assert scene.journal.unfinished == set()


def test_executions_follow_each_other(scene: Scene) -> None:
    scene.short_order(0.5, "e1", 1)
    scene.short_order(4.0, "e2", 1)
    scene.run(8.0)
    assert ends(scene) == {"e1": COMPLETED, "e2": COMPLETED}


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
    assert ends(scene) == {"e2": COMPLETED}


def test_an_order_that_was_refused_leaves_no_trace_and_may_come_again(
    scene: Scene, tmp_path: Path
) -> None:
    execute, (motion,) = short_messages(scene.bench.robot, "e1", 1)
    scene.at_once(0.5, (execute, type(motion)(**{**vars(motion), "index": 1})))
    scene.short_order(1.0, "e1", 1)
    scene.run(1.0 + LONG_S)
    first, *_, last = scene.accounts()
    assert (first.status, first.targets) == (FAILED, ())
    assert first.error is not None
    assert first.error.code == "order_refused"
    assert first.error.at.endswith("Z")
    assert last.status == COMPLETED
    assert events(tmp_path / "worker.journal") == ["started", COMPLETED]


def test_a_second_order_is_refused_and_told_why(scene: Scene) -> None:
    scene.short_order(0.5, "e1")
    scene.short_order(0.8, "e2")
    scene.run(0.8 + LONG_S)
    assert ends(scene) == {"e1": COMPLETED, "e2": FAILED}
    assert reasons(scene) == {"e2": "another execution is under way"}


def test_an_order_over_a_fault_is_refused_with_its_code(scene: Scene) -> None:
    scene.link.at(0.2, "voltage 61")
    scene.link.at(0.8, "missing 41")
    scene.short_order(1.5)
    scene.run(2.0)
    assert reasons(scene) == {"e1": "faults to acknowledge: servo_alarm, servo_missing"}
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
    assert ends(scene) == {"e1": COMPLETED}
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
    assert ends(scene) == {"e1": CANCELED, "e2": COMPLETED}


def test_while_an_order_comes_the_one_under_way_can_be_steered(scene: Scene) -> None:
    scene.short_order(0.5, "e1")
    execute, motions = short_messages(scene.bench.robot, "e2")
    scene.at_once(0.7, (execute, motions[0]))
    scene.link.at(0.8, Pause("e2"))
    scene.link.at(0.9, Cancel("e1"))
    scene.run(2.5)
    assert ends(scene) == {"e1": CANCELED}


def test_a_cancel_is_no_fault_unless_something_goes_wrong_with_it(scene: Scene) -> None:
    scene.short_order(0.5, "e1")
    scene.link.at(0.7, Cancel("e1"))
    scene.run(2.0)
    assert ends(scene) == {"e1": CANCELED}
    assert scene.faults() == []


def test_a_cancel_after_which_the_end_effector_is_not_off_is_a_fault(scene: Scene) -> None:
    def switch(*, on: bool) -> None:
        raise EndEffectorFailed("it does not go off")

    scene.short_order(0.5, "e1")
    scene.link.at(0.7, Cancel("e1"))
    scene.link.at(0.8, lambda: setattr(scene.end_effector, "switch", switch))
    scene.run(2.0)
    assert ends(scene) == {"e1": CANCELED}
    (fault,) = scene.telemetry()[-1].faults
    assert fault.code == "canceled"
    assert "it does not go off" in fault.detail


# --- Stops ----------------------------------------------------------------------------------------
def test_a_stop_is_answered_after_the_state_that_it_led_to(scene: Scene) -> None:
    scene.short_order()
    scene.link.at(0.8, Stop("s1"))
    scene.run(1.5)
    state = state_before(scene, StopReport)
    assert state.status == "fault"
    assert [(fault.code, fault.detail) for fault in state.faults] == [
        ("stopped", "stopped on request")
    ]
    assert state.execution_id is None
    account = scene.accounts()[-1]
    assert account.status == FAILED
    assert account.error is not None
    assert (account.error.code, account.error.detail) == ("stopped", "stopped on request")
    assert scene.end_effector.switched[-1] == "off"
    assert scene.journal.unfinished == set()


def test_a_stop_refuses_an_order_that_is_not_whole_yet(scene: Scene) -> None:
    execute, motions = short_messages(scene.bench.robot)
    scene.at_once(0.5, (execute, motions[0]))
    scene.link.at(0.8, Stop("s1"))
    scene.link.at(0.9, motions[1])
    scene.run(1.5)
    (account,) = scene.accounts()
    assert (account.execution_id, account.status) == ("e1", FAILED)
    assert account.error is not None
    assert account.error.code == "stopped"


def test_a_stop_tells_what_else_went_wrong(scene: Scene) -> None:
    scene.short_order()
    scene.link.at(0.8, lambda: setattr(scene.end_effector, "gone", True))
    scene.link.at(0.8, Stop("s1"))
    scene.run(1.5)
    (fault,) = scene.telemetry()[-1].faults
    assert fault.detail == "stopped on request; it is gone; another guard switched it off"
    (report,) = scene.stop_reports()
    assert (report.stopped, report.verified) == (True, False)


# --- Faults and acknowledgements ------------------------------------------------------------------
def test_a_fault_ends_what_runs_before_it_is_told(scene: Scene) -> None:
    scene.short_order()
    scene.link.at(0.8, "missing 41")
    scene.run(1.5)
    account = scene.accounts()[-1]
    at = scene.link.said.index(account)
    state = scene.link.said[at - 1]
    assert isinstance(state, Telemetry)
    assert (state.status, state.execution_id) == ("fault", None)
    assert [fault.code for fault in state.faults] == ["servo_missing"]


def test_a_fault_on_a_fault_is_told_and_held_no_second_time(scene: Scene) -> None:
    scene.bench.arm.enable_torque()
    scene.link.at(0.5, "voltage 41")
    scene.link.at(1.5, scene.bench.bus.sent.clear)
    scene.link.at(1.5, "voltage 51")
    scene.run(2.5)
    assert scene.faults() == ["servo_alarm", "servo_alarm"]
    assert goals_sent(scene.bench.bus.sent) == []


def test_an_acknowledgement_is_answered_after_the_state_that_it_led_to(scene: Scene) -> None:
    scene.link.at(0.2, "voltage 61")
    scene.link.at(0.8, "heal")
    scene.link.at(1.0, Acknowledge("a1"))
    scene.run(1.5)
    assert reports(scene) == [AcknowledgeReport("a1", ())]
    assert (state_before(scene, AcknowledgeReport).status, scene.faults()) == ("idle", [])


def test_an_acknowledgement_while_it_moves_changes_nothing(scene: Scene) -> None:
    scene.short_order()
    scene.link.at(0.8, scene.bench.bus.sent.clear)
    scene.link.at(0.8, Acknowledge("a1"))
    scene.run(LONG_S)
    assert reports(scene) == [AcknowledgeReport("a1", ())]
    assert scene.accounts()[-1].status == COMPLETED
    assert state_before(scene, AcknowledgeReport).status == EXECUTING
    # In the middle of a motion servos are not checked anew: nobody reads their models.
    assert 0 not in {sent.address for sent in told(scene.bench.bus.sent)}


def test_what_an_earlier_worker_left_is_ended_by_acknowledging(tmp_path: Path) -> None:
    Journal(tmp_path / "worker.journal").start("e0")
    scene = make_scene(tmp_path)
    scene.link.at(0.5, Acknowledge("a1"))
    scene.run(1.0)
    assert reports(scene) == [AcknowledgeReport("a1", ())]
    assert events(tmp_path / "worker.journal") == ["started", "interrupted"]
    assert Journal(tmp_path / "worker.journal").unfinished == set()


def test_without_a_journal_an_acknowledgement_clears_nothing(tmp_path: Path) -> None:
    file = tmp_path / "worker.journal"
    Journal(file).start("e0")
    scene = make_scene(tmp_path)

    def spoil() -> None:
        file.unlink()
        file.mkdir()

    scene.link.at(0.5, spoil)
    scene.link.at(0.5, Acknowledge("a1"))
    scene.run(1.0)
    assert [fault.code for fault in reports(scene)[0].faults] == ["journal_failed", "interrupted"]


def test_an_end_that_cannot_be_noted_is_a_fault(scene: Scene, tmp_path: Path) -> None:
    file = tmp_path / "worker.journal"

    def spoil() -> None:
        file.unlink()
        file.mkdir()

    scene.short_order(targets=1)
    scene.link.at(0.8, spoil)
    scene.run(LONG_S)
    assert scene.accounts()[-1].status == COMPLETED
    assert scene.faults() == ["journal_failed"]


def test_a_lost_link_ends_a_motion_and_in_idle_nothing(scene: Scene) -> None:
    scene.link.at(0.1, "lose")
    scene.link.at(0.3, "find")
    scene.short_order()
    scene.link.at(0.8, "lose")
    scene.run(1.5)
    assert ends(scene) == {"e1": FAILED}
    assert reasons(scene) == {"e1": "the service was not heard any more"}
    assert scene.faults() == ["link_lost"]


# --- A bus that is lost ---------------------------------------------------------------------------
def test_a_lost_bus_is_left_alone_until_it_is_acknowledged(scene: Scene) -> None:
    asked: list[int] = []
    real = scene.bench.bus.read

    def read(servo_id: int, address: int, size: int) -> object:
        asked.append(servo_id)
        return real(servo_id, address, size)

    scene.bench.bus.read = read  # type: ignore[method-assign, assignment]
    scene.link.at(0.5, "unplug")
    scene.link.at(1.0, asked.clear)
    scene.link.at(2.0, lambda: quiet.append(len(asked)))
    scene.link.at(2.0, Acknowledge("a1"))
    quiet: list[int] = []
    scene.run(3.0)
    assert quiet == [0]
    assert reports(scene) == [AcknowledgeReport("a1", ())]
    # The servos were checked after it was opened, and are polled again.
    assert len(asked) > 60
    assert scene.telemetry()[-1].torque == "off"


def test_a_bus_that_cannot_be_opened_again_is_told_and_not_asked(scene: Scene) -> None:
    def reopen() -> None:
        raise PortUnavailable("the device is gone")

    scene.bench.bus.reopen = reopen  # type: ignore[method-assign]
    scene.link.at(0.5, "unplug")
    scene.link.at(1.0, Acknowledge("a1"))
    scene.run(2.0)
    (report,) = reports(scene)
    assert [(fault.code, fault.detail) for fault in report.faults] == [
        ("port_unavailable", "the device is gone")
    ]
    assert scene.faults() == ["port_unavailable"]


def test_servos_that_are_wrong_behind_a_bus_that_came_back_are_told(scene: Scene) -> None:
    scene.link.at(0.5, "unplug")
    scene.link.at(1.0, lambda: scene.bench.servo(51).table.__setitem__("torque_limit", 0))
    scene.link.at(1.0, Acknowledge("a1"))
    scene.run(2.0)
    (report,) = reports(scene)
    assert [fault.code for fault in report.faults] == ["wrong_setting"]
    assert "servo 51" in report.faults[0].detail


def test_wrong_servos_are_told_by_acknowledging_and_only_read(scene: Scene) -> None:
    scene.bench.servo(51).table["torque_limit"] = 0
    scene.link.at(1.0, Acknowledge("a1"))
    scene.run(1.5)
    (report,) = reports(scene)
    assert [fault.code for fault in report.faults] == ["wrong_setting"]
    assert {sent.instruction for sent in told(scene.bench.bus.sent)} == {2}
    assert [said for said in scene.link.said if isinstance(said, ExecutionAccount)] == []
