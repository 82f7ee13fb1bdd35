"""The worker's loop with a link that the test speaks through; servos and time are simulated."""

from collections import deque
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hardware.end_effector.end_effectors import OFF, ON
from hardware.link.messages import (
    CANCELED,
    COMPLETED,
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
    Telemetry,
)
from hardware.link.worker_end import LinkRefused
from tests.hardware.worker.scenes import Scene, make_scene


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    return make_scene(tmp_path)


def test_an_order_is_carried_out_and_accounted_for(scene: Scene) -> None:
    scene.order()
    scene.run()
    assert scene.accounts()[-1].status == COMPLETED
    assert [target.status for target in scene.accounts()[-1].targets] == ["done"] * 5
    statuses = [telemetry.status for telemetry in scene.telemetry()]
    assert statuses[0] == "idle"
    assert EXECUTING in statuses
    assert statuses[-1] == "idle"
    assert {t.execution_id for t in scene.telemetry()} == {None, "e1"}
    assert scene.telemetry()[-1].torque == "on"
    assert len(scene.telemetry()[-1].servos) == 8
    assert ON in {telemetry.end_effector_state for telemetry in scene.telemetry()}


def test_the_state_that_goes_before_the_end_is_that_of_the_end(scene: Scene) -> None:
    scene.order()
    scene.run()
    end = next(
        k
        for k, said in enumerate(scene.link.said)
        if isinstance(said, ExecutionAccount) and said.status == COMPLETED
    )
    state = scene.link.said[end - 1]
    assert isinstance(state, Telemetry)
    assert state.status == "idle"
    assert state.execution_id is None
    standby = scene.accounts()[-1].targets[-1].measured_standby_joints
    assert state.joints == pytest.approx(standby, abs=0.011)


def test_nothing_is_written_before_an_order_comes(scene: Scene) -> None:
    scene.run(5.0)
    assert {packet[4] for packet in scene.bench.bus.sent} == {2}
    assert scene.telemetry()[-1].torque == "off"


def test_pause_and_resume(scene: Scene) -> None:
    scene.order()
    scene.link.at(4.0, Pause("e1"))
    scene.link.at(8.0, Resume("e1"))
    scene.run()
    statuses = [account.status for account in scene.accounts()]
    assert PAUSED in statuses
    assert statuses[-1] == COMPLETED


def test_steering_another_execution_changes_nothing(scene: Scene) -> None:
    scene.order()
    for message in (Pause("other"), Cancel("other"), Resume("other")):
        scene.link.at(4.0, message)
    scene.run()
    assert PAUSED not in {account.status for account in scene.accounts()}
    assert scene.accounts()[-1].status == COMPLETED


def test_cancel_needs_no_acknowledgement(scene: Scene) -> None:
    scene.order()
    scene.link.at(4.0, Cancel("e1"))
    scene.order(8.0, "e2")
    scene.run()
    ends = {account.execution_id: account.status for account in scene.accounts()}
    assert ends == {"e1": CANCELED, "e2": COMPLETED}


@settings(max_examples=40)
@given(at_s=st.floats(0.0, 14.0))
def test_a_stop_at_any_moment_holds(tmp_path_factory: pytest.TempPathFactory, at_s: float) -> None:
    scene = make_scene(tmp_path_factory.mktemp("stop"))
    scene.order(0.1)
    scene.link.due = deque(sorted([*scene.link.due], key=lambda entry: entry[0]))
    scene.link.due.append((scene.bench.time.now_s + max(at_s, 0.1), Stop("s1")))
    scene.run(at_s + 3.0)
    (report,) = scene.stop_reports()
    assert report.request_id == "s1"
    assert report.stopped
    assert report.verified
    assert report.joints is not None
    # Where it said that it stood is where it truly still stands.
    assert np.abs(np.array(report.joints) - scene.bench.true_joints()).max() < 0.011
    assert scene.end_effector.state == OFF
    last = scene.telemetry()[-1]
    assert last.status == "fault"
    assert [fault.code for fault in last.faults] == ["stopped"]
    if scene.accounts():
        account = scene.accounts()[-1]
        assert account.status in (FAILED, COMPLETED)
        if account.status == FAILED:
            assert account.error is not None
            assert account.error.code == "stopped"


