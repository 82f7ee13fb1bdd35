import numpy as np
import pytest

from solver import load_robot
from solver.kinematics.families.on_rail import split_rail
from solver.kinematics.families.registry import family_of
from solver.kinematics.forward import forward_kinematics
from tests.solver.kinematics.arms import ur5

ROBOT = load_robot("puma560_rail")


def test_the_arm_at_a_position_is_the_robot_there() -> None:
    rail = split_rail(ROBOT)
    assert rail is not None
    assert rail.axis == pytest.approx((0.0, 1.0, 0.0), abs=1e-15)
    q = np.random.default_rng(31).uniform(ROBOT.lower, ROBOT.upper, (20, 7))
    for row in q:
        arm = rail.arm_at(float(row[0]))
        np.testing.assert_allclose(
            forward_kinematics(arm, arm.tools[0], row[1:]),
            forward_kinematics(ROBOT, ROBOT.tools[0], row),
            atol=1e-12,
        )
    assert split_rail(load_robot("puma560")) is None
    assert family_of(ur5(), ur5().tools[0]).rail_of(ur5()) is None
