"""Pause, resume and cancel: how the pace falls and rises, and what the light does meanwhile."""

from dataclasses import replace

import numpy as np
import pytest

from hardware.end_effector.end_effectors import OFF, ON
from hardware.exceptions import Canceled
from hardware.link.messages import COMPLETED, DONE, EXECUTING, PAUSED, SKIPPED, UNKNOWN
from hardware.tolerances import TICK_S
from tests.hardware.parts import make_bench
from tests.hardware.worker.runs import Run, make_run, tool_of
from tests.hardware.worker.short_orders import TICKS, built, short_motion, standby

RAMP_TICKS = 25
"""Half a second."""


def short_run(slower: float = 1.0) -> Run:
    """Two targets, or one with all times longer."""
    bench = make_bench(noise_ticks=0)
    motion = short_motion(bench.robot, 0)
    if slower == 1.0:
        return make_run(bench, built(bench, tool_of(bench.robot)))
    times = tuple(slower * at for at in motion.times_s)
    segments = tuple(
        replace(part, start_s=slower * part.start_s, end_s=slower * part.end_s)
        for part in motion.segments
    )
    slow = replace(motion, times_s=times, segments=segments)
    return make_run(bench, built(bench, tool_of(bench.robot), targets=1, motions=[slow]))


@pytest.fixture
def run() -> Run:
    return short_run()


@pytest.fixture
def slow() -> Run:
    """A transfer of some two seconds."""
    return short_run(slower=20.0)


def ticks(run: Run, count: int) -> list[str]:
    """The status after each tick."""
    statuses = []
    for _ in range(count):
        assert run.tick()
        statuses.append(run.execution.account.status)
    return statuses


def ways(run: Run, count: int) -> np.ndarray:
    """How far joint 6 is sent in each tick."""
    at = [float(run.bench.arm.commanded[5])]
    for _ in range(count):
        assert run.tick()
        at.append(float(run.bench.arm.commanded[5]))
    return np.diff(at)


def canceled(run: Run) -> int:
    """How many ticks pass before it is."""
    before = len(run.segments)
    with pytest.raises(Canceled, match="holds where it stands"):
        run.finish()
    return len(run.segments) - before


def test_a_pause_slows_down_evenly_over_half_a_second(slow: Run) -> None:
    slow.until("transfer", 5)
    full = ways(slow, 3)
    assert full == pytest.approx(full[0])
    slow.execution.pause()
    shares = ways(slow, RAMP_TICKS + 5) / full[0]
    assert shares[:RAMP_TICKS] == pytest.approx(1 - np.arange(1, RAMP_TICKS + 1) / RAMP_TICKS)
    assert shares[RAMP_TICKS:] == pytest.approx(0)
    assert slow.execution.account.status == PAUSED
    slow.execution.resume()
    shares = ways(slow, RAMP_TICKS + 5) / full[0]
    assert shares[:RAMP_TICKS] == pytest.approx(np.arange(1, RAMP_TICKS + 1) / RAMP_TICKS)
    assert shares[RAMP_TICKS:] == pytest.approx(1)


def test_a_pause_is_one_when_it_stands_and_over_when_it_moves(slow: Run) -> None:
    slow.until("transfer", 5)
    slow.execution.pause()
    assert ticks(slow, RAMP_TICKS + 10) == [EXECUTING] * (RAMP_TICKS - 1) + [PAUSED] * 11
    slow.execution.resume()
    assert ticks(slow, 3) == [EXECUTING] * 3


def test_a_pause_that_is_taken_back_never_stands(slow: Run) -> None:
    slow.until("transfer", 5)
    full = ways(slow, 1)[0]
    slow.execution.pause()
    assert ways(slow, 10)[-1] / full == pytest.approx(0.6)
    slow.execution.resume()
    assert ways(slow, 1)[0] / full == pytest.approx(0.64)
    assert ways(slow, 9)[-1] / full == pytest.approx(1)
    assert PAUSED not in {account.status for account in slow.accounts}


def test_goals_are_sent_while_it_is_paused_so_that_it_stays(slow: Run) -> None:
    slow.until("transfer", 5)
    slow.execution.pause()
    ticks(slow, RAMP_TICKS)
    stands, sent = slow.bench.arm.commanded, len(slow.bench.bus.sent)
    ticks(slow, 50)
    assert (slow.bench.arm.commanded == stands).all()
    assert len(slow.bench.bus.sent) > sent


def test_a_pause_changes_nothing_of_what_is_done(run: Run) -> None:
    run.until("transfer", 1)
    run.execution.pause()
    ticks(run, RAMP_TICKS + 5)
    run.execution.resume()
    run.finish()
    assert run.execution.account.status == COMPLETED
    assert [target.status for target in run.execution.account.targets] == [DONE, DONE]
    assert run.bench.arm.commanded == pytest.approx(standby(run.bench.robot, 1))


@pytest.mark.parametrize("segment", ["transfer", "cut_in"])
def test_a_pause_counts_while_a_posture_is_measured_too(run: Run, segment: str) -> None:
    """All five ticks of it."""
    run.until(segment, TICKS[segment] - 1)
    run.execution.pause()
    statuses = ticks(run, RAMP_TICKS + 1)
    assert statuses == [EXECUTING] * (RAMP_TICKS - 1) + [PAUSED] * 2


