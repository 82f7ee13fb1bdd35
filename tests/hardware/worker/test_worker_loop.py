"""The worker's loop: how often it does what, and what a tick that comes late does to a motion."""

import logging
from pathlib import Path

import numpy as np
import pytest

from hardware.bus.packets import READ
from hardware.end_effector.end_effectors import OFF
from hardware.exceptions import Interrupted
from hardware.link.messages import COMPLETED, FAILED, ExecutionAccount, Telemetry
from hardware.link.worker_end import LinkRefused
from hardware.tolerances import IDLE_TICK_S, TICK_S
from hardware.worker.journal import Journal
from tests.hardware.parts import goals_sent, make_bench, told
from tests.hardware.worker.scenes import Scene, make_scene


@pytest.fixture
def scene(tmp_path: Path) -> Scene:
    return make_scene(tmp_path, make_bench(noise_ticks=0))


def goal_times(scene: Scene) -> list[float]:
    """When goals are sent [s], filled while the scene runs."""
    times: list[float] = []
    real = scene.bench.bus.sync_write

    def sync_write(address: int, rows: dict[int, bytes]) -> None:
        times.append(scene.bench.time.now_s)
        real(address, rows)

    scene.bench.bus.sync_write = sync_write  # type: ignore[method-assign, assignment]
    return times


# --- How often ------------------------------------------------------------------------------------
def test_in_idle_a_joint_is_read_every_twentieth_of_a_second(scene: Scene) -> None:
    began = scene.bench.time.now_s
    scene.link.at(1.0, scene.bench.bus.sent.clear)
    scene.run(1.0 + 60 * IDLE_TICK_S - 0.01)
    reads = told(scene.bench.bus.sent)
    # Ten rounds of eight servos.
    assert [sent.servo_id for sent in reads].count(41) == 10
    assert len(reads) == 10 * 8
    assert scene.bench.time.now_s - began == pytest.approx(1.0 + 60 * IDLE_TICK_S, abs=0.06)


@pytest.mark.parametrize("factor", [1.0, 10.0])
def test_telemetry_comes_every_tenth_of_a_second_on_the_wall_clock(
    tmp_path: Path, factor: float
) -> None:
    scene = make_scene(tmp_path, time_factor=factor)
    scene.run(5.0)
    times = [
        at
        for at, said in zip(scene.link.said_at, scene.link.said, strict=True)
        if isinstance(said, Telemetry)
    ]
    # Looked at in every tick: the first one that is due.
    ways = np.diff(times)
    assert ways[:-1].min() > 0.1 - 1e-9
    assert ways.max() < 0.1 + 1.01 * IDLE_TICK_S / factor


def test_motion_goes_in_ticks_of_a_fiftieth_of_a_second(scene: Scene) -> None:
    times = goal_times(scene)
    scene.short_order(targets=1)
    scene.run(4.0)
    assert scene.accounts()[-1].status == COMPLETED
    ticks = np.diff(times[1:])
    assert ticks.min() == pytest.approx(TICK_S)
    assert np.median(ticks) == pytest.approx(TICK_S)
    assert scene.telemetry()[-1].overruns == 0


def test_servos_are_polled_while_the_arm_moves_too(scene: Scene) -> None:
    scene.short_order(targets=1)
    scene.link.at(0.6, "slip 41 100")
    scene.run(3.0)
    assert scene.faults() == ["following_error"]


# --- Late ticks -----------------------------------------------------------------------------------
def test_a_late_tick_makes_the_motion_wait_and_not_hurry(scene: Scene) -> None:
    times = goal_times(scene)
    scene.short_order(targets=1)
    scene.link.at(0.7, "sleep 0.3")
    scene.run(4.0)
    assert scene.accounts()[-1].status == COMPLETED
    assert scene.telemetry()[-1].overruns == 1
    # What was late is sent at once and what follows it too; nothing else is made up for.
    ways = np.diff(times[1:])
    assert (ways < 0.99 * TICK_S).sum() <= 1
    assert (ways > 0.3).sum() == 1


def test_late_ticks_in_idle_are_nobodys_business(scene: Scene) -> None:
    scene.link.at(0.5, "sleep 3")
    scene.link.at(5.0, "oversleep 3")
    scene.run(9.0)
    assert scene.telemetry()[-1].overruns == 0
    assert scene.faults() == []


@pytest.mark.parametrize("word", ["sleep", "oversleep"])
@pytest.mark.parametrize(("seconds", "lost"), [(1.9, False), (2.1, True)])
def test_a_worker_that_stood_still_longer_than_the_service_waits_ends_the_motion(
    scene: Scene, word: str, seconds: float, lost: bool
) -> None:
    """The service has given it up by then and told so."""
    times = goal_times(scene)
    scene.short_order(targets=1)
    scene.link.at(0.7, f"{word} {seconds}")
    scene.run(8.0)
    account = scene.accounts()[-1]
    assert scene.telemetry()[-1].overruns == 1
    if not lost:
        assert account.status == COMPLETED
        return
    assert account.status == FAILED
    assert account.error is not None
    assert account.error.code == "link_lost"
    assert account.error.detail == f"the worker itself stood still for {seconds:.1f} s"
    assert scene.faults() == ["link_lost"]
    after = [at for at in times if at > times[0] + seconds]
    # After a wait before the tick nothing is sent but the hold.
    assert len(after) == (1 if word == "oversleep" else 2)


