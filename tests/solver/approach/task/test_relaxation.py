"""A pose put together from angle, strike and swing is taken apart into them again."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver.approach.task.frame import approach_frame
from solver.approach.task.relaxation import placement, rotation, shortened

FRAME = approach_frame((0.2, -0.1, 0.4), (-1.0, 0.3, 1.0))
POSITION = np.array([0.2, -0.1, 0.4])


@given(
    st.floats(-3.1, 3.1),
    st.floats(-0.05, 0.05),
    st.floats(-math.pi, math.pi),
    st.floats(0.0, 1.5),
    st.sampled_from((1, -1)),
)
def test_taken_apart_into_what_it_was_made_of(
    angle: float, strike: float, turn: float, tilt: float, side: int
) -> None:
    swing = tilt * (math.cos(turn) * FRAME.outward + math.sin(turn) * FRAME.sideways)
    pose = np.eye(4)
    pose[:3, :3] = rotation(swing) @ FRAME.axes(angle, side)
    pose[:3, 3] = POSITION + strike * pose[:3, 2]
    seen = placement(FRAME, POSITION, side, pose)
    assert seen.approach_angle_rad == pytest.approx(angle, abs=1e-9)
    assert seen.strike_m == pytest.approx(strike, abs=1e-12)
    assert seen.tilt_rad == pytest.approx(tilt, abs=1e-9)
    np.testing.assert_allclose(seen.swing_rad, swing, atol=1e-9)


def test_shortened_keeps_the_direction_and_what_is_short_enough() -> None:
    vector = np.array([3.0, 0.0, 4.0])
    np.testing.assert_allclose(shortened(vector, 1.0), (0.6, 0.0, 0.8))
    assert shortened(vector, 5.0) is vector
    assert not shortened(vector, 0.0).any()


def test_rotation_turns_by_the_length_of_its_vector() -> None:
    np.testing.assert_allclose(
        rotation(np.array([0.0, 0.0, math.pi / 2])) @ (1.0, 0.0, 0.0), (0, 1, 0), atol=1e-15
    )
    np.testing.assert_array_equal(rotation(np.zeros(3)), np.eye(3))