def test_a_stop_with_torque_off_sends_nothing(scene: Scene) -> None:
    scene.link.at(1.0, Stop("s1"))
    scene.run(3.0)
    (report,) = scene.stop_reports()
    assert report.stopped
    assert report.verified
    assert "torque is off" in report.detail
    assert {packet[4] for packet in scene.bench.bus.sent} == {2}


def test_a_second_stop_is_verified_too_and_latched_once(scene: Scene) -> None:
    scene.order()
    scene.link.at(4.0, Stop("s1"))
    scene.link.at(5.0, Stop("s2"))
    scene.run(7.0)
    assert [(report.request_id, report.verified) for report in scene.stop_reports()] == [
        ("s1", True),
        ("s2", True),
    ]
    assert [fault.code for fault in scene.telemetry()[-1].faults] == ["stopped"]


def test_a_stop_without_a_servo_says_what_was_not_verified(scene: Scene) -> None:
    scene.order()
    scene.link.at(4.0, "missing 41")
    scene.link.at(4.0, Stop("s1"))
    scene.run(8.0)
    (report,) = scene.stop_reports()
    assert not report.stopped
    assert not report.verified
    assert "41" in report.detail
    # The others were told to hold all the same.
    assert scene.accounts()[-1].status == FAILED


def test_a_stop_without_a_bus_is_no_success(scene: Scene) -> None:
    scene.order()
    scene.link.at(4.0, "unplug")
    scene.link.at(4.0, Stop("s1"))
    scene.run(8.0)
    (report,) = scene.stop_reports()
    assert not report.stopped
    assert not report.verified
    assert report.joints is None
    assert scene.end_effector.state == OFF


def test_after_a_stop_orders_are_refused_until_acknowledged(scene: Scene) -> None:
    scene.link.at(1.0, Stop("s1"))
    scene.order(2.0, "e1")
    scene.link.at(4.0, Acknowledge("a1"))
    scene.order(5.0, "e2")
    scene.run()
    ends = {account.execution_id: account for account in scene.accounts()}
    refused = ends["e1"].error
    assert refused is not None
    assert refused.code == "order_refused"
    assert "stopped" in refused.detail
    assert ends["e2"].status == COMPLETED
    reports = [said for said in scene.link.said if isinstance(said, AcknowledgeReport)]
    assert reports == [AcknowledgeReport("a1", ())]


@pytest.mark.parametrize(
    ("trouble", "code"),
    [
        ("missing 41", "servo_missing"),
        ("overload 31", "servo_alarm"),
        ("corrupt 1", "corrupt_packets"),
        ("silent", "servo_missing"),
        ("unplug", "bus_lost"),
        ("lose", "link_lost"),
        ("sleep 5", "link_lost"),
    ],
)
def test_trouble_in_the_middle_ends_it_with_the_cause(
    scene: Scene, trouble: str, code: str
) -> None:
    scene.order()
    scene.link.at(5.0, trouble)
    scene.run(12.0)
    account = scene.accounts()[-1]
    assert account.status == FAILED
    assert account.error is not None
    assert account.error.code == code
    assert scene.end_effector.state == OFF
    # Of a silent bus every servo is told, each time the same.
    assert {fault.code for fault in scene.telemetry()[-1].faults} == {code}
    position = scene.bench.true_joints()
    scene.bench.time.sleep(5)
    assert scene.bench.true_joints() == position


def test_a_fault_in_idle_is_latched_too(scene: Scene) -> None:
    scene.link.at(1.0, "voltage 61")
    scene.link.at(3.0, "heal")
    scene.run(5.0)
    assert [fault.code for fault in scene.telemetry()[-1].faults] == ["servo_alarm"]