@pytest.mark.parametrize("factor", [10.0, 0.5])
@pytest.mark.parametrize(("seconds", "status"), [(1.9, COMPLETED), (2.1, FAILED)])
def test_how_long_is_too_long_is_told_by_the_wall_clock(
    tmp_path: Path, factor: float, seconds: float, status: str
) -> None:
    """Ten times as fast, nineteen seconds of the robot's are less than two of the service's."""
    for word in ("sleep", "oversleep"):
        bench = make_bench(noise_ticks=0)
        scene = make_scene(tmp_path / word, bench, time_factor=factor)
        times = goal_times(scene)
        scene.short_order(targets=1)
        scene.link.at(0.5 + 0.14 / factor, f"{word} {seconds}")
        scene.run(4.0 + 3.0 / factor)
        assert scene.accounts()[-1].status == status
    if status == FAILED:
        assert len([at for at in times if at > times[0] + seconds]) == 1


# --- Begin and end --------------------------------------------------------------------------------
def test_before_anything_comes_the_end_effector_is_off_and_the_servos_are_checked(
    scene: Scene,
) -> None:
    scene.end_effector.state = "unknown"
    scene.run(0.0)
    assert scene.end_effector.switched == [OFF]
    assert {sent.instruction for sent in told(scene.bench.bus.sent)} == {READ}
    assert (61, 0) in {(sent.servo_id, sent.address) for sent in told(scene.bench.bus.sent)}
    # Told when it begins and when it ends.
    assert [said.status for said in scene.telemetry()] == ["idle", "idle"]


@pytest.mark.parametrize(
    ("repair", "faults"), [(True, []), (False, ["end_effector_failed", "end_effector_failed"])]
)
def test_an_end_effector_that_does_not_work_at_first_is_recovered(
    scene: Scene, repair: bool, faults: list[str]
) -> None:
    scene.end_effector.gone = True
    scene.end_effector.beyond_repair = not repair
    scene.run(1.0)
    assert scene.faults() == faults[:1]
    assert scene.end_effector.state == OFF
    if not repair:
        assert scene.telemetry()[-1].faults[0].detail == "it is beyond repair"


def test_a_worker_that_ends_says_how_the_arm_is_and_leaves(scene: Scene) -> None:
    scene.run(1.0)
    assert not scene.link.is_alive
    assert isinstance(scene.link.said[-1], Telemetry)


def test_a_worker_that_ends_in_the_middle_has_told_what_became_of_it(scene: Scene) -> None:
    scene.short_order()
    scene.run(0.8)
    account = scene.accounts()[-1]
    assert account.error is not None
    assert account.error.detail == "the worker was told to end"
    assert not scene.link.is_alive
    assert scene.journal.unfinished == set()
    assert scene.bench.arm.hold().still


def test_the_last_state_has_all_that_went_wrong_in_the_end(scene: Scene) -> None:
    """That the end of an execution could not be noted is known when it was told already."""
    scene.short_order()
    scene.link.at(0.8, scene.spoil_journal)
    scene.run(0.8)
    assert isinstance(scene.link.said[-1], Telemetry)
    assert scene.faults() == ["worker_ended", "journal_failed"]


def test_a_worker_that_is_refused_in_the_middle_holds_and_leaves(scene: Scene) -> None:
    refusal = LinkRefused("another has joined")
    scene.short_order()
    scene.link.at(0.8, lambda: setattr(scene.link, "refusal", refusal))
    with pytest.raises(LinkRefused) as caught:
        scene.run(30.0)
    assert caught.value is refusal
    assert scene.accounts()[-1].status == FAILED
    assert not scene.link.is_alive


def test_a_worker_can_end_before_it_begins(scene: Scene) -> None:
    scene.worker.end()
    scene.worker.run()
    assert goals_sent(scene.bench.bus.sent) == []
    assert not scene.link.is_alive


# --- Defects --------------------------------------------------------------------------------------
def test_a_defect_of_the_worker_holds_the_arm_and_is_in_the_log(
    scene: Scene, caplog: pytest.LogCaptureFixture
) -> None:
    def defect() -> None:
        del scene.end_effector.check
        raise ZeroDivisionError("seven by none")

    scene.short_order()
    scene.link.at(0.8, lambda: setattr(scene.end_effector, "check", defect))
    with caplog.at_level(logging.ERROR):
        scene.run(1.5)
    assert scene.faults() == ["internal_error"]
    account = scene.accounts()[-1]
    assert account.error is not None
    assert account.error.detail == "ZeroDivisionError; the worker's log has it"
    (record,) = [record for record in caplog.records if record.exc_info][:1]
    assert record.exc_info is not None
    assert record.exc_info[0] is ZeroDivisionError
    assert "defect" in record.getMessage()


def test_an_execution_of_an_earlier_worker_is_a_fault_until_somebody_has_looked(
    tmp_path: Path,
) -> None:
    Journal(tmp_path / "worker.journal").start("e0")
    scene = make_scene(tmp_path)
    scene.run(0.5)
    (fault,) = scene.telemetry()[-1].faults
    assert fault.code == Interrupted.code
    assert fault.detail == "a worker ended in the middle of an execution; look at the arm"
    assert [said for said in scene.link.said if isinstance(said, ExecutionAccount)] == []
