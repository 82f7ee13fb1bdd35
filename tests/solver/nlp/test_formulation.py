import casadi as ca
import numpy as np
import pytest

from solver import Robot
from solver.kinematics.forward import forward_kinematics
from solver.nlp.formulation import axes_error, build_programme, symbolic_pose
from tests.solver.kinematics.arms import arms


@pytest.mark.parametrize("arm", arms()[:5], ids=lambda arm: arm.name)
def test_symbolic_pose_is_the_numeric_one(arm: Robot) -> None:
    q, length = ca.SX.sym("q", 6), ca.SX.sym("l")
    pose = ca.Function("pose", [q, length], list(symbolic_pose(arm, q, length)))
    tool = arm.tools[0]
    for posture in np.random.default_rng(5).uniform(arm.lower, arm.upper, (20, 6)):
        place, turn = pose(posture, tool.length_m)
        expected = forward_kinematics(arm, tool, posture)
        np.testing.assert_allclose(np.array(place).ravel(), expected[:3, 3], atol=1e-12)
        np.testing.assert_allclose(np.array(turn), expected[:3, :3], atol=1e-12)


def test_axes_error_is_the_small_rotation() -> None:
    angle = 1e-3
    turned = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    error = np.array(ca.DM(ca.evalf(axes_error(ca.SX(turned), ca.SX.eye(3))))).ravel()
    np.testing.assert_allclose(error, (0, 0, -np.sin(angle)), atol=1e-12)


def test_built_once(tabletop: Robot) -> None:
    assert build_programme(tabletop, "l1") is build_programme(tabletop, "l1")
    assert build_programme(tabletop, "l1").slacks == 6
    assert build_programme(tabletop, "l2").slacks == 0
