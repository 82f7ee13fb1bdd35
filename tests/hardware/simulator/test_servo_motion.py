import math
from collections import Counter

import pytest

from hardware.servos.control_tables import servo_model, servo_models
from hardware.servos.units import signed_value, speed_rad_s, ticks_per_radian
from hardware.simulator import SimulatedBus, SimulatedServo
from tests.hardware.simulator.conftest import Client, HandClock, MakeClient

models = pytest.mark.parametrize("model", sorted(servo_models()))


def ticks_per_second(model: str, speed: int) -> float:
    return speed_rad_s(speed) * ticks_per_radian(servo_model(model))


def full_speed(model: str) -> float:
    kind = servo_model(model)
    return kind.no_load_rpm * math.tau / 60 * ticks_per_radian(kind)


def go(client: Client, goal: int, speed: int) -> None:
    client.write(1, "moving_speed", speed)
    client.write(1, "goal_position", goal)


@models
@pytest.mark.parametrize("direction", [1, -1])
def test_turns_at_the_commanded_speed_and_stops_at_the_goal(
    make_client: MakeClient, clock: HandClock, model: str, direction: int
) -> None:
    client = make_client(1, model=model)
    go(client, 512 + 200 * direction, speed=50)
    arrival_s = 200 / ticks_per_second(model, 50)
    for share in (0.25, 0.5, 0.75):
        clock.now_s = share * arrival_s
        assert client.bus.servos[0].position == pytest.approx(512 + share * 200 * direction)
        assert client.read(1, "moving") == 1
        assert signed_value(client.read(1, "present_speed")) == 50 * direction
        assert signed_value(client.read(1, "present_load")) * direction > 0
    clock.now_s = arrival_s + 1
    assert client.read(1, "present_position") == 512 + 200 * direction
    assert client.read(1, "moving") == 0
    assert client.read(1, "present_speed") == 0
    assert client.read(1, "present_load") == 0


@models
@pytest.mark.parametrize("speed", [0, 1023])
def test_never_faster_than_without_load(
    make_client: MakeClient, clock: HandClock, model: str, speed: int
) -> None:
    client = make_client(1, model=model, position=0)
    go(client, 1000, speed)
    clock.pass_s(0.05)
    assert client.bus.servos[0].position == pytest.approx(0.05 * full_speed(model))
    assert ticks_per_second(model, 1023) > full_speed(model)


def test_how_often_one_looks_changes_nothing(make_client: MakeClient, clock: HandClock) -> None:
    often, seldom = make_client(1), make_client(1)
    for client in (often, seldom):
        go(client, 900, speed=30)
    for _ in range(50):
        clock.pass_s(0.01)
        often.read(1, "present_position")
    assert often.bus.servos[0].position == pytest.approx(seldom.bus.servos[0].position)
    assert 512 < often.bus.servos[0].position < 900


def test_torque_off_does_not_move(make_client: MakeClient, clock: HandClock) -> None:
    client = make_client(1)
    go(client, 900, speed=30)
    clock.pass_s(0.5)
    client.write(1, "torque_enable", 0)
    stopped = client.bus.servos[0].position
    clock.pass_s(10)
    assert client.bus.servos[0].position == stopped
    assert client.read(1, "moving") == 0
    # The goal is stale now, and enabling torque goes for it.
    client.write(1, "torque_enable", 1)
    clock.pass_s(100)
    assert client.read(1, "present_position") == 900


def test_torque_limit_0_does_not_move(make_client: MakeClient, clock: HandClock) -> None:
    client = make_client(1)
    client.write(1, "torque_limit", 0)
    go(client, 900, speed=30)
    clock.pass_s(10)
    assert client.read(1, "present_position") == 512


def test_a_goal_switches_the_torque_on(make_client: MakeClient) -> None:
    client = make_client(1)
    client.write(1, "moving_speed", 30)
    assert client.read(1, "torque_enable") == 0
    client.write(1, "goal_position", 512)
    assert client.read(1, "torque_enable") == 1


def test_a_new_goal_counts_from_where_the_servo_is(
    make_client: MakeClient, clock: HandClock
) -> None:
    client = make_client(1)
    go(client, 900, speed=30)
    clock.pass_s(1)
    half_way = client.bus.servos[0].position
    client.write(1, "goal_position", 100)
    clock.pass_s(1)
    assert client.bus.servos[0].position == pytest.approx(512)
    assert half_way == pytest.approx(512 + ticks_per_second("RX-64", 30))


def test_a_new_speed_holds_from_then_on(make_client: MakeClient, clock: HandClock) -> None:
    client = make_client(1)
    go(client, 1000, speed=30)
    clock.pass_s(1)
    client.write(1, "moving_speed", 60)
    clock.pass_s(1)
    expected = 512 + ticks_per_second("RX-64", 30) + ticks_per_second("RX-64", 60)
    assert client.bus.servos[0].position == pytest.approx(expected)


def test_positions_are_read_to_the_nearest_tick(clock: HandClock) -> None:
    bus = SimulatedBus([SimulatedServo(1, servo_model("RX-64"), 512.6, clock)])
    assert Client(bus).read(1, "present_position") == 513


def test_endless_turn_stands_still(make_client: MakeClient, clock: HandClock) -> None:
    client = make_client(1)
    client.write(1, "ccw_angle_limit", 0)
    assert client.write(1, "goal_position", 900) == 0
    clock.pass_s(10)
    assert client.read(1, "present_position") == 512


def test_noise_is_even_and_seeded_outside(clock: HandClock) -> None:
    noise = iter([-1, 0, 1, 5])
    servo = SimulatedServo(1, servo_model("RX-64"), 1022.0, clock, lambda: next(noise))
    client = Client(SimulatedBus([servo]))
    seen = [client.read(1, "present_position") for _ in range(4)]
    assert Counter(seen) == Counter({1021: 1, 1022: 1, 1023: 2})


def test_power_cycle_keeps_the_place_and_the_settings(
    make_client: MakeClient, clock: HandClock
) -> None:
    client = make_client(1)
    client.write(1, "max_torque", 700)
    go(client, 900, speed=30)
    assert client.read(1, "torque_limit") == 1023
    clock.pass_s(1)
    client.bus.servos[0].power_cycle()
    place = client.read(1, "present_position")
    assert place == round(512 + ticks_per_second("RX-64", 30))
    clock.pass_s(10)
    assert client.read(1, "present_position") == place
    assert client.read(1, "goal_position") == place
    assert client.read(1, "torque_enable") == 0
    assert client.read(1, "torque_limit") == client.read(1, "max_torque") == 700
    assert client.read(1, "moving_speed") == 0
