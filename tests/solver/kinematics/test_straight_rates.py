import numpy as np
import pytest

from solver import Robot, load_robot
from solver.kinematics.forward import forward_kinematics, jacobian
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.kinematics.straight_rates import (
    between_rate_room,
    posture_rate_room,
    posture_rates,
    rows_rate_room,
)
from solver.tolerances import JOINT_RATE_RAD_M
from tests.solver.kinematics.arms import arms


def rates_by_jacobian(robot: Robot, q: np.ndarray) -> np.ndarray:
    tool = robot.tools[0]
    along = forward_kinematics(robot, tool, q)[:3, 2]
    return np.asarray(
        np.abs(np.linalg.solve(jacobian(robot, tool, q), np.concatenate((along, np.zeros(3)))))
    )


@pytest.mark.parametrize("arm", arms(), ids=lambda arm: arm.name)
def test_rates_are_those_of_the_jacobian(arm: Robot) -> None:
    geometry = wrist_geometry(arm, arm.tools[0])
    rng, fast, found = np.random.default_rng(3), 0, np.empty(6)
    for q in rng.uniform(arm.lower, arm.upper, (400, 6)):
        wanted = rates_by_jacobian(arm, q)
        posture_rates(geometry, q, found)
        if wanted.max() < 0.9 * JOINT_RATE_RAD_M:
            np.testing.assert_allclose(found, wanted, rtol=1e-7, atol=1e-9)
        room = posture_rate_room(geometry, q)
        assert (room >= 0) == (wanted.max() <= JOINT_RATE_RAD_M)
        fast += room < 0
    assert 0 < fast < 200


@pytest.mark.parametrize("joint", [2, 4])
def test_singular_postures_have_no_room_and_it_grows_smoothly_beside_them(joint: int) -> None:
    """A stretched elbow, a straight wrist: the room is finite there, and a sine beside it."""
    robot = load_robot("tabletop")
    geometry = wrist_geometry(robot, robot.tools[0])
    q = np.array([0.3, 0.7, -1.1, 0.4, 0.9, 0.2])
    straight = -geometry.offsets[joint] - (geometry.beta if joint == 2 else 0.0)
    rows = np.tile(q, (201, 1))
    rows[:, joint] = straight + np.linspace(-0.3, 0.3, 201)
    room = np.empty(len(rows))
    rows_rate_room(geometry, rows, room)
    assert np.isfinite(room).all()
    assert room[100] < 0
    assert room[[0, -1]].min() > 0
    assert np.abs(np.diff(room)[np.r_[0:90, 110:200]]).max() < 0.01


@pytest.mark.parametrize("joint", [0, 3, 5])
def test_half_a_turn_between_two_postures_is_no_room(joint: int) -> None:
    robot = load_robot("tabletop")
    geometry = wrist_geometry(robot, robot.tools[0])
    before = np.array([0.3, 0.7, -1.1, 0.4, 0.9, 0.2])
    after = before.copy()
    assert between_rate_room(geometry, before, after, 0.002) > 0
    after[joint] += 3.1
    assert between_rate_room(geometry, before, after, 0.002) < 0
