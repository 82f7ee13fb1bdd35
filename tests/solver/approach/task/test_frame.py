import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from solver.approach.task.frame import approach_frame, signed_angle

COORDINATE = st.floats(-1.0, 1.0)
VECTOR = st.tuples(COORDINATE, COORDINATE, COORDINATE)


@given(position=VECTOR, direction=VECTOR, angle=st.floats(-4.0, 4.0), side=st.sampled_from((1, -1)))
def test_axes_are_a_right_handed_frame_with_y_along_the_branch(
    position: tuple[float, ...], direction: tuple[float, ...], angle: float, side: int
) -> None:
    assume(np.linalg.norm(direction) > 1e-6)
    frame = approach_frame(position, direction)
    axes = frame.axes(angle, side)
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    np.testing.assert_allclose(
        axes[:, 1], side * np.array(direction) / np.linalg.norm(direction), atol=1e-9
    )


def test_zero_is_straight_out_and_a_quarter_turn_is_b_cross_u() -> None:
    frame = approach_frame((0.3, 0.0, 0.2), (0.0, 0.0, 7.0))
    np.testing.assert_allclose(frame.direction(0.0), (1.0, 0.0, 0.0), atol=1e-15)
    np.testing.assert_allclose(frame.direction(math.pi / 2), (0.0, 1.0, 0.0), atol=1e-15)


@pytest.mark.parametrize(
    ("position", "direction", "outward"),
    [
        ((0.3, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        ((0.0, 0.0, 0.3), (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)),
        ((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    ],
)
def test_branch_through_the_base_takes_world_z_then_x(
    position: tuple[float, ...], direction: tuple[float, ...], outward: tuple[float, ...]
) -> None:
    np.testing.assert_allclose(approach_frame(position, direction).outward, outward, atol=1e-12)


def test_direction_may_have_any_length() -> None:
    for length in (1e-8, 1.0, 1e200):
        frame = approach_frame((0.2, 0.1, 0.3), (length, -length, 0.0))
        np.testing.assert_allclose(frame.branch, np.array([1, -1, 0]) / math.sqrt(2), atol=1e-12)


@given(st.floats(-50.0, 50.0))
def test_signed_angle_is_in_the_half_open_turn(angle: float) -> None:
    turned = signed_angle(angle)
    assert -math.pi < turned <= math.pi
    assert math.cos(turned) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(turned) == pytest.approx(math.sin(angle), abs=1e-9)


def test_half_turn_is_positive() -> None:
    assert signed_angle(-math.pi) == math.pi
    assert signed_angle(math.pi) == math.pi