def test_acknowledging_checks_again(scene: Scene) -> None:
    scene.link.at(1.0, "missing 41")
    scene.link.at(3.0, Acknowledge("a1"))
    scene.link.at(4.0, "heal")
    scene.link.at(5.0, Acknowledge("a2"))
    scene.run(7.0)
    first, second = [said for said in scene.link.said if isinstance(said, AcknowledgeReport)]
    assert [fault.code for fault in first.faults] == ["servo_missing"]
    assert second.faults == ()
    assert scene.telemetry()[-1].status == "idle"


def test_a_shut_down_servo_stays_a_fault_until_its_power_was_cycled(scene: Scene) -> None:
    scene.order()
    scene.link.at(4.0, "overload 31")
    scene.link.at(5.0, "heal")
    scene.link.at(6.0, Acknowledge("a1"))
    scene.link.at(7.0, "power-cycle")
    scene.link.at(8.0, Acknowledge("a2"))
    scene.run(10.0)
    first, second = [said for said in scene.link.said if isinstance(said, AcknowledgeReport)]
    assert [fault.code for fault in first.faults] == ["wrong_setting"]
    assert "torque limit" in first.faults[0].detail
    assert second.faults == ()
    # 34 is the torque limit: nobody but a person gives a shut-down servo its torque back.
    assert all(not (packet[4] != 2 and packet[5] == 34) for packet in scene.bench.bus.sent)


def test_a_bus_that_came_back_is_opened_by_acknowledging(scene: Scene) -> None:
    scene.link.at(1.0, "unplug")
    scene.link.at(3.0, Acknowledge("a1"))
    scene.run(5.0)
    (report,) = [said for said in scene.link.said if isinstance(said, AcknowledgeReport)]
    assert report.faults == ()


def test_an_end_effector_that_fails_is_recovered_by_acknowledging(scene: Scene) -> None:
    scene.link.at(1.0, "break end-effector")
    scene.link.at(2.0, Acknowledge("a1"))
    scene.run(4.0)
    faults = [tuple(fault.code for fault in said.faults) for said in scene.telemetry()]
    assert set(faults) == {(), ("end_effector_failed",)}
    assert faults[-1] == ()


def test_torque_lost_in_idle_is_a_fault_and_a_stop_says_that_it_is_off(scene: Scene) -> None:
    scene.order()
    scene.link.at(30.0, "power-cycle")
    scene.link.at(31.0, Stop("s1"))
    scene.run(35.0)
    assert scene.accounts()[-1].status == COMPLETED
    assert [fault.code for fault in scene.telemetry()[-1].faults] == ["torque_lost", "stopped"]
    assert scene.telemetry()[-1].torque == "off"
    (report,) = scene.stop_reports()
    assert "torque is off" in report.detail
    assert all(servo.table["torque_enable"] == 0 for servo in scene.bench.bus.simulated.servos)


def test_a_stop_after_a_killed_worker_holds_and_knows_that_torque_is_on(tmp_path: Path) -> None:
    first = make_scene(tmp_path)
    first.bench.arm.enable_torque()
    first.journal.start("e1")
    second = make_scene(tmp_path, first.bench)
    second.link.at(1.0, Stop("s1"))
    sent = len(first.bench.bus.sent)
    second.run(3.0)
    (report,) = second.stop_reports()
    assert report.verified
    assert report.detail == "the arm holds where it stands"
    assert {packet[4] for packet in first.bench.bus.sent[sent:]} == {2, 0x83}


def test_torque_that_was_on_before_the_worker_came_is_watched_too(tmp_path: Path) -> None:
    scene = make_scene(tmp_path)
    scene.bench.arm.enable_torque()
    scene.link.at(2.0, "power-cycle")
    scene.run(4.0)
    assert {said.torque for said in scene.telemetry()} >= {"on", "off"}
    assert scene.telemetry()[-1].torque == "off"
    assert [fault.code for fault in scene.telemetry()[-1].faults] == ["torque_lost"]


