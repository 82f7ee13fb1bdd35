import math
from dataclasses import replace

import numpy as np
import pytest

from hardware.bus.packets import BROADCAST_ID, PING, SYNC_WRITE, WRITE, instruction_packet
from hardware.exceptions import InvalidArm, OutsideLimits
from hardware.servos.joints import SYNC_CABLE, ArmMap
from hardware.simulator import simulated_arm
from solver import Robot
from tests.hardware.simulator.conftest import Answer, Client, HandClock, MakeClient

IDS = (11, 21, 22, 31, 32, 41, 51, 61)


def positions(client: Client) -> dict[int, float]:
    return {servo.servo_id: servo.position for servo in client.bus.servos}


def sync_goals(client: Client, goals: dict[int, int], speed: int = 100) -> None:
    shares = (
        bytes((servo_id,)) + goal.to_bytes(2, "little") + speed.to_bytes(2, "little")
        for servo_id, goal in goals.items()
    )
    assert client.ask(BROADCAST_ID, SYNC_WRITE, bytes((30, 4)) + b"".join(shares)) == []


def with_coupling(arm: ArmMap, joint: int, coupling: str) -> ArmMap:
    drives = list(arm.drives)
    drives[joint] = replace(drives[joint], coupling=coupling)
    return replace(arm, drives=tuple(drives))


def test_stands_where_it_is_put_with_its_ids(
    arm: ArmMap, tabletop: Robot, arm_client: Client
) -> None:
    assert tuple(positions(arm_client)) == IDS
    assert arm.joints(positions(arm_client)) == pytest.approx(tabletop.home_joints, abs=0.003)
    assert [arm_client.ask(each, PING) for each in IDS] == [[Answer(each, 0, b"")] for each in IDS]


def test_goes_where_goals_send_it(arm: ArmMap, arm_client: Client, clock: HandClock) -> None:
    q = [0.3, 1.0, -1.0, 0.5, 1.0, -0.4]
    sync_goals(arm_client, arm.goals(q))
    clock.pass_s(60)
    assert positions(arm_client) == arm.goals(q)
    assert arm.joints(positions(arm_client)) == pytest.approx(np.array(q), abs=0.003)


def test_calibration_counts(arm: ArmMap, clock: HandClock) -> None:
    first = replace(arm.drives[0], calibration_rad=math.radians(3))
    shifted = replace(arm, drives=(first, *arm.drives[1:]))
    start = [0.0] * 6
    plain = simulated_arm(arm, start, clock).servos[0].position
    assert simulated_arm(shifted, start, clock).servos[0].position - plain == 10


def test_mirrored_partners_have_goals_of_their_own(arm_client: Client, clock: HandClock) -> None:
    assert arm_client.read(22, "drive_mode") == 0
    sync_goals(arm_client, {21: 3000, 22: 1500})
    clock.pass_s(60)
    after = positions(arm_client)
    assert (after[21], after[22]) == (3000, 1500)


def test_a_partner_without_torque_is_carried_along(arm_client: Client, clock: HandClock) -> None:
    sync_goals(arm_client, {21: 3000})
    clock.pass_s(60)
    after = positions(arm_client)
    assert (after[21], after[22]) == (3000, 4095 - 3000)


@pytest.mark.parametrize("jammed", [21, 22])
def test_a_jam_of_either_partner_stops_the_joint(
    arm_client: Client, clock: HandClock, jammed: int
) -> None:
    servo = arm_client.bus.servo(jammed)
    assert servo is not None
    servo.faults.jammed = True
    before = positions(arm_client)
    sync_goals(arm_client, {21: 3000, 22: 1095})
    clock.pass_s(60)
    assert positions(arm_client) == before


