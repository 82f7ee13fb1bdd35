"""What is read from servos and what is written to them, register by register."""

import itertools
from dataclasses import replace

import pytest

from hardware.arm import servo_chain
from hardware.arm.servo_chain import ServoChain
from hardware.bus.bus import StatusReply
from hardware.bus.packets import READ, SYNC_WRITE, WRITE
from hardware.exceptions import (
    BusLost,
    CorruptPackets,
    ServoAlarm,
    ServoMissing,
    WrongSetting,
)
from hardware.servos.units import LOAD_UNIT, SIGN_BIT
from tests.hardware.parts import Bench, Sent, goals_sent, make_bench, told

IDS = (11, 21, 22, 31, 32, 41, 51, 61)
HOME_COUNTS = {11: 512, 21: 3516, 22: 579, 31: 512, 32: 511, 41: 512, 51: 819, 61: 512}


@pytest.fixture
def bench() -> Bench:
    return make_bench(noise_ticks=0)


@pytest.fixture
def chain(bench: Bench) -> ServoChain:
    return bench.arm.chain


# --- Reading --------------------------------------------------------------------------------------
def test_values_have_their_low_byte_first(bench: Bench, chain: ServoChain) -> None:
    motor = bench.map.motors[0]
    bench.servo(11).table["moving_speed"] = 0x0123
    assert chain.value(motor, "moving_speed") == 0x0123
    bench.servo(11).table["led"] = 1
    assert chain.value(motor, "led") == 1


def test_a_value_of_a_servo_in_alarm_or_away_is_none(bench: Bench, chain: ServoChain) -> None:
    bench.fault("voltage 11")
    with pytest.raises(ServoAlarm, match="servo 11") as caught:
        chain.value(bench.map.motors[0], "led")
    assert caught.value.errors
    bench.fault("missing 11")
    with pytest.raises(ServoMissing):
        chain.value(bench.map.motors[0], "led")


def test_a_sweep_reads_every_servo_once_in_joint_order(bench: Bench, chain: ServoChain) -> None:
    assert chain.sweep() == pytest.approx(HOME_COUNTS, abs=0)
    assert [sent.servo_id for sent in told(bench.bus.sent)] == list(IDS)
    assert {sent.instruction for sent in told(bench.bus.sent)} == {READ}


def test_what_a_sweep_has_said_stays_as_it_was(bench: Bench, chain: ServoChain) -> None:
    first = chain.sweep()
    bench.fault("slip 41 30")
    second = chain.sweep()
    assert first[41] == HOME_COUNTS[41]
    assert second[41] == HOME_COUNTS[41] + 30
    first.clear()
    assert chain.last_posture() is not None


def test_a_joint_is_read_as_counts_of_its_first_servo(bench: Bench, chain: ServoChain) -> None:
    bench.fault("slip 32 -5")
    pair = bench.map.drives[2]
    assert chain.read_drive(pair) == (512, 1023 - (511 - 5))
    assert [sent.servo_id for sent in told(bench.bus.sent)] == [31, 32]
    assert chain.read_drive(bench.map.drives[0]) == (512,)


@pytest.mark.parametrize("servo_id", [21, 22, 61])
def test_an_alarm_of_any_servo_is_raised(bench: Bench, chain: ServoChain, servo_id: int) -> None:
    bench.fault(f"overheat {servo_id}")
    with pytest.raises(ServoAlarm) as caught:
        chain.sweep()
    assert caught.value.servo_id == servo_id
    assert any(health.errors for health in chain.health() if health.id == servo_id)


def test_a_survey_has_those_that_answer_whatever_alarm_they_are_in(
    bench: Bench, chain: ServoChain
) -> None:
    bench.fault("voltage 31")
    bench.fault("missing 22")
    bench.fault("missing 61")
    expected = {key: value for key, value in HOME_COUNTS.items() if key not in (22, 61)}
    assert chain.survey() == expected
    assert list(chain.powered) == list(expected)
    # What was read before a servo went missing is not told again.
    bench.fault("heal")
    assert chain.survey() == HOME_COUNTS
    bench.fault("missing 22")
    assert 22 not in chain.survey()


