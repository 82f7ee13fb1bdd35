"""Stops, faults and acknowledgements: what each does, and what is said in which order."""

from pathlib import Path

import pytest

from hardware.exceptions import PortUnavailable
from hardware.link.messages import (
    COMPLETED,
    EXECUTING,
    FAILED,
    Acknowledge,
    AcknowledgeReport,
    ExecutionAccount,
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


# --- Stops ----------------------------------------------------------------------------------------
def test_a_stop_is_answered_after_the_state_that_it_led_to(scene: Scene) -> None:
    scene.short_order()
    scene.link.at(0.8, Stop("s1"))
    scene.run(1.5)
    state = scene.state_before(StopReport)
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
    assert scene.acknowledge_reports() == [AcknowledgeReport("a1", ())]
    assert (scene.state_before(AcknowledgeReport).status, scene.faults()) == ("idle", [])


def test_an_acknowledgement_while_it_moves_changes_nothing(scene: Scene) -> None:
    scene.short_order()
    scene.link.at(0.8, scene.bench.bus.sent.clear)
    scene.link.at(0.8, Acknowledge("a1"))
    scene.run(LONG_S)
    assert scene.acknowledge_reports() == [AcknowledgeReport("a1", ())]
    assert scene.accounts()[-1].status == COMPLETED
    assert scene.state_before(AcknowledgeReport).status == EXECUTING
    # In the middle of a motion servos are not checked anew: nobody reads their models.
    assert 0 not in {sent.address for sent in told(scene.bench.bus.sent)}


def test_what_an_earlier_worker_left_is_ended_by_acknowledging(tmp_path: Path) -> None:
    Journal(tmp_path / "worker.journal").start("e0")
    scene = make_scene(tmp_path)
    scene.link.at(0.5, Acknowledge("a1"))
    scene.run(1.0)
    assert scene.acknowledge_reports() == [AcknowledgeReport("a1", ())]
    assert scene.journaled() == ["started", "interrupted"]
    assert Journal(tmp_path / "worker.journal").unfinished == set()


def test_without_a_journal_an_acknowledgement_clears_nothing(tmp_path: Path) -> None:
    Journal(tmp_path / "worker.journal").start("e0")
    scene = make_scene(tmp_path)

    scene.link.at(0.5, scene.spoil_journal)
    scene.link.at(0.5, Acknowledge("a1"))
    scene.run(1.0)
    assert [fault.code for fault in scene.acknowledge_reports()[0].faults] == [
        "journal_failed",
        "interrupted",
    ]


def test_an_end_that_cannot_be_noted_is_a_fault(scene: Scene) -> None:
    scene.short_order(targets=1)
    scene.link.at(0.8, scene.spoil_journal)
    scene.run(LONG_S)
    assert scene.accounts()[-1].status == COMPLETED
    assert scene.faults() == ["journal_failed"]


def test_a_lost_link_ends_a_motion_and_in_idle_nothing(scene: Scene) -> None:
    scene.link.at(0.1, "lose")
    scene.link.at(0.3, "find")
    scene.short_order()
    scene.link.at(0.8, "lose")
    scene.run(1.5)
    assert scene.ends() == {"e1": FAILED}
    assert scene.reasons() == {"e1": "the service was not heard any more"}
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
    assert scene.acknowledge_reports() == [AcknowledgeReport("a1", ())]
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
    (report,) = scene.acknowledge_reports()
    assert [(fault.code, fault.detail) for fault in report.faults] == [
        ("port_unavailable", "the device is gone")
    ]
    assert scene.faults() == ["port_unavailable"]


def test_servos_that_are_wrong_behind_a_bus_that_came_back_are_told(scene: Scene) -> None:
    scene.link.at(0.5, "unplug")
    scene.link.at(1.0, lambda: scene.bench.servo(51).table.__setitem__("torque_limit", 0))
    scene.link.at(1.0, Acknowledge("a1"))
    scene.run(2.0)
    (report,) = scene.acknowledge_reports()
    assert [fault.code for fault in report.faults] == ["wrong_setting"]
    assert "servo 51" in report.faults[0].detail


def test_wrong_servos_are_told_by_acknowledging_and_only_read(scene: Scene) -> None:
    scene.bench.servo(51).table["torque_limit"] = 0
    scene.link.at(1.0, Acknowledge("a1"))
    scene.run(1.5)
    (report,) = scene.acknowledge_reports()
    assert [fault.code for fault in report.faults] == ["wrong_setting"]
    assert {sent.instruction for sent in told(scene.bench.bus.sent)} == {2}
    assert [said for said in scene.link.said if isinstance(said, ExecutionAccount)] == []
