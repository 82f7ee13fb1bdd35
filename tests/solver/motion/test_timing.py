import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import load_robot
from solver.motion.rates import rate_ratios
from solver.motion.timing import TrapezoidalLaw, time_joint_line

ROBOT = load_robot("tabletop")
POSTURE = st.tuples(*(st.floats(low, up) for low, up in zip(ROBOT.lower, ROBOT.upper, strict=True)))


@given(
    distance=st.floats(1e-6, 10.0),
    velocity=st.floats(1e-3, 10.0),
    acceleration=st.floats(1e-3, 100.0),
)
def test_law_travels_the_distance_inside_its_limits(
    distance: float, velocity: float, acceleration: float
) -> None:
    law = TrapezoidalLaw(distance, velocity, acceleration)
    times = np.linspace(0.0, law.duration_s, 401)
    places = law.position(times)
    assert places[0] == 0.0
    assert places[-1] == pytest.approx(distance)
    assert (np.diff(places) >= -1e-12 * distance).all()
    speed, force = rate_ratios(
        times, places[:, None], np.array([velocity]), np.array([acceleration])
    )
    assert speed <= 1 + 1e-6
    assert force <= 1 + 1e-4


@given(start=POSTURE, end=POSTURE)
def test_joint_line_keeps_every_limit_and_uses_one_of_them(
    start: tuple[float, ...], end: tuple[float, ...]
) -> None:
    first, last = np.array(start), np.array(end)
    motion = time_joint_line(ROBOT, first, last, 0.02)
    np.testing.assert_array_equal(motion.joints[0], first)
    np.testing.assert_array_equal(motion.joints[-1], last)
    speed, force = rate_ratios(motion.times_s, motion.joints, ROBOT.velocity, ROBOT.acceleration)
    assert max(speed, force) <= 1 + 1e-6
    if np.abs(last - first).max() > 1e-3:
        assert max(speed, force) > 0.9
        assert np.diff(motion.times_s).max() <= 0.02 * (1 + 1e-6)


@pytest.mark.parametrize("travel", [2.3e-311, 1e-200, 1e-12, 1e-9, 1e-8])
def test_travel_next_to_nothing_has_a_time_too(travel: float) -> None:
    end = np.array([0.0, 0.0, 0.0, 0.0, 0.0, travel])
    motion = time_joint_line(ROBOT, np.zeros(6), end, 0.02)
    np.testing.assert_array_equal(motion.joints[-1], end)
    speed, force = rate_ratios(motion.times_s, motion.joints, ROBOT.velocity, ROBOT.acceleration)
    assert max(speed, force) <= 1 + 1e-6


def test_no_motion_is_one_row() -> None:
    motion = time_joint_line(ROBOT, np.zeros(6), np.zeros(6), 0.02)
    assert motion.duration_s == 0.0
    assert motion.joints.shape == (1, 6)
