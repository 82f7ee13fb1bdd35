"""Strategies for postures and targets of the mechanism, and its methods' answers.

Nothing is excluded from the limits; `near` targets are drawn around the tips of postures, so that
many of them are in reach while their slides are at their ends, where theta has to leave 0.
"""

from hypothesis import strategies as st

from solver.comparison.strawberry.answer import Answer
from solver.comparison.strawberry.mechanism import (
    Point,
    Posture,
    forward_kinematics,
    load_mechanism,
)
from solver.comparison.strawberry.table_3 import table_3
from solver.problem.solution import Reason

MECHANISM = load_mechanism()
TARGETS = tuple(row.target for row in table_3())

postures = st.builds(Posture, *(st.floats(*span) for span in MECHANISM.limits))

reachable = postures.map(lambda posture: forward_kinematics(MECHANISM, posture))

_at_ends = st.builds(
    Posture,
    *(st.sampled_from(span) | st.floats(*span) for span in MECHANISM.limits[:3]),
    *(st.floats(*span) for span in MECHANISM.limits[3:]),
)

near = st.builds(
    lambda posture, dx, dy, dz: _moved(forward_kinematics(MECHANISM, posture), dx, dy, dz),
    _at_ends,
    *(st.floats(-0.02, 0.02) for _ in range(3)),
)


def _moved(point: Point, dx: float, dy: float, dz: float) -> Point:
    return point[0] + dx, point[1] + dy, point[2] + dz


def answered(answer: Answer | Reason) -> Answer:
    """The answer, which must not be a reason."""
    assert isinstance(answer, Answer), answer
    return answer