def test_a_register_of_those_that_answer(bench: Bench, chain: ServoChain) -> None:
    bench.servo(41).table["moving_speed"] = 0x0203
    bench.fault("voltage 31")
    bench.fault("missing 22")
    bench.bus.simulated.corrupt_next = 1
    values = chain.values_of_what_answers("moving_speed")
    assert list(values) == [21, 31, 32, 41, 51, 61]
    assert values[41] == 0x0203
    assert values[31] == 0


def test_a_bus_that_is_gone_is_no_silence(bench: Bench, chain: ServoChain) -> None:
    bench.bus.gone = True
    with pytest.raises(BusLost):
        chain.survey()
    with pytest.raises(BusLost):
        chain.values_of_what_answers("led")
    with pytest.raises(BusLost):
        chain.sweep()


# --- Torque ---------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("enabled", "limit", "powered"), [(0, 0, False), (0, 1023, False), (1, 0, False), (1, 1, True)]
)
def test_under_power_is_enabled_with_a_torque_limit(
    bench: Bench, chain: ServoChain, enabled: int, limit: int, powered: bool
) -> None:
    bench.servo(51).table["torque_enable"] = enabled
    bench.servo(51).table["torque_limit"] = limit
    chain.sweep()
    assert chain.powered[51] is powered
    assert [health.torque for health in chain.health()] == [False] * 6 + [powered, False]


def test_of_a_servo_that_does_not_answer_power_is_not_known(
    bench: Bench, chain: ServoChain
) -> None:
    chain.sweep()
    assert set(chain.powered) == set(IDS)
    bench.fault("missing 41")
    chain.survey()
    assert set(chain.powered) == set(IDS) - {41}
    # The others are as they were last; of a bus that is gone nothing is known.
    bench.bus.gone = True
    with pytest.raises(BusLost):
        chain.read_drive(bench.map.drives[0])
    assert dict(chain.powered) == {}


# --- What every servo said last -------------------------------------------------------------------
def test_health_is_what_the_servo_said_in_si_units(bench: Bench, chain: ServoChain) -> None:
    table = bench.servo(41).table
    table["present_voltage"] = 153
    table["present_temperature"] = 41
    bench.bus.retries = {41: 3}
    bench.fault("slip 41 100")
    chain.sweep()
    health = {one.id: one for one in chain.health()}
    assert tuple(health) == IDS
    assert health[41].joint == "joint_4"
    assert health[41].voltage_v == pytest.approx(15.3)
    assert health[41].temperature_c == 41
    assert health[41].retries == 3
    assert health[41].errors == ()
    assert health[41].position_rad == pytest.approx(bench.map.drives[3].angle(612))
    assert health[41].load_share == 0.0
    assert health[11].retries == 0
    assert health[11].read_at.endswith("Z")


def test_load_is_signed(bench: Bench, chain: ServoChain) -> None:
    replies = {11: 300, 41: SIGN_BIT | 200}
    real = bench.bus.read

    def read(servo_id: int, address: int, size: int) -> StatusReply:
        reply = real(servo_id, address, size)
        load = replies.get(servo_id, 0).to_bytes(2, "little")
        assert (address, size) == (24, 20)
        return replace(reply, data=reply.data[:16] + load + reply.data[18:])

    bench.bus.read = read  # type: ignore[method-assign]
    chain.sweep()
    loads = {one.id: one.load_share for one in chain.health()}
    assert loads[11] == pytest.approx(300 * LOAD_UNIT)
    assert loads[41] == pytest.approx(-200 * LOAD_UNIT)


def test_both_servos_of_a_pair_tell_the_joints_angle(bench: Bench, chain: ServoChain) -> None:
    """Counts of partners run backwards; angles are of the joint, with noise of half a count."""
    bench.fault("slip 22 60")
    chain.sweep()
    angles = {one.id: one.position_rad for one in chain.health()}
    home = bench.robot.home_joints
    assert angles[21] == pytest.approx(home[1], abs=0.001)
    assert angles[22] == pytest.approx(bench.map.drives[1].angle(3516 - 60))
    assert angles[31] == pytest.approx(angles[32])
    assert angles[32] == pytest.approx(home[2], abs=0.003)


