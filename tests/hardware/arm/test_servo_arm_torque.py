"""Torque comes on where the arm stands: what is sent and read back before, and what stops it."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest

from hardware.bus.bus import StatusReply
from hardware.bus.packets import READ, SYNC_WRITE, WRITE
from hardware.exceptions import (
    BusLost,
    HardwareError,
    PairDisagreement,
    ServoAlarm,
    ServoMissing,
    WrongSetting,
)
from hardware.servos.joints import SYNC_CABLE
from hardware.servos.units import speed_ticks
from tests.hardware.parts import Bench, Sent, goals_sent, make_bench, told

HOME_COUNTS = {11: 512, 21: 3516, 22: 579, 31: 512, 32: 511, 41: 512, 51: 819, 61: 512}
HOLD_SPEED = speed_ticks(0.3)
Rows = Mapping[int, bytes]


@pytest.fixture
def bench() -> Bench:
    return make_bench(noise_ticks=0)


def torque_of(bench: Bench) -> set[int]:
    return {servo.servo_id for servo in bench.bus.simulated.servos if servo.table["torque_enable"]}


def test_goals_are_sent_and_read_back_before_any_torque(bench: Bench) -> None:
    bench.arm.enable_torque()
    ids = list(HOME_COUNTS)
    expected = [Sent(servo_id, READ, 24, {}) for servo_id in ids]
    rows = {servo_id: (counts, HOLD_SPEED) for servo_id, counts in HOME_COUNTS.items()}
    expected += [Sent(0xFE, SYNC_WRITE, 30, rows)]
    expected += [Sent(servo_id, READ, address, {}) for servo_id in ids for address in (30, 32)]
    expected += [Sent(servo_id, kind, 24, {}) for servo_id in ids for kind in (WRITE, READ)]
    expected += [Sent(servo_id, READ, 24, {}) for servo_id in ids]
    assert told(bench.bus.sent) == expected
    assert torque_of(bench) == set(ids)
    assert bench.arm.torque == "on"


def test_what_is_commanded_then_is_where_it_stands(bench: Bench) -> None:
    with pytest.raises(RuntimeError, match="torque"):
        _ = bench.arm.commanded
    bench.arm.enable_torque()
    assert bench.arm.commanded == pytest.approx(bench.map.joints(HOME_COUNTS), abs=1e-12)


def test_the_two_of_a_pair_get_the_middle_of_what_they_say(bench: Bench) -> None:
    bench.fault("slip 22 20")  # says 599, as if the first stood at 3496 and not at 3516
    bench.fault("slip 32 -6")  # says 505, as if the first stood at 518 and not at 512
    bench.arm.enable_torque()
    (rows,) = goals_sent(bench.bus.sent)
    assert (rows[21][0], rows[22][0]) == (3506, 589)
    assert (rows[31][0], rows[32][0]) == (515, 508)


def test_on_a_sync_cable_only_the_master_gets_a_goal_and_both_get_torque() -> None:
    bench = make_bench(coupling_of_joint_2=SYNC_CABLE, noise_ticks=0)
    bench.arm.enable_torque()
    (rows,) = goals_sent(bench.bus.sent)
    assert list(rows) == [11, 21, 31, 32, 41, 51, 61]
    assert 22 in torque_of(bench)
    assert (22, 30) not in {(sent.servo_id, sent.address) for sent in told(bench.bus.sent)}


@pytest.mark.parametrize(
    ("fault", "error"),
    [
        ("slip 22 50", PairDisagreement),
        ("slip 32 -10", PairDisagreement),
        ("missing 61", ServoMissing),
        ("voltage 61", ServoAlarm),
    ],
)
def test_nothing_is_written_to_an_arm_in_doubt(
    bench: Bench, fault: str, error: type[HardwareError]
) -> None:
    bench.fault(fault)
    with pytest.raises(error):
        bench.arm.enable_torque()
    assert {sent.instruction for sent in told(bench.bus.sent)} == {READ}


@pytest.mark.parametrize(
    ("servo_id", "register"),
    [
        (servo_id, register)
        for servo_id in (11, 22, 61)
        for register in ("goal_position", "moving_speed")
    ],
)
def test_a_servo_that_did_not_take_its_goal_or_speed_gets_no_torque(
    bench: Bench, servo_id: int, register: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The packet with the goals is answered by nobody, so a servo may have missed it."""
    monkeypatch.setattr(bench.bus, "sync_write", missed(bench, servo_id, register))
    with pytest.raises(WrongSetting, match=f"{register} reads") as caught:
        bench.arm.enable_torque()
    assert caught.value.servo_id == servo_id
    assert WRITE not in {sent.instruction for sent in told(bench.bus.sent)}
    with pytest.raises(RuntimeError):
        _ = bench.arm.commanded


