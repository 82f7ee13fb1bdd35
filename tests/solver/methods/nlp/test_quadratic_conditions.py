"""Karush, Kuhn and Tucker's conditions of random quadratic programmes, whatever solves them."""

from typing import Any

import numpy as np
import pytest
import qpsolvers

from solver.methods.nlp.quadratic import QP_SOLVERS, solve_quadratic


def drawn(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(4, 4))
    g = rng.normal(size=(7, 4))
    return root @ root.T + 0.1 * np.eye(4), rng.normal(size=4), g, rng.uniform(0.01, 0.4, 7)


@pytest.mark.parametrize("solver", QP_SOLVERS)
@pytest.mark.parametrize("seed", range(6))
def test_an_answer_is_a_minimiser(solver: str, seed: int) -> None:
    hessian, gradient, g, h = drawn(seed)
    answer = solve_quadratic(hessian, gradient, g, h, solver)
    assert (answer.found, answer.detail) == (True, "")
    room = h - g @ answer.x
    assert hessian @ answer.x + gradient + g.T @ answer.z == pytest.approx(np.zeros(4), abs=1e-8)
    assert np.all(room >= -1e-9)
    assert np.all(answer.z >= -1e-9)
    assert answer.z * room == pytest.approx(np.zeros(7), abs=1e-8)


@pytest.mark.parametrize("solver", QP_SOLVERS)
@pytest.mark.parametrize(
    "pinned", [0.0, 1e-9, 1.0], ids=["no room", "hardly any room", "room enough"]
)
def test_only_the_interior_point_method_is_given_room(
    monkeypatch: pytest.MonkeyPatch, solver: str, pinned: float
) -> None:
    """A hundredth of a micrometre, where there is less; what lies outside stays outside."""
    seen = []
    solve = qpsolvers.solve_problem

    def spying(problem: Any, *others: Any, **more: Any) -> Any:
        seen.append(np.asarray(problem.h))
        return solve(problem, *others, **more)

    monkeypatch.setattr(qpsolvers, "solve_problem", spying)
    h = np.array([pinned, 2.0, -0.5])
    g = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    answer = solve_quadratic(np.eye(2), np.array([-3.0, 0.0]), g, h, solver)
    given = np.array([max(pinned, 1e-8), 2.0, -0.5]) if solver == "piqp" else h
    assert seen[0].tolist() == given.tolist()
    assert h[0] == pinned
    assert answer.found
    assert answer.x == pytest.approx([pinned, 0.5], abs=2e-8)


@pytest.mark.parametrize(
    ("error", "detail"),
    [
        (ValueError("not today"), "daqp: not today"),
        (ZeroDivisionError("nor tomorrow"), "daqp: nor tomorrow"),
    ],
)
def test_errors_of_a_solver_are_told(
    monkeypatch: pytest.MonkeyPatch, error: Exception, detail: str
) -> None:
    def failing(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(qpsolvers, "solve_problem", failing)
    answer = solve_quadratic(*drawn(1), "daqp")
    assert (answer.found, answer.detail) == (False, detail)
    assert (answer.x.tolist(), answer.z.tolist()) == ([0.0] * 4, [0.0] * 7)


@pytest.mark.parametrize(
    ("found", "x", "z", "detail"),
    [
        (False, np.ones(4), np.ones(7), "daqp found no minimiser"),
        (True, None, np.ones(7), "daqp found no minimiser"),
        (True, np.ones(4), None, "daqp found no minimiser"),
        (True, np.full(4, np.nan), np.ones(7), "daqp returned numbers that are not finite"),
        (True, np.ones(4), np.full(7, np.inf), "daqp returned numbers that are not finite"),
    ],
)
def test_answers_that_are_none_are_told(
    monkeypatch: pytest.MonkeyPatch, found: bool, x: object, z: object, detail: str
) -> None:
    class Solution:
        pass

    Solution.found, Solution.x, Solution.z = found, x, z  # type: ignore[attr-defined]
    monkeypatch.setattr(qpsolvers, "solve_problem", lambda *_, **__: Solution())
    answer = solve_quadratic(*drawn(1), "daqp")
    assert (answer.found, answer.detail) == (False, detail)
