"""The choice of theta: least absolute value in the set S_theta (S 14 to 16, remark 2).

At a reach L = l2 + l3 cos beta and a target (x, z), with slides within their limits,

    sin theta in [k_lower, k_upper] / L     k = s21 + d_x - x at both ends of s21       (S 14)
    cos theta in [c_lower, c_upper] / L     c = d_z - z - s32 at both ends of s32       (S 15)

each clipped to [-1, 1], which S leaves out, and theta of either sign in the second: S prints the
positive half alone. The chosen theta is 0, or the end of a set that keeps it from 0; of two that
are equally far from 0 the negative one, which brings s21 nearer to its reset.
"""

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

from solver.comparison.strawberry.mechanism import Mechanism, Point

STRAIGHT: Final = "straight"
"""Case: theta is 0."""

CASE_1: Final = "case 1"
"""Case: s21 stands at a limit and sin theta = k / L (S 27)."""

CASE_2: Final = "case 2"
"""Case: s32 stands at its lower limit and cos theta = c / L (S 28)."""


class Choice(NamedTuple):
    """Which case the choice is, and its theta at other reaches as well.

    Attributes:
        case: STRAIGHT, CASE_1 or CASE_2.
        offset_m: k in case 1, c in case 2, else 0 [m].
        sign: of theta in case 2, else 1.
    """

    case: str
    offset_m: float = 0.0
    sign: float = 1.0

    def theta(self, reach_m: float) -> float:
        """Theta at a reach L [rad]."""
        if self.case is STRAIGHT:
            return 0.0
        ratio = max(-1.0, min(1.0, self.offset_m / reach_m))
        return math.asin(ratio) if self.case is CASE_1 else self.sign * math.acos(ratio)


_STRAIGHT = Choice(STRAIGHT)


@dataclass(frozen=True, slots=True)
class AngleSets:
    """What bounds theta for one target (see above) [m], and its own limits [rad]."""

    k_lower: float
    k_upper: float
    c_lower: float
    c_upper: float
    theta_lower: float
    theta_upper: float

    def choose(self, reach_m: float) -> Choice | None:
        """The choice at a reach L [m]; None where S_theta is empty."""
        k_lower, k_upper, c_upper = self.k_lower, self.k_upper, self.c_upper
        if k_lower > reach_m or k_upper < -reach_m or self.c_lower > reach_m or c_upper < -reach_m:
            return None
        bent = math.acos(c_upper / reach_m) if c_upper < reach_m else 0.0
        if k_lower <= 0.0 <= k_upper and bent == 0.0:
            return _STRAIGHT
        lower = math.asin(k_lower / reach_m) if k_lower > -reach_m else -math.pi / 2
        upper = math.asin(k_upper / reach_m) if k_upper < reach_m else math.pi / 2
        most = math.acos(self.c_lower / reach_m) if self.c_lower > -reach_m else math.pi
        negative = min(upper, -bent)
        positive = max(lower, bent)
        has_negative = max(lower, -most, self.theta_lower) <= negative
        has_positive = positive <= min(upper, most, self.theta_upper)
        if has_negative and not (has_positive and positive < -negative):
            if upper < -bent:
                return Choice(CASE_1, k_upper)
            return Choice(CASE_2, c_upper, -1.0)
        if not has_positive:
            return None
        return Choice(CASE_1, k_lower) if lower > bent else Choice(CASE_2, c_upper)

    def case_changes(self) -> tuple[float, ...]:
        """Every reach at which the choice may change from one case to another or to none [m]."""
        slides, lifts = (self.k_lower, self.k_upper), (self.c_lower, self.c_upper)
        found = [*map(abs, slides), *map(abs, lifts)]
        found += [math.hypot(k, c) for k in slides for c in lifts]
        for limit in (self.theta_lower, self.theta_upper):
            if limit != 0.0:
                found += [k / math.sin(limit) for k in slides]
            found += [c / math.cos(limit) for c in lifts]
        return tuple(found)


def angle_sets(mechanism: Mechanism, target: Point) -> AngleSets:
    """The bounds of theta for a target."""
    m = mechanism
    return AngleSets(
        m.s21.lower + m.d_x_m - target[0],
        m.s21.upper + m.d_x_m - target[0],
        m.d_z_m - target[2] - m.s32.upper,
        m.d_z_m - target[2] - m.s32.lower,
        m.theta.lower,
        m.theta.upper,
    )
