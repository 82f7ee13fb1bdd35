import casadi as ca
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solver import Robot
from solver.approach.task.relaxation import rotation
from solver.kinematics.forward import forward_kinematics
from solver.methods.nlp.formulation import Shape, axes_error, build_programme, symbolic_pose, turned
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


def number(expression: ca.SX) -> np.ndarray:
    return np.array(ca.DM(ca.evalf(expression))).ravel()


@given(st.floats(-3.0, 3.0))
def test_axes_error_is_zero_nowhere_but_at_the_wanted_frame(angle: float) -> None:
    error = number(axes_error(ca.SX(rotation(np.array([0.0, 0.0, angle]))), ca.SX.eye(3)))
    np.testing.assert_allclose(error, (0, 0, -2 * np.tan(angle / 2)), rtol=1e-9, atol=1e-12)


@given(st.tuples(*[st.floats(-1.5, 1.5)] * 3), st.tuples(*[st.floats(-1.0, 1.0)] * 3))
def test_turned_is_the_rotation_by_twice_the_arc_tangent(
    axis: tuple[float, float, float], vector: tuple[float, float, float]
) -> None:
    gibbs = np.array(axis)
    length = np.linalg.norm(gibbs)
    turn = gibbs * (2 * np.arctan(length) / length) if length > 0 else gibbs
    expected = rotation(turn) @ np.array(vector)
    found = number(turned(ca.SX(ca.DM(vector)), ca.SX(ca.DM(gibbs))))
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_built_once_and_relaxations_that_are_off_cost_no_variable(tabletop: Robot) -> None:
    plain = build_programme(tabletop, Shape("l1"))
    assert plain is build_programme(tabletop, Shape("l1"))
    assert (plain.kinematic, plain.slacks) == (13, 6)
    assert build_programme(tabletop, Shape("l2")).slacks == 0
    relaxed = build_programme(tabletop, Shape("l1", strike=True, tilt=True, rows=1, coupled=True))
    assert (relaxed.kinematic, relaxed.slacks, relaxed.equalities) == (18 + 1 + 1 + 2, 12, 18)
    assert relaxed.nlp["x"].numel() == relaxed.kinematic + relaxed.slacks
    assert relaxed.nlp["g"].numel() == relaxed.equalities + relaxed.inequalities