def missed(bench: Bench, servo_id: int, register: str) -> Callable[[int, Rows], None]:
    """A sync write of which one servo does not take one register."""
    real = bench.bus.sync_write

    def sync_write(address: int, rows: Rows) -> None:
        table = bench.servo(servo_id).table
        before = 0 if register == "moving_speed" else table[register] - 1
        real(address, rows)
        table[register] = before

    return sync_write


@pytest.mark.parametrize("moves", [11, 22, 61])
@pytest.mark.parametrize(("counts", "is_jump"), [(4, False), (-4, False), (5, True), (-5, True)])
def test_a_servo_that_moves_as_torque_comes_on_is_named(
    bench: Bench, moves: int, counts: int, is_jump: bool
) -> None:
    real = bench.bus.write

    def write(servo_id: int, address: int, data: bytes) -> StatusReply:
        reply = real(servo_id, address, data)
        bench.fault(f"slip {moves} {counts}")
        return reply

    bench.bus.write = write  # type: ignore[method-assign]
    if not is_jump:
        bench.arm.enable_torque()
        # The goal is where it stood before.
        assert bench.arm.commanded == pytest.approx(bench.map.joints(HOME_COUNTS), abs=1e-12)
        return
    with pytest.raises(WrongSetting, match=f"moved by {counts} counts") as caught:
        bench.arm.enable_torque()
    assert caught.value.servo_id == moves


@pytest.mark.parametrize("dead", [11, 22, 61])
def test_every_servo_is_under_power_or_it_is_an_error(bench: Bench, dead: int) -> None:
    real = bench.bus.write

    def write(servo_id: int, address: int, data: bytes) -> StatusReply:
        reply = real(servo_id, address, data)
        bench.servo(dead).table["torque_enable"] = 0
        return reply

    bench.bus.write = write  # type: ignore[method-assign]
    with pytest.raises(WrongSetting, match="torque_enable") as caught:
        bench.arm.enable_torque()
    assert caught.value.servo_id == dead


def test_torque_is_told_by_what_every_servo_said_last(bench: Bench) -> None:
    assert bench.arm.torque == "unknown"
    bench.arm.check()
    assert bench.arm.torque == "off"
    for servo_id in HOME_COUNTS:
        bench.servo(servo_id).table["torque_enable"] = 1
        bench.arm.chain.survey()
        assert bench.arm.torque == ("on" if servo_id == 61 else "partly")
    bench.fault("missing 41")
    bench.arm.chain.survey()
    assert bench.arm.torque == "unknown"
    bench.fault("heal")
    bench.arm.chain.survey()
    assert bench.arm.torque == "on"


def test_a_check_forgets_what_was_commanded_unless_all_are_under_power(bench: Bench) -> None:
    bench.arm.enable_torque()
    bench.arm.check()
    assert bench.arm.commanded == pytest.approx(np.array(bench.robot.home_joints), abs=0.003)
    bench.servo(41).table["torque_enable"] = 0
    bench.arm.check()
    with pytest.raises(RuntimeError):
        _ = bench.arm.commanded


def test_a_check_of_a_bus_that_is_gone_says_so(bench: Bench) -> None:
    bench.bus.gone = True
    with pytest.raises(BusLost):
        bench.arm.check()


def test_the_posture_is_read_from_every_servo(bench: Bench) -> None:
    assert bench.arm.read_joints() == pytest.approx(bench.map.joints(HOME_COUNTS), abs=1e-12)
    assert [sent.servo_id for sent in told(bench.bus.sent)] == list(HOME_COUNTS)
    bench.fault("slip 41 20")
    assert bench.arm.read_joints()[3] == pytest.approx(bench.map.drives[3].angle(532))
