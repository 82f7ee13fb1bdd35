import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hardware.servos.control_tables import ServoModel, servo_model, servo_models
from hardware.servos.units import (
    HIGHEST_SPEED,
    load_share,
    motor_angle,
    position_ticks,
    signed_value,
    speed_rad_s,
    speed_ticks,
    ticks_per_radian,
    voltage_v,
)

every_model = pytest.mark.parametrize("model", servo_models().values(), ids=lambda each: each.name)
FASTEST = speed_rad_s(HIGHEST_SPEED)


@pytest.mark.parametrize(
    ("name", "per_degree"),
    [("RX-28", 1023 / 300), ("RX-64", 1023 / 300), ("EX-106+", 4095 / 250.92)],
)
def test_ticks_in_a_degree(name: str, per_degree: float) -> None:
    per_radian = ticks_per_radian(servo_model(name))
    assert math.radians(1) * per_radian == pytest.approx(per_degree, rel=1e-12)


@every_model
def test_every_position_and_back(model: ServoModel) -> None:
    for ticks in range(model.highest_position + 1):
        assert position_ticks(model, motor_angle(model, ticks)) == ticks


@every_model
def test_positions_are_rounded_to_the_nearest(model: ServoModel) -> None:
    tick = motor_angle(model, 1)
    assert position_ticks(model, 7.4 * tick) == 7
    assert position_ticks(model, 7.6 * tick) == 8
    assert position_ticks(model, -0.6 * tick) == -1


@given(st.floats(0, FASTEST))
def test_a_speed_is_never_slower_than_asked_and_never_full_speed(asked: float) -> None:
    ticks = speed_ticks(asked)
    assert 1 <= ticks <= HIGHEST_SPEED
    assert speed_rad_s(ticks) >= asked * (1 - 1e-12)
    assert ticks == 1 or speed_rad_s(ticks - 1) < asked


def test_the_speed_unit() -> None:
    assert speed_rad_s(1) * 60 / math.tau == pytest.approx(0.111, rel=1e-12)


@pytest.mark.parametrize("speed", [-0.1, math.inf, math.nan, FASTEST * 1.001])
def test_what_is_no_speed(speed: float) -> None:
    with pytest.raises(ValueError, match="rad/s"):
        speed_ticks(speed)


@pytest.mark.parametrize(("raw", "value"), [(0, 0), (1024, 0), (300, 300), (1324, -300)])
def test_bit_10_is_the_sign(raw: int, value: int) -> None:
    assert signed_value(raw) == value


def test_load_and_voltage() -> None:
    assert load_share(1023) == 1
    assert load_share(2047) == -1
    assert voltage_v(160) == 16
