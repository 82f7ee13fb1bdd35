"""The solvers of quadratic programmes behind one function."""

import numpy as np
import pytest

from solver.methods.nlp.quadratic import QP_SOLVERS, solve_quadratic

# Minimise |x - (2, 1)|^2 / 2 with x1 <= 1 and x2 <= 3: (1, 1), multipliers (1, 0).
HESSIAN, GRADIENT = np.eye(2), np.array([-2.0, -1.0])
G, H = np.eye(2), np.array([1.0, 3.0])


@pytest.mark.parametrize("solver", QP_SOLVERS)
def test_minimiser_and_multipliers(solver: str) -> None:
    answer = solve_quadratic(HESSIAN, GRADIENT, G, H, solver)
    assert answer.found
    np.testing.assert_allclose(answer.x, (1.0, 1.0), atol=1e-8)
    np.testing.assert_allclose(answer.z, (1.0, 0.0), atol=1e-8)


@pytest.mark.parametrize("solver", QP_SOLVERS)
def test_limits_that_exclude_each_other_have_no_minimiser(solver: str) -> None:
    answer = solve_quadratic(
        HESSIAN, GRADIENT, np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([0.0, -1.0]), solver
    )
    assert not answer.found
    assert solver in answer.detail
