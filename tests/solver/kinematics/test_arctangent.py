import math

from hypothesis import assume, given
from hypothesis import strategies as st

from solver.compiled import kernel
from solver.kinematics.arctangent import atan2

COORDINATE = st.floats(-1e6, 1e6).filter(lambda value: value == 0 or abs(value) > 1e-150)


@kernel
def angle_of(y, x):  # type: ignore[no-untyped-def]
    return atan2(y, x)


@given(y=COORDINATE, x=COORDINATE)
def test_within_two_units_of_the_librarys(y: float, x: float) -> None:
    assume(x != 0 or y != 0)  # of nothing the library tells the sign of zero
    assert abs(angle_of(y, x) - math.atan2(y, x)) <= 1e-15


def test_of_nothing_it_is_zero() -> None:
    assert angle_of(0.0, 0.0) == 0.0
