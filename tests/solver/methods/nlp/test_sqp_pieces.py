"""Pieces of the sequential method: factorised equations, curvatures, derivatives."""

import numpy as np
import pytest

from solver.approach.optimum.on_arcs import best_on_arcs
from solver.methods.ncos import solve_on_arc
from solver.methods.nlp import sqp
from solver.methods.nlp.formulation import Shape, build_programme
from solver.methods.nlp.instance import make_instance
from solver.methods.nlp.sqp import _Evaluator, _factorised, _functions, _positive
from solver.methods.nlp.starts import start_at
from tests.solver.methods.synthetic import small_task


def test_steps_onto_the_equations_are_the_shortest() -> None:
    rng = np.random.default_rng(1)
    matrix, residual, gradient = rng.normal(size=(3, 7)), rng.normal(size=3), rng.normal(size=7)
    equations = _factorised(matrix)
    assert equations is not None
    expected = np.linalg.lstsq(matrix, -residual, rcond=None)[0]
    assert equations.shortest(residual) == pytest.approx(expected)
    balanced = np.linalg.lstsq(matrix.T, -gradient, rcond=None)[0]
    assert equations.multipliers(gradient) == pytest.approx(balanced)
    assert equations.z.shape == (7, 4)
    assert matrix @ equations.z == pytest.approx(np.zeros((3, 4)), abs=1e-12)
    assert equations.z.T @ equations.z == pytest.approx(np.eye(4))


@pytest.mark.parametrize(("size", "known"), [(1e-8, True), (1e-10, False), (0.0, False)])
def test_equations_that_hardly_differ_are_not_independent(size: float, known: bool) -> None:
    matrix = np.array([[1.0, 0.0, 0.0], [1.0, size, 0.0]])
    assert (_factorised(matrix) is not None) == known


def test_curvatures_are_mirrored_and_raised() -> None:
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(4, 4)))[0]
    found = _positive(turn @ np.diag([3.0, -2.0, 1e-5, 0.0]) @ turn.T)
    assert found == pytest.approx(turn @ np.diag([3.0, 2.0, 1e-3, 1e-3]) @ turn.T)
    lopsided = np.array([[2.0, 1.0], [0.0, 2.0]])
    assert _positive(lopsided) == pytest.approx(np.array([[2.0, 0.5], [0.5, 2.0]]))


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_derivatives_are_those_of_the_values(norm: str) -> None:
    """Central differences, on a programme of the arm; answers of one call outlive the next."""
    task = small_task(0, norm=norm, strike_zone_m=0.02, tilt_tolerance_rad=0.2)
    programme = build_programme(task.robot, Shape(norm, strike=True, tilt=True))
    start = start_at(task, 1, 2, np.asarray(task.thinning_joints(0.1, 1, 2)))
    instance = make_instance(task, programme, start)
    evaluator = _Evaluator(_functions(task.robot, programme.shape), instance)
    rng = np.random.default_rng(3)
    x = instance.x0 + rng.normal(0.0, 0.05, len(instance.x0))
    multipliers = rng.normal(size=programme.equalities + programme.inequalities)

    def lagrangian(at: np.ndarray) -> np.ndarray:
        gradient, jacobian, _ = evaluator.derivatives(at, multipliers)
        return gradient + jacobian.T @ multipliers

    cost, constraints = evaluator.values(x)
    slopes = [part.copy() for part in evaluator.derivatives(x, multipliers)]
    again = evaluator.values(x)
    assert again[0] == cost
    assert again[1].tolist() == constraints.tolist()
    for i in range(len(x)):
        step = np.zeros(len(x))
        step[i] = 1e-5
        ahead, behind = evaluator.values(x + step), evaluator.values(x - step)
        assert slopes[0][i] == pytest.approx((ahead[0] - behind[0]) / 2e-5, abs=1e-6)
        assert slopes[1][:, i] == pytest.approx((ahead[1] - behind[1]) / 2e-5, abs=1e-6)
        bent = (lagrangian(x + step) - lagrangian(x - step)) / 2e-5
        assert slopes[2][:, i] == pytest.approx(bent, abs=1e-5)


def test_two_solves_share_no_numbers() -> None:
    task = small_task(0)
    best = best_on_arcs(task)
    assert best is not None
    first, second = solve_on_arc(task, best), solve_on_arc(task, best)
    assert first.x.tolist() == second.x.tolist()
    assert first.x is not second.x
    assert sqp._functions(task.robot, Shape("l1")) is sqp._functions(task.robot, Shape("l1"))
