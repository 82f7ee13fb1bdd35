"""Costs and constraints of a programme at any numbers, against rotations and poses in NumPy."""

import itertools

import casadi as ca
import numpy as np
import pytest

from solver import Robot, load_robot
from solver.approach.task.relaxation import rotation
from solver.kinematics.forward import forward_kinematics
from solver.methods.nlp.formulation import Programme, Shape, build_programme
from tests.solver.methods.synthetic import ROBOT

RAIL = load_robot("puma560_rail")
HALF = 0.1
SHAPES = [
    Shape(norm, strike, tilt, rows, coupled)
    for norm, strike, tilt, rows, coupled in itertools.product(
        ("l1", "l2"), (False, True), (False, True), (0, 1), (False, True)
    )
]


class Numbers:
    """Random variables and parameters of a programme, by name."""

    def __init__(self, robot: Robot, shape: Shape) -> None:
        rng = np.random.default_rng(7)
        n, postures = len(robot.joints), 2 + shape.rows
        self.q = rng.uniform(-1.0, 1.0, (postures, n))
        self.phi, self.sigma, self.eta = (
            rng.uniform(-0.6, 0.6, 4)[[0]],
            0.4,
            rng.uniform(-0.6, 0.6, 2),
        )
        self.slacks = rng.uniform(0.0, 2.0, n * (1 + shape.coupled) * (shape.norm == "l1"))
        self.position = rng.uniform(-0.5, 0.5, 3)
        frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        self.y, self.u = frame[0], frame[1]
        self.v = np.cross(self.y, self.u)
        self.reference, self.following = rng.uniform(-1.0, 1.0, (2, n))
        self.weights, self.retreats = rng.uniform(0.5, 2.0, n), rng.uniform(0.0, 0.1, postures)
        self.tool, self.zone = 0.07, 0.03
        parts = [self.q.ravel(), self.phi]
        parts += [np.array([self.sigma])] if shape.strike else []
        parts += [self.eta] if shape.tilt else []
        self.x = np.concatenate((*parts, self.slacks))
        self.p = np.concatenate(
            (self.position, self.y, self.u, self.v, self.reference, self.following, self.weights,
             self.retreats, [self.tool, self.zone, np.tan(HALF)])
        )  # fmt: skip

    def wanted(self, shape: Shape) -> tuple[np.ndarray, float]:
        """Axes of the tool and how far it is beyond the target."""
        y, z = self.y, np.cos(self.phi) * self.u + np.sin(self.phi) * self.v
        if shape.tilt:
            gibbs = np.tan(HALF) * (self.eta[0] * self.u + self.eta[1] * self.v)
            length = np.linalg.norm(gibbs)
            turn = rotation(gibbs * (2 * np.arctan(length) / length))
            y, z = turn @ y, turn @ z
        beyond = self.zone * self.sigma if shape.strike else 0.0
        return np.column_stack((np.cross(y, z), y, z)), beyond


def values(programme: Programme, numbers: Numbers) -> tuple[float, np.ndarray]:
    nlp = programme.nlp
    cost, g = ca.Function("both", [nlp["x"], nlp["p"]], [nlp["f"], nlp["g"]])(numbers.x, numbers.p)
    return float(cost), np.array(g).ravel()


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_every_equation_and_inequality_is_what_the_task_says(shape: Shape) -> None:
    programme, numbers = build_programme(ROBOT, shape), Numbers(ROBOT, shape)
    _, g = values(programme, numbers)
    axes, beyond = numbers.wanted(shape)
    tool = ROBOT.tools[0]
    expected = []
    for q, retreat in zip(numbers.q, numbers.retreats, strict=True):
        pose = forward_kinematics(ROBOT, tool, q)
        place = pose[:3, 3] + (numbers.tool - tool.length_m) * pose[:3, 2]
        expected += (place - (numbers.position + (beyond - retreat) * axes[:, 2])).tolist()
        turn = axes @ pose[:3, :3].T
        # The rotation from one to the other, 2 tan(angle / 2) along its axis.
        skew = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
        expected += (2 * skew / (1 + np.trace(turn))).tolist()
    assert programme.equalities == len(expected)
    if shape.tilt:
        expected.append(1.0 - float(numbers.eta @ numbers.eta))
    slacks = numbers.slacks.reshape(-1, 6)
    ends = [numbers.q[0] - numbers.reference, numbers.q[1] - numbers.following]
    for slack, change in zip(slacks, ends, strict=False):
        expected += [*(slack - change), *(slack + change)]
    assert g == pytest.approx(np.array(expected), abs=1e-9)
    assert programme.inequalities == len(g) - programme.equalities


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_the_cost_is_the_weighted_travel_of_its_norm(shape: Shape) -> None:
    programme, numbers = build_programme(ROBOT, shape), Numbers(ROBOT, shape)
    cost, _ = values(programme, numbers)
    ends = [numbers.q[0] - numbers.reference, numbers.q[1] - numbers.following]
    if shape.norm == "l1":
        expected = float((numbers.weights * numbers.slacks.reshape(-1, 6)).sum())
    else:
        expected = sum(float(numbers.weights @ change**2) for change in ends[: 1 + shape.coupled])
    assert cost == pytest.approx(expected)
    count = 2 if shape.coupled else 1
    of = [k * 6 + i for k in range(count) for i in range(6)] if shape.norm == "l1" else []
    assert programme.slack_of.tolist() == of
    assert programme.slacks == len(of)


def test_places_of_the_variables() -> None:
    programme = build_programme(ROBOT, Shape("l1", strike=True, tilt=True, rows=1))
    assert (programme.postures, programme.angle, programme.joints) == (3, 18, 6)
    assert programme.kinematic == 18 + 1 + 1 + 2


def test_a_rail_stands_still_along_the_cut_in() -> None:
    shape = Shape("l2", rows=1)
    programme, numbers = build_programme(RAIL, shape), Numbers(RAIL, shape)
    _, g = values(programme, numbers)
    still = g[programme.equalities - 2 : programme.equalities]
    assert still == pytest.approx(numbers.q[1:, 0] - numbers.q[0, 0])
    assert programme.equalities == 3 * 6 + 2
    assert build_programme(ROBOT, shape).equalities == 3 * 6


def test_a_turned_flange_turns_the_tool() -> None:
    """A robot whose flange is rolled, and links whose twist is a quarter turn to rounding."""
    from solver.methods.nlp.formulation import symbolic_pose
    from tests.solver.kinematics.arms import arms

    for arm in arms():
        q, length = ca.SX.sym("q", len(arm.joints)), ca.SX.sym("l")
        pose = ca.Function("pose", [q, length], list(symbolic_pose(arm, q, length)))
        posture = np.random.default_rng(8).uniform(arm.lower, arm.upper)
        place, turn = pose(posture, arm.tools[0].length_m)
        expected = forward_kinematics(arm, arm.tools[0], posture)
        np.testing.assert_allclose(np.array(place).ravel(), expected[:3, 3], atol=1e-12)
        np.testing.assert_allclose(np.array(turn), expected[:3, :3], atol=1e-12)