def test_the_posture_is_as_old_as_its_oldest_read(
    bench: Bench, chain: ServoChain, monkeypatch: pytest.MonkeyPatch
) -> None:
    instants = (f"instant {k:02d}" for k in itertools.count())
    monkeypatch.setattr(servo_chain, "timestamp", lambda: next(instants))
    assert chain.last_posture() is None
    for drive in bench.map.drives[:-1]:
        chain.read_drive(drive)
        assert chain.last_posture() is None
    chain.read_drive(bench.map.drives[-1])
    posture = chain.last_posture()
    assert posture is not None
    assert posture[0] == pytest.approx(bench.robot.home_joints, abs=0.003)
    assert posture[1] == "instant 00"
    chain.read_drive(bench.map.drives[0])
    posture = chain.last_posture()
    assert posture is not None
    assert posture[1] == "instant 01"


@pytest.mark.parametrize(("counts", "possible"), [(1023, True), (1024, False), (0xFFFF, False)])
def test_where_no_servo_can_stand_is_no_reading(
    bench: Bench, chain: ServoChain, counts: int, possible: bool
) -> None:
    chain.sweep()
    real = bench.bus.read

    def read(servo_id: int, address: int, size: int) -> StatusReply:
        reply = real(servo_id, address, size)
        data = reply.data[:12] + counts.to_bytes(2, "little") + reply.data[14:]
        return replace(reply, data=data) if servo_id == 51 else reply

    bench.bus.read = read  # type: ignore[method-assign]
    found = chain.survey()
    assert found.get(51) == (counts if possible else None)
    assert (51 in chain.powered) == possible
    if not possible:
        with pytest.raises(CorruptPackets, match=f"{counts}") as caught:
            chain.read_drive(bench.map.drives[4])
        assert caught.value.servo_id == 51


# --- Writing --------------------------------------------------------------------------------------
def test_goals_and_speeds_go_to_all_in_one_packet(bench: Bench, chain: ServoChain) -> None:
    chain.send({11: 0x0123, 61: 7}, {11: 0x0145, 61: 9})
    assert goals_sent(bench.bus.sent) == [{11: (0x0123, 0x0145), 61: (7, 9)}]
    assert len(bench.bus.sent) == 1
    assert bench.servo(11).table["goal_position"] == 0x0123
    assert bench.servo(11).table["moving_speed"] == 0x0145


def test_torque_is_enabled_and_read_back(bench: Bench, chain: ServoChain) -> None:
    chain.enable_torque(bench.map.motors[5])
    assert [sent.instruction for sent in told(bench.bus.sent)] == [WRITE, READ]
    assert {(sent.servo_id, sent.address) for sent in told(bench.bus.sent)} == {(41, 24)}
    assert bench.servo(41).table["torque_enable"] == 1
    assert bench.servo(51).table["torque_enable"] == 0


def test_torque_that_does_not_come_on_is_named(bench: Bench, chain: ServoChain) -> None:
    bench.bus.write = lambda *_: StatusReply(b"", ())  # type: ignore[method-assign]
    with pytest.raises(WrongSetting, match="torque_enable reads 0 after 1 was written") as caught:
        chain.enable_torque(bench.map.motors[5])
    assert caught.value.servo_id == 41


def test_a_servo_that_answers_with_an_alarm_is_not_asked_further(
    bench: Bench, chain: ServoChain
) -> None:
    bench.fault("voltage 41")
    with pytest.raises(ServoAlarm):
        chain.enable_torque(bench.map.motors[5])
    assert told(bench.bus.sent) == [Sent(41, WRITE, 24, {})]


@pytest.mark.parametrize(("found", "holds"), [(41, False), (42, True), (43, False)])
def test_a_register_holds_exactly_what_was_written(
    bench: Bench, chain: ServoChain, found: int, holds: bool
) -> None:
    bench.servo(51).table["moving_speed"] = found
    if holds:
        chain.expect(bench.map.motors[6], "moving_speed", 42)
    else:
        with pytest.raises(WrongSetting, match=f"servo 51.*moving_speed reads {found} after 42"):
            chain.expect(bench.map.motors[6], "moving_speed", 42)
    assert SYNC_WRITE not in {sent.instruction for sent in told(bench.bus.sent)}
