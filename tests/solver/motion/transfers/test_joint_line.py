import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from solver import load_robot
from solver.motion.transfers.joint_line import joint_line

ANGLES = st.lists(st.floats(-3.0, 3.0), min_size=6, max_size=6).map(np.array)


@given(ANGLES, ANGLES)
def test_it_joins_its_postures_and_is_as_long_as_they_are_apart(
    start: np.ndarray, standby: np.ndarray
) -> None:
    transfer = joint_line(load_robot("tabletop"), start, standby)
    assert np.array_equal(transfer.joints, [start, standby])
    assert transfer.length_rad == np.linalg.norm(standby - start)


def test_a_slide_has_no_length_in_angles() -> None:
    robot = load_robot("puma560_rail")
    start = np.array(robot.home_joints)
    moved = start + np.array([0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.4])
    assert np.isclose(joint_line(robot, start, moved).length_rad, 0.4)