def test_a_slave_on_a_sync_cable_follows_and_ignores_goals(
    arm: ArmMap, tabletop: Robot, clock: HandClock
) -> None:
    cabled = with_coupling(arm, 1, SYNC_CABLE)
    client = Client(simulated_arm(cabled, tabletop.home_joints, clock, noise_ticks=0))
    assert client.read(22, "drive_mode") == 2
    assert client.read(21, "drive_mode") == 0
    sync_goals(client, {21: 3000, 22: 2000}, speed=50)
    assert client.read(22, "torque_enable") == 0
    client.write(22, "moving_speed", 70)
    clock.pass_s(0.5)
    first, second = client.read(21, "present_speed"), client.read(22, "present_speed")
    assert abs(first - second) == 1024
    assert first % 1024 == 50
    clock.pass_s(60)
    assert (positions(client)[21], positions(client)[22]) == (3000, 1095)
    # Without the mode it is a servo like others.
    client.write(22, "drive_mode", 0)
    sync_goals(client, {22: 1500})
    clock.pass_s(60)
    assert (positions(client)[21], positions(client)[22]) == (3000, 1500)


def test_a_cable_needs_servos_that_have_one(arm: ArmMap, clock: HandClock) -> None:
    with pytest.raises(InvalidArm, match="RX-64 has no sync cable"):
        simulated_arm(with_coupling(arm, 2, SYNC_CABLE), [0.0] * 6, clock)


def test_starts_that_a_servo_cannot_have(arm: ArmMap, clock: HandClock) -> None:
    with pytest.raises(OutsideLimits, match="joint_6") as refused:
        simulated_arm(arm, [0, 0, 0, 0, 0, math.radians(151)], clock)
    assert refused.value.joint == "joint_6"


def test_noise_and_corruption_repeat_with_their_seed(arm: ArmMap, clock: HandClock) -> None:
    ask = instruction_packet(11, 2, bytes((36, 2))) * 200

    def heard(seed: int, noise_ticks: int = 1, corrupt_share: float = 0.3) -> bytes:
        bus = simulated_arm(arm, [0.0] * 6, clock, seed, noise_ticks)
        bus.corrupt_share = corrupt_share
        return bus.respond(ask)

    assert heard(1) == heard(1) != heard(2)
    readings = heard(1, corrupt_share=0)
    assert {readings[place : place + 8][5:7] for place in range(0, 1600, 8)} == {
        (arm.drives[0].ticks(0) + off).to_bytes(2, "little") for off in (-1, 0, 1)
    }
    assert len(set(heard(1, noise_ticks=0, corrupt_share=0))) <= 8


def test_packets_may_come_in_pieces(arm_client: Client) -> None:
    packet = instruction_packet(11, PING)
    heard = [arm_client.bus.respond(packet[place : place + 1]) for place in range(len(packet))]
    assert heard == [b""] * 5 + [instruction_packet(11, 0)]


def test_several_packets_in_one_piece(arm_client: Client) -> None:
    packets = instruction_packet(11, PING) + instruction_packet(9, PING)
    packets += instruction_packet(61, PING)
    assert arm_client.bus.respond(packets) == instruction_packet(11, 0) + instruction_packet(61, 0)


def test_a_sync_write_refused_by_one_servo_reaches_the_others(make_client: MakeClient) -> None:
    client = make_client(1, 2)
    client.write(1, "ccw_angle_limit", 600)
    sync_goals(client, {1: 700, 2: 700})
    assert client.read(1, "goal_position") == 512
    assert client.read(2, "goal_position") == 700


@pytest.mark.parametrize("parameters", [b"", b"\x19", b"\x19\x01", b"\x1e\x02\x01\x10"])
def test_sync_writes_without_their_data_do_nothing(
    make_client: MakeClient, parameters: bytes
) -> None:
    client = make_client(1)
    assert client.ask(BROADCAST_ID, SYNC_WRITE, parameters) == []
    assert client.read(1, "led") == 0
    assert client.read(1, "goal_position") == 512


def test_a_broken_sync_write_does_nothing(make_client: MakeClient) -> None:
    client = make_client(1)
    packet = bytearray(instruction_packet(BROADCAST_ID, SYNC_WRITE, bytes((25, 1, 1, 1))))
    packet[-1] ^= 1
    assert client.bus.respond(bytes(packet)) == b""
    assert client.read(1, "led") == 0


def test_two_servos_with_one_id_both_answer(make_client: MakeClient) -> None:
    client = make_client(1, 2)
    assert len(client.ask(2, WRITE, bytes((3, 1)))) == 1
    assert client.ask(1, PING) == [Answer(1, 0, b"")] * 2
