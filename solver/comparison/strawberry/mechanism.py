"""The mechanism as data, its postures and forward kinematics.

Frame F0 of S: s21 slides along x, s10 along y, z is up and s32 lowers the arm. Metres and radians.
Equations (2) to (4) did not survive in the text and follow from its (7), (5) and (9):

    x = s21 + d_x - (l2 + l3 cos beta) sin theta
    y = s10 + l1 - d_y + l3 sin beta
    z = -s32 + d_z - (l2 + l3 cos beta) cos theta
"""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Any, Final, NamedTuple

import numpy as np

from solver.exceptions import InvalidRobot
from solver.robots.model import Array

NAME: Final = "strawberry"
"""What requests and scenarios call the mechanism."""

JOINT_NAMES: Final = ("s10", "s21", "s32", "theta", "beta")
"""Joints in the order of every posture; psi turns about the tip and moves it nowhere."""

Point = tuple[float, float, float]
"""x, y, z in the frame F0 [m]."""


class Span(NamedTuple):
    """A closed interval [m or rad]."""

    lower: float
    upper: float


class Posture(NamedTuple):
    """Joint values: slides in metres, then angles in radians."""

    s10_m: float
    s21_m: float
    s32_m: float
    theta_rad: float
    beta_rad: float


@dataclass(frozen=True)
class Unknown:
    """A number that S does not print: what is assumed, and what is known of it.

    Attributes:
        name: as S writes it.
        value: what is assumed, in `unit`.
        known: what S's other numbers say of it, and why this value.
    """

    name: str
    value: float
    unit: str
    known: str


@dataclass(frozen=True)
class Mechanism:
    """The mechanism's numbers, SI.

    Attributes:
        s10, s21, s32: range of each slide [m].
        theta, beta, psi: range of each angle [rad].
        l1_m, l2_m, l3_m: links [m].
        d_x_m, d_y_m, d_z_m: offsets, unknown [m].
        friction_n: friction of the sliders, mu W [N].
        lifted_n: weight of the arm, (m2 + m3) g [N].
        tip_weight_n: weight of its last links, m3 g, unknown [N].
        extra_height_m: h_extra above the canopy, unknown [m].
        unknowns: what of these is assumed.
    """

    name: str
    description: str
    source: str
    s10: Span
    s21: Span
    s32: Span
    theta: Span
    beta: Span
    psi: Span
    l1_m: float
    l2_m: float
    l3_m: float
    d_x_m: float
    d_y_m: float
    d_z_m: float
    friction_n: float
    lifted_n: float
    tip_weight_n: float
    extra_height_m: float
    unknowns: tuple[Unknown, ...]

    @property
    def limits(self) -> tuple[Span, ...]:
        """Limits in the order of a posture [m, m, m, rad, rad]."""
        return (self.s10, self.s21, self.s32, self.theta, self.beta)

    @property
    def reset(self) -> Posture:
        """Where every picking task starts and ends (S table 1, step 7)."""
        return Posture(self.s10.lower, self.s21.lower, self.s32.lower, 0.0, 0.0)


def forward_kinematics(mechanism: Mechanism, posture: Posture) -> Point:
    """The tip [m] (S equations 2 to 4, see above)."""
    m = mechanism
    reach = m.l2_m + m.l3_m * math.cos(posture.beta_rad)
    return (
        posture.s21_m + m.d_x_m - reach * math.sin(posture.theta_rad),
        posture.s10_m + m.l1_m - m.d_y_m + m.l3_m * math.sin(posture.beta_rad),
        -posture.s32_m + m.d_z_m - reach * math.cos(posture.theta_rad),
    )


def posture_at(mechanism: Mechanism, target: Point, theta_rad: float, beta_rad: float) -> Posture:
    """The posture with these angles whose tip is at the target; slides may be beyond their limits.

    S equations 13, 17 and 18, the last with the sign of d_z corrected.
    """
    m = mechanism
    reach = m.l2_m + m.l3_m * math.cos(beta_rad)
    return Posture(
        target[1] - m.l1_m + m.d_y_m - m.l3_m * math.sin(beta_rad),
        target[0] - m.d_x_m + reach * math.sin(theta_rad),
        -target[2] + m.d_z_m - reach * math.cos(theta_rad),
        theta_rad,
        beta_rad,
    )