def test_a_lost_bus_is_unknown_torque(tmp_path: Path) -> None:
    scene = make_scene(tmp_path)
    scene.bench.arm.enable_torque()
    scene.link.at(2.0, "unplug")
    scene.run(4.0)
    assert scene.telemetry()[-1].torque == "unknown"


def test_a_second_servo_that_is_lost_is_told_too(scene: Scene) -> None:
    scene.link.at(1.0, "missing 41")
    scene.link.at(3.0, "missing 51")
    scene.run(6.0)
    details = [fault.detail for fault in scene.telemetry()[-1].faults]
    assert len(details) == 2
    assert "41" in details[0]
    assert "51" in details[1]


def test_an_end_effector_that_does_not_come_on_fails_the_execution(scene: Scene) -> None:
    scene.end_effector.broken = True
    scene.order()
    scene.run()
    account = scene.accounts()[-1]
    assert account.status == FAILED
    assert account.error is not None
    assert account.error.code == "end_effector_failed"


def test_no_execution_runs_twice(scene: Scene) -> None:
    scene.order(0.5, "e1")
    scene.order(40.0, "e1")
    scene.run(50.0)
    statuses = [account.status for account in scene.accounts()]
    assert statuses.count(COMPLETED) == 1
    error = scene.accounts()[-1].error
    assert error is not None
    assert "begun before" in error.detail


def test_a_second_order_while_one_runs_is_refused_and_the_first_goes_on(scene: Scene) -> None:
    scene.order(0.5, "e1")
    scene.order(4.0, "e2")
    scene.run()
    ends = {account.execution_id: account.status for account in scene.accounts()}
    assert ends == {"e1": COMPLETED, "e2": FAILED}


def test_being_told_to_end_in_the_middle_holds_and_says_so(scene: Scene) -> None:
    scene.order()
    scene.run(4.0)
    account = scene.accounts()[-1]
    assert account.status == FAILED
    assert account.error is not None
    assert account.error.code == "worker_ended"
    assert scene.end_effector.state == OFF


def test_a_worker_killed_in_the_middle_wants_a_person_to_look(tmp_path: Path) -> None:
    first = make_scene(tmp_path)
    first.journal.start("e1")
    second = make_scene(tmp_path)
    second.order(1.0, "e2")
    second.link.at(3.0, Acknowledge("a1"))
    second.order(4.0, "e3")
    second.run()
    assert [fault.code for fault in second.telemetry()[0].faults] == ["interrupted"]
    ends = {account.execution_id: account.status for account in second.accounts()}
    assert ends == {"e2": FAILED, "e3": COMPLETED}
    assert make_scene(tmp_path).journal.unfinished == set()


def test_without_a_journal_nothing_is_begun_and_what_ends_is_a_fault(
    scene: Scene, tmp_path: Path
) -> None:
    file = tmp_path / "worker.journal"
    file.unlink()
    file.mkdir()
    scene.order()
    scene.run(5.0)
    error = scene.accounts()[-1].error
    assert error is not None
    assert error.code == "journal_failed"
    assert {packet[4] for packet in scene.bench.bus.sent} == {2}


def test_a_refused_worker_ends(scene: Scene) -> None:
    scene.link.refusal = LinkRefused("another model")
    with pytest.raises(LinkRefused):
        scene.run(1.0)


def test_a_servo_that_is_not_the_arm_files_is_a_fault_from_the_start(tmp_path: Path) -> None:
    scene = make_scene(tmp_path)
    scene.bench.fault("return-level 51 1")
    scene.run(1.0)
    (fault,) = scene.telemetry()[0].faults
    assert fault.code == "wrong_setting"
    assert "51" in fault.detail
