import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from hardware.end_effector.end_effectors import (
    END_EFFECTORS,
    OFF,
    ON,
    UNKNOWN,
    EndEffector,
    GuardedEndEffector,
)
from hardware.exceptions import EndEffectorFailed
from hardware.tolerances import GUARD_S, RENEW_S
from tests.app.conftest import wait_until


@pytest.fixture
def record(tmp_path: Path) -> Path:
    return tmp_path / "record.txt"


@pytest.fixture
def laser(record: Path) -> Iterator[GuardedEndEffector]:
    it = GuardedEndEffector("simulated", record)
    yield it
    it.close()


def changes(record: Path) -> list[tuple[str, str]]:
    rows = [line.split(maxsplit=2) for line in record.read_text().splitlines()]
    return [(state, why) for _, state, why in rows]


@pytest.mark.parametrize("name", END_EFFECTORS)
def test_every_kind_can_be_switched_and_closed(name: str, record: Path) -> None:
    it: EndEffector = END_EFFECTORS[name](record)
    states = []
    for on in (False, True, False):
        it.switch(on=on)
        states.append(it.state)
        if on:
            it.stay_on()
    it.close()
    assert states in (["none"] * 3, [OFF, ON, OFF])


def test_every_change_is_recorded_with_its_cause(laser: GuardedEndEffector, record: Path) -> None:
    laser.switch(on=True)
    laser.switch(on=False)
    laser.close()
    assert laser.state == OFF
    assert changes(record) == [
        (OFF, "start"), (ON, "commanded"), (OFF, "commanded"), (OFF, "end"),
    ]  # fmt: skip


def test_it_stays_on_as_long_as_it_is_told_to(laser: GuardedEndEffector, record: Path) -> None:
    laser.switch(on=True)
    until = time.monotonic() + 2 * GUARD_S
    while time.monotonic() < until:
        laser.stay_on()
        time.sleep(0.02)
    assert changes(record)[-1] == (ON, "commanded")


def test_it_goes_off_when_it_is_forgotten(laser: GuardedEndEffector, record: Path) -> None:
    laser.switch(on=True)
    wait_until(lambda: changes(record)[-1] == (OFF, "not told to stay on"), 10)
    with pytest.raises(EndEffectorFailed, match="off"):
        laser.stay_on()
    laser.switch(on=False)
    assert laser.state == OFF


def test_a_dead_guard_is_an_unknown_state_and_no_success(laser: GuardedEndEffector) -> None:
    laser.switch(on=True)
    laser._guard.kill()
    laser._guard.wait()
    with pytest.raises(EndEffectorFailed):
        laser.switch(on=False)
    assert laser.state == UNKNOWN


def test_a_dead_guard_is_noticed_without_being_asked(laser: GuardedEndEffector) -> None:
    laser.check()
    laser._guard.kill()
    laser._guard.wait()
    with pytest.raises(EndEffectorFailed, match="gone"):
        laser.check()
    assert laser.state == UNKNOWN
    laser.recover()
    laser.check()
    laser.switch(on=True)
    assert laser.state == ON


def test_a_guard_that_stood_still_went_off_and_its_late_answers_are_nobodys(
    laser: GuardedEndEffector, record: Path
) -> None:
    laser.switch(on=True)
    laser._guard.send_signal(signal.SIGSTOP)
    time.sleep(RENEW_S)
    with pytest.raises(EndEffectorFailed, match="does not answer"):
        laser.stay_on()
    time.sleep(GUARD_S)
    laser._guard.send_signal(signal.SIGCONT)
    wait_until(lambda: changes(record)[-1] == (OFF, "not told to stay on"), 10)
    for on in (False, True, False):
        laser.switch(on=on)
        assert laser.state == (ON if on else OFF)


def test_a_guard_that_does_not_end_is_ended_and_another_switches_off(
    laser: GuardedEndEffector, record: Path
) -> None:
    laser.switch(on=True)
    laser._guard.send_signal(signal.SIGSTOP)
    laser.close()
    assert laser._guard.returncode is not None
    assert laser.state == OFF
    assert changes(record)[-1] == (OFF, "end")


def test_a_record_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    with pytest.raises(EndEffectorFailed, match="nowhere"):
        GuardedEndEffector("simulated", tmp_path / "nowhere" / "record.txt")


def test_a_guard_that_is_told_to_end_switches_off_first(
    laser: GuardedEndEffector, record: Path
) -> None:
    laser.switch(on=True)
    laser._guard.send_signal(signal.SIGTERM)
    laser._guard.wait(10)
    assert changes(record)[-1] == (OFF, "end")


def test_an_interrupt_is_left_to_the_worker(laser: GuardedEndEffector) -> None:
    laser.switch(on=True)
    laser._guard.send_signal(signal.SIGINT)
    laser.switch(on=False)
    assert laser.state == OFF