def link_points(mechanism: Mechanism, posture: Posture) -> Array:
    """Carriage, C, D (shoulder), E (elbow) and P (tip) in F0, shape (5, 3) [m].

    The carriage is where the table's slides are; C is beside it by the unknown offsets, and D is l1
    further along y. Theta turns DE and EP about y, beta turns EP out of that plane.
    """
    m, q = mechanism, posture
    carriage = np.array((q.s21_m, q.s10_m, -q.s32_m))
    beside = carriage + np.array((m.d_x_m, -m.d_y_m, m.d_z_m))
    shoulder = beside + np.array((0.0, m.l1_m, 0.0))
    down = np.array((-math.sin(q.theta_rad), 0.0, -math.cos(q.theta_rad)))
    elbow = shoulder + m.l2_m * down
    bent = math.cos(q.beta_rad) * down + np.array((0.0, math.sin(q.beta_rad), 0.0))
    tip = elbow + m.l3_m * bent
    return np.array((carriage, beside, shoulder, elbow, tip))


@lru_cache(maxsize=1)
def load_mechanism() -> Mechanism:
    """The mechanism that ships, `mechanism.toml`.

    Raises:
        InvalidRobot: the file makes no sense.
    """
    return parse_mechanism(
        (resources.files("solver.comparison.strawberry") / "mechanism.toml").read_bytes()
    )


def parse_mechanism(document: bytes) -> Mechanism:
    """A mechanism from the bytes of its file.

    Raises:
        InvalidRobot: not TOML, fields missing or unknown, or values that make no sense.
    """
    try:
        data = tomllib.loads(document.decode())
        unknowns = tuple(Unknown(name, **entry) for name, entry in data.pop("unknown").items())
        assumed = {unknown.name: _si(unknown.value, unknown.unit) for unknown in unknowns}
        mechanism = Mechanism(
            **_spans(data.pop("limits")),
            **_lengths(data.pop("lengths")),
            **data.pop("forces"),
            d_x_m=assumed.pop("d_x"),
            d_y_m=assumed.pop("d_y"),
            d_z_m=assumed.pop("d_z"),
            tip_weight_n=assumed.pop("m3_g"),
            extra_height_m=assumed.pop("h_extra"),
            unknowns=unknowns,
            **data,
        )
        if assumed:
            raise ValueError(f"unknown fields: {', '.join(assumed)}")
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, KeyError, TypeError, ValueError) as error:
        raise InvalidRobot(f"the mechanism's file cannot be read: {error}") from error
    check_mechanism(mechanism)
    return mechanism


def check_mechanism(mechanism: Mechanism) -> None:
    """Raise InvalidRobot where the closed forms would not hold.

    They need beta between 0 and a right angle, where the reach l2 + l3 cos beta falls as sin beta
    rises, theta within a right angle of straight down, and straight down among its values.
    """
    m = mechanism
    numbers = [m.l1_m, m.d_x_m, m.d_y_m, m.d_z_m, *(end for span in m.limits for end in span)]
    if not all(math.isfinite(value) for value in numbers):
        raise InvalidRobot(f"{m.name}: a value that is not finite")
    if not all(span.lower < span.upper for span in (*m.limits, m.psi)):
        raise InvalidRobot(f"{m.name}: limits out of order")
    if m.beta.lower < 0.0 or not m.beta.upper < math.pi / 2:
        raise InvalidRobot(f"{m.name}: beta has to be from 0 to less than a right angle")
    if not -math.pi / 2 < m.theta.lower <= 0.0 <= m.theta.upper < math.pi / 2:
        raise InvalidRobot(f"{m.name}: theta has to hold 0 and stay within a right angle")
    if not (0.0 < m.l2_m < math.inf and 0.0 < m.l3_m < math.inf):
        raise InvalidRobot(f"{m.name}: l2 and l3 have to be above zero")
    if not (m.friction_n >= 0.0 and 0.0 <= m.tip_weight_n <= m.lifted_n < math.inf):
        raise InvalidRobot(f"{m.name}: forces have to be at least zero, m3 g at most (m2 + m3) g")
    if not 0.0 <= m.extra_height_m < math.inf:
        raise InvalidRobot(f"{m.name}: h_extra has to be at least zero")


def _spans(limits: Mapping[str, Any]) -> dict[str, Any]:
    spans: dict[str, Any] = {}
    for key, (lower, upper) in limits.items():
        name, _, unit = key.rpartition("_")
        spans[name] = Span(_si(lower, unit), _si(upper, unit))
    return spans


def _lengths(entries: Mapping[str, Any]) -> dict[str, Any]:
    return {f"{key.removesuffix('_mm')}_m": _si(value, "mm") for key, value in entries.items()}


def _si(value: float, unit: str) -> float:
    if unit == "mm":
        return value * 1e-3
    if unit == "deg":
        return math.radians(value)
    if unit == "N":
        return value
    raise ValueError(f"{unit!r} is no unit of this file")
