"""The one verifier of the mechanism's answers. It believes no number of a method."""

import math
from dataclasses import dataclass

from solver.comparison.strawberry.answer import Answer
from solver.comparison.strawberry.index import energy_index
from solver.comparison.strawberry.mechanism import (
    JOINT_NAMES,
    Mechanism,
    Point,
    forward_kinematics,
)
from solver.comparison.strawberry.tolerances import LIMIT_EXCESS_M
from solver.tolerances import EFFORT_ERROR_RELATIVE, LIMIT_EXCESS_RAD, POSITION_ERROR_M
from solver.verification.verdict import Residual, Verification


@dataclass(frozen=True)
class Verified:
    """What was recomputed from a target and a posture.

    Attributes:
        verification: `position_m`, an excess of each joint (below zero: inside), `index_error_j`.
        index_j: the index with Table 3's sign [J].
        margin: smallest distance of a joint to its limit [m for slides, rad for angles].
    """

    verification: Verification
    index_j: float
    margin: float


def verify_answer(mechanism: Mechanism, target: Point, answer: Answer) -> Verified:
    """Recompute position, limits and index of an answer; a number that is none is not accepted.

    The claimed index is compared with Table 3's, so an answer that minimised another index than it
    is judged by is not accepted either.
    """
    posture = answer.posture
    off = math.dist(forward_kinematics(mechanism, posture), target)
    residuals = [Residual("position_m", off, POSITION_ERROR_M)]
    excesses = []
    for name, value, span in zip(JOINT_NAMES, posture, mechanism.limits, strict=True):
        slide = name.startswith("s")
        excess = max(span.lower - value, value - span.upper)
        excesses.append(excess)
        residuals.append(
            Residual(
                f"{name}_excess_{'m' if slide else 'rad'}",
                excess,
                LIMIT_EXCESS_M if slide else LIMIT_EXCESS_RAD,
            )
        )
    index = energy_index(mechanism, posture)
    allowed = EFFORT_ERROR_RELATIVE * max(1.0, abs(index))
    residuals.append(Residual("index_error_j", abs(answer.index_j - index), allowed))
    return Verified(Verification(tuple(residuals)), index, -max(excesses))
