"""Ticks and SI units: the only place that knows both.

Positions count from 0 at the servo's clockwise end; the motor angle is that count in radians.
Speeds count in 0.111 rpm; 0 means full speed, so no conversion here ever returns it.
"""

import math
from typing import Final

from hardware.servos.control_tables import ServoModel

SPEED_UNIT_RAD_S: Final = 0.111 * 2 * math.pi / 60
HIGHEST_SPEED: Final = 1023
SIGN_BIT: Final = 1 << 10
LOAD_UNIT: Final = 1 / 1023


def ticks_per_radian(servo: ServoModel) -> float:
    """Position counts in a radian: 1023/300 a degree (RX), 4095/250.92 a degree (EX)."""
    return servo.highest_position / math.radians(servo.range_deg)


def position_ticks(servo: ServoModel, motor_angle_rad: float) -> int:
    """The count nearest to a motor angle; it may be outside 0 to `highest_position`."""
    return math.floor(motor_angle_rad * ticks_per_radian(servo) + 0.5)


def motor_angle(servo: ServoModel, ticks: float) -> float:
    """The motor angle at a count, or at a mean of counts [rad]."""
    return ticks / ticks_per_radian(servo)


def speed_ticks(speed_rad_s: float) -> int:
    """The smallest speed count that is not slower, at least 1 (0 would be full speed).

    Raises:
        ValueError: negative, not finite, or faster than the register can say.
    """
    if not 0 <= speed_rad_s < math.inf:
        raise ValueError(f"not a speed: {speed_rad_s} rad/s")
    ticks = max(1, math.ceil(speed_rad_s / SPEED_UNIT_RAD_S))
    if ticks > HIGHEST_SPEED:
        raise ValueError(f"{speed_rad_s:.3f} rad/s is faster than a servo can be told")
    return ticks


def speed_rad_s(ticks: int) -> float:
    """The speed that a count from 1 to 1023 commands [rad/s]."""
    return ticks * SPEED_UNIT_RAD_S


def signed_value(raw: int) -> int:
    """A present speed or load: ten bits of size, bit 10 set for clockwise (negative)."""
    size = raw & (SIGN_BIT - 1)
    return -size if raw & SIGN_BIT else size


def load_share(raw: int) -> float:
    """A present load as a share of the highest torque, -1 to 1; inferred by the servo."""
    return signed_value(raw) * LOAD_UNIT


def voltage_v(raw: int) -> float:
    """A present voltage [V]."""
    return raw / 10