def test_a_pause_counts_while_the_arm_settles_too(run: Run) -> None:
    run.until("transfer", 1)
    run.bench.fault("slip 41 10")
    ticks(run, TICKS["transfer"])
    run.execution.pause()
    assert ticks(run, RAMP_TICKS) == [EXECUTING] * (RAMP_TICKS - 1) + [PAUSED]
    assert run.execution.account.segment == "transfer"


# --- Cancel ---------------------------------------------------------------------------------------
def test_a_cancel_ends_when_the_arm_stands(slow: Run) -> None:
    slow.until("transfer", 5)
    slow.execution.cancel()
    assert canceled(slow) == RAMP_TICKS - 1


def test_a_cancel_ends_at_once_where_the_arm_stands_already(slow: Run) -> None:
    slow.until("transfer", 5)
    slow.execution.pause()
    ticks(slow, RAMP_TICKS)
    slow.execution.cancel()
    assert canceled(slow) == 0


def test_a_cancel_stays_one_whatever_comes_after_it(slow: Run) -> None:
    slow.until("transfer", 5)
    slow.execution.cancel()
    ticks(slow, 5)
    slow.execution.resume()
    ticks(slow, 5)
    slow.execution.pause()
    assert canceled(slow) == RAMP_TICKS - 11


@pytest.mark.parametrize("target", [0, 1])
def test_a_target_that_the_light_has_not_met_is_skipped(run: Run, target: int) -> None:
    for _ in range(target):
        run.until("dwell")
        run.until("retreat")
    run.until("transfer")
    run.execution.cancel()
    canceled(run)
    run.execution.end(Canceled("on request"))
    assert run.execution.account.targets[target].status == SKIPPED


def test_a_cancel_before_the_dwell_lets_no_light_on(run: Run) -> None:
    run.until("cut_in", TICKS["cut_in"])
    run.execution.cancel()
    canceled(run)
    run.execution.end(Canceled("on request"))
    assert run.end_effector.changes == []
    assert run.execution.account.targets[0].status == SKIPPED


# --- The dwell ------------------------------------------------------------------------------------
def light_s(run: Run) -> float:
    """How long the light of the first dwell is on altogether [s]."""
    total = 0.0
    run.until("dwell")
    while run.execution.account.segment == "dwell":
        began, on = run.bench.time.now_s, run.end_effector.state == ON
        assert run.tick()
        if on:
            total += run.bench.time.now_s - began
    return total


def test_a_pause_ends_the_light_at_once_and_a_resume_goes_on_with_the_rest(run: Run) -> None:
    run.until("dwell", 2)
    run.execution.pause()
    assert run.end_effector.state == ON
    ticks(run, 1)
    assert run.end_effector.state == OFF
    ticks(run, 40)
    assert run.end_effector.state == OFF
    assert run.execution.account.status == PAUSED
    run.execution.resume()
    lit = 0
    while run.execution.account.segment == "dwell":
        ticks(run, 1)
        lit += run.end_effector.state == ON
    # Two of its eight ticks were over, and a third has begun when it is asked.
    assert lit == 8 - 3
    assert run.end_effector.changes == [("dwell", ON), ("dwell", OFF)] * 2


def test_a_cancel_in_a_dwell_ends_the_light_at_once(run: Run) -> None:
    run.until("dwell", 2)
    run.execution.cancel()
    ticks(run, 1)
    assert run.end_effector.changes == [("dwell", ON), ("dwell", OFF)]
    assert canceled(run) == RAMP_TICKS - 2
    run.execution.end(Canceled("on request"))
    assert run.execution.account.targets[0].status == UNKNOWN
    assert run.end_effector.changes == [("dwell", ON), ("dwell", OFF)]


def test_a_pause_as_the_dwell_begins_keeps_the_light_off_until_it_is_over(run: Run) -> None:
    run.until("cut_in", TICKS["cut_in"])
    run.execution.pause()
    ticks(run, RAMP_TICKS + 20)
    assert run.execution.account.segment == "dwell"
    assert run.end_effector.changes == []
    run.execution.resume()
    assert light_s(run) == pytest.approx(0.16)
    assert run.end_effector.changes == [("dwell", ON), ("dwell", OFF)]


def test_the_light_is_told_in_every_tick_to_stay_on(run: Run) -> None:
    told: list[float] = []
    run.end_effector.stay_on = lambda: told.append(run.bench.time.now_s)  # type: ignore[method-assign]
    run.until("dwell")
    run.until("retreat")
    assert np.diff(told) == pytest.approx(TICK_S)
    assert len(told) == 8


def test_the_light_is_on_for_as_long_as_asked_by_the_clock(run: Run) -> None:
    assert light_s(run) == pytest.approx(0.16)
    # Late ticks: two of 0.08 s are enough.
    run.until("transfer")
    run.until("dwell")
    passed = 0
    while run.execution.account.segment == "dwell":
        run.bench.time.sleep(0.06)
        ticks(run, 1)
        passed += 1
    assert passed == 2


def test_an_execution_is_not_paused_when_it_begins(run: Run) -> None:
    run.execution.resume()
    run.finish()
    assert {account.status for account in run.accounts} == {EXECUTING, COMPLETED}
