"""The sequential method on programmes whose answers and steps are known by hand."""

from typing import Any

import casadi as ca
import numpy as np
import pytest

from solver.methods.nlp import sqp
from solver.methods.nlp.instance import Instance
from solver.methods.nlp.quadratic import QuadraticAnswer
from solver.methods.nlp.sqp import _Search, solve_by_sqp
from tests.solver.methods.nlp.toys import toy


def circle(x: Any) -> Any:
    return x[0] ** 2 + x[1] ** 2 - 1


def nothing(x: Any) -> Any:
    return x[1]


def solved(instance: Instance) -> tuple[np.ndarray, int]:
    result = solve_by_sqp(None, instance, "daqp")  # type: ignore[arg-type]
    assert (result.success, result.status) == (True, "solved")
    return result.x, result.iterations


def search(instance: Instance) -> _Search:
    return _Search(None, instance, "daqp")  # type: ignore[arg-type]


def status_of(instance: Instance) -> str:
    result = solve_by_sqp(None, instance, "daqp")  # type: ignore[arg-type]
    assert not result.success
    return result.status


@pytest.mark.parametrize("start", [(1.0, 0.0), (0.0, 1.0), (0.6, -0.8), (0.9, 0.9)])
def test_the_nearest_point_of_a_circle(
    monkeypatch: pytest.MonkeyPatch, start: tuple[float, float]
) -> None:
    instance = toy(monkeypatch, lambda x: (x[0] - 2) ** 2 + (x[1] - 1) ** 2, circle, start)
    x, iterations = solved(instance)
    assert x == pytest.approx(np.array([2.0, 1.0]) / np.sqrt(5), abs=1e-9)
    assert iterations <= 9


def test_where_it_begins_at_the_optimum_it_ends_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    start = np.array([2.0, 1.0]) / np.sqrt(5)
    instance = toy(monkeypatch, lambda x: (x[0] - 2) ** 2 + (x[1] - 1) ** 2, circle, start)
    assert solved(instance)[1] == 1


@pytest.mark.parametrize("upper", [0.5, 0.7])
def test_a_limit_holds_the_answer(monkeypatch: pytest.MonkeyPatch, upper: float) -> None:
    instance = toy(
        monkeypatch, lambda x: (x[0] - 2) ** 2 + (x[1] - 1) ** 2, circle, (0.0, 1.0),
        (-2.0, [upper, 2.0]),
    )  # fmt: skip
    x, _ = solved(instance)
    assert x == pytest.approx([upper, np.sqrt(1 - upper**2)], abs=1e-9)
    assert x[0] <= upper


@pytest.mark.parametrize("weights", [(1.0, 2.0), (3.0, 1.0), (1.0, 1.0)])
@pytest.mark.parametrize("start", [(0.0, 1.0), (1.0, 0.0), (0.6, 0.8)])
def test_a_weighted_travel_on_a_circle_ends_in_one_of_its_kinks(
    monkeypatch: pytest.MonkeyPatch, weights: tuple[float, float], start: tuple[float, float]
) -> None:
    """A start without travel in a joint is none to divide by."""
    references = (0.6, 0.5)
    instance = toy(
        monkeypatch, lambda x: 0.0 * x[0], circle, start, (-2.0, 2.0), weights, references
    )
    x, _ = solved(instance)
    kinks = [(0.6, 0.8), (np.sqrt(0.75), 0.5)]
    assert min(np.abs(x[:2] - kink).max() for kink in kinks) < 1e-8
    turns = np.arctan2(x[1], x[0]) + np.array([-1e-4, 0.0, 1e-4])
    beside = weights @ np.abs([np.cos(turns) - 0.6, np.sin(turns) - 0.5])
    assert beside[1] < min(beside[0], beside[2])
    assert x[2:] == pytest.approx(np.abs(x[:2] - references), abs=1e-12)


def test_multipliers_balance_the_gradient_at_the_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    """Karush, Kuhn and Tucker's condition, for a limit that holds and slacks that count."""
    instance = toy(
        monkeypatch,
        lambda x: (x[0] - 2) ** 2 + x[1] ** 2 + x[2] ** 2, lambda x: x[0] + x[1] ** 2 - 1,
        (0.3, 0.5, 0.4), (-2.0, [0.8, 2.0, 2.0]), (0.1, 0.3, 0.2), (0.0, 0.1, 0.25),
    )  # fmt: skip
    state = search(instance)
    prices = [0.0]
    while (status := state.iterate()) is None:
        prices.append(max(prices[-1], 2 * float(np.linalg.norm(state.multipliers))))
        assert state.price == pytest.approx(prices[-1])
    assert (status, len(prices) > 2) == ("solved", True)
    x = state.point.x
    assert x[:2] == pytest.approx([0.8, np.sqrt(0.2)], abs=1e-8)
    gradient, jacobian, _ = state.evaluator.derivatives(x, state.multipliers)
    left = gradient + jacobian.T @ state.multipliers
    # At the first variable's limit the rest is what presses against it.
    assert left[0] < -1e-3
    assert left[1:] == pytest.approx(np.zeros(5), abs=1e-4)
    others, values = state.multipliers[1:], state.point.constraints[1:]
    assert np.all(others <= 1e-12)
    assert others * values == pytest.approx(np.zeros(6), abs=1e-6)


def test_multipliers_are_guessed_once_as_if_no_limit_held(monkeypatch: pytest.MonkeyPatch) -> None:
    instance = toy(
        monkeypatch, lambda x: x[0] ** 3, lambda x: ca.vertcat(x[0] + 2 * x[1] - 1), (0.5, 0.25),
        (-2.0, 2.0), (0.7, 0.2), (0.9, 0.1),
    )  # fmt: skip
    state = search(instance)
    guesses: list[Any] = []
    guess = state._guess_multipliers
    monkeypatch.setattr(state, "_guess_multipliers", lambda: guesses.append(guess()))
    guess()
    # Of x0^3 + 0.7 |x0 - 0.9| + 0.2 |x1 - 0.1|, by least squares.
    slope = np.array([3 * 0.25 - 0.7, 0.2])
    along = np.array([1.0, 2.0])
    assert state.multipliers[0] == pytest.approx(-(along @ slope) / (along @ along))
    assert not state.multipliers[1:].any()
    state.multipliers[:] = 0.0
    for _ in range(3):
        state.iterate()
    assert len(guesses) == 1


def test_steps_are_no_longer_than_half_and_whole_ones_are_tried_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    state = search(toy(monkeypatch, lambda x: -x[0], nothing, (0.0, 0.0)))
    for k in range(1, 6):
        assert state.iterate() is None
        assert state.point.x == pytest.approx([0.5 * k, 0.0], abs=1e-12)
    back = search(toy(monkeypatch, lambda x: x[0], nothing, (0.0, 0.0)))
    assert back.iterate() is None
    assert back.point.x == pytest.approx([-0.5, 0.0], abs=1e-12)


def test_a_step_that_gains_nothing_is_halved(monkeypatch: pytest.MonkeyPatch) -> None:
    """A wall behind 0.1, which half a unit and a quarter run into."""
    wall = toy(
        monkeypatch, lambda x: -x[0] + 1e3 * ca.fmax(x[0] - 0.2, 0.0) ** 2, nothing, (0.0, 0.0)
    )
    state = search(wall)
    assert state.iterate() is None
    assert state.point.x[0] == pytest.approx(0.125)
    x, _ = solved(wall)
    assert x[0] == pytest.approx(0.2 + 1 / 2e3, abs=1e-7)


def test_a_step_has_to_gain_a_share_of_what_it_promised(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ten thousandth: less is no gain."""
    for gain, expected in ((1.5e-4, 0.5), (0.5e-4, 0.25)):
        state = search(toy(monkeypatch, lambda x: -x[0], nothing, (0.0, 0.0)))
        values = state.evaluator.values

        def flattened(x: np.ndarray, share: float = gain, real: Any = values) -> Any:
            cost, constraints = real(x)
            return (cost if abs(x[0]) < 0.3 else -0.5 * share), constraints

        monkeypatch.setattr(state.evaluator, "values", flattened)
        assert state.iterate() is None
        assert state.point.x[0] == pytest.approx(expected)


def test_equations_out_of_reach_of_a_step_are_approached(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two units away, half a unit a step, whatever the cost says."""
    far = toy(monkeypatch, lambda x: 3 * x[0] + x[1] ** 2, lambda x: x[0] - 2, (0.0, 0.3))
    state = search(far)
    for k in range(1, 4):
        assert state.iterate() is None
        assert state.point.x[0] == pytest.approx(0.5 * k, abs=1e-5)
    assert solved(far)[0] == pytest.approx([2.0, 0.0], abs=1e-7)


def test_limits_that_exclude_the_equations_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    excluded = toy(monkeypatch, lambda x: x[1] ** 2, lambda x: x[0] - 2, (0.0, 0.3), (-1.0, 1.0))
    assert status_of(excluded) == "locally_infeasible"


def test_equations_that_say_nothing_where_it_stands_are_singular(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert status_of(toy(monkeypatch, lambda x: x[0], circle, (0.0, 0.0))) == "singular"


def failing(_: object, gradient: np.ndarray, *others: object) -> QuadraticAnswer:
    return QuadraticAnswer(False, np.zeros_like(gradient), np.zeros(9), "out of order")


def test_a_quadratic_programme_that_fails_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """Before the equations hold a step that repairs them is tried, which asks for one as well."""
    monkeypatch.setattr(sqp, "solve_quadratic", failing)
    for start in ((1.0, 0.0), (1.0, 0.5)):
        instance = toy(monkeypatch, lambda x: x[0], circle, start)
        assert status_of(instance) == "quadratic_programme_failed: out of order"


@pytest.mark.parametrize(
    ("start", "status"), [((1.0, 0.0), "line_search_failed"), ((1.0, 0.5), None)]
)
def test_where_no_share_of_a_step_gains_the_equations_are_repaired(
    monkeypatch: pytest.MonkeyPatch, start: tuple[float, float], status: str | None
) -> None:
    state = search(toy(monkeypatch, lambda x: (x[1] - 1) ** 2, circle, start))
    before = state.point.violation
    monkeypatch.setattr(state, "_search", lambda *_: False)
    assert state.iterate() == status
    assert (state.point.violation < 0.5 * before) == (status is None)


def test_twenty_shares_of_a_step_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    for start in ((1.0, 0.0), (1.0, 0.5)):
        state = search(toy(monkeypatch, lambda x: (x[1] - 1) ** 2, circle, start))
        tried: list[float] = []

        def worse(x: np.ndarray, step: np.ndarray, seen: Any = tried, of: Any = state) -> Any:
            seen.append(float(np.abs(step).max()))
            return of._at(np.array([9.0, 9.0]))

        monkeypatch.setattr(state, "_moved", worse)
        _, jacobian, _ = state.evaluator.derivatives(state.point.x, state.multipliers)
        equations = sqp._factorised(jacobian[:1].copy())
        assert equations is not None
        if start == (1.0, 0.0):
            monkeypatch.setattr(sqp, "SQP_CORRECTIONS", 0)
            assert not state._search(equations, np.array([0.0, 0.5]), -0.5)
        else:
            assert state._restore(jacobian) == "line_search_failed"
        assert len(tried) == 20
        assert np.array(tried[1:]) == pytest.approx(np.array(tried[:-1]) / 2)


def test_a_gain_below_rounding_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a cost of a million: 1e-8, from 1e-4 beside the least."""
    instance = toy(monkeypatch, lambda x: 1e6 + x[0] ** 2, nothing, (1e-4, 0.0))
    x, iterations = solved(instance)
    assert (iterations, x.tolist()) == (1, [1e-4, 0.0])
    beside = toy(monkeypatch, lambda x: 1e6 + x[0] ** 2, nothing, (1e-4, 2e-9))
    assert status_of(beside) == "stalled"
    # Of a cost of one it is a gain.
    assert solved(toy(monkeypatch, lambda x: 1 + x[0] ** 2, nothing, (1e-4, 0.0)))[1] > 1


def test_a_start_at_zero_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    instance = toy(monkeypatch, lambda x: ca.cosh(x[0] - 0.4) + x[0] ** 4, nothing, (0.0, 0.0))
    x, _ = solved(instance)
    assert np.sinh(x[0] - 0.4) + 4 * x[0] ** 3 == pytest.approx(0.0, abs=1e-6)
    assert x[0] > 0.2


def test_iterations_are_counted_and_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sqp, "SQP_ITERATIONS", 3)
    instance = toy(monkeypatch, lambda x: -x[0], nothing, (0.0, 0.0))
    result = solve_by_sqp(None, instance, "daqp")  # type: ignore[arg-type]
    assert (result.success, result.status, result.iterations) == (False, "iteration_limit", 3)
    assert result.x == pytest.approx([1.5, 0.0])


def test_from_a_maximum_it_goes_down(monkeypatch: pytest.MonkeyPatch) -> None:
    """Negative curvatures are mirrored: near a maximum a step leads away from it."""
    state = search(toy(monkeypatch, lambda x: ca.cos(x[0]), nothing, (0.05, 0.0)))
    assert state.iterate() is None
    assert state.point.x[0] == pytest.approx(0.05 + np.tan(0.05), abs=1e-9)
    x, _ = solved(toy(monkeypatch, lambda x: ca.cos(x[0]), nothing, (0.05, 0.0)))
    assert x[0] == pytest.approx(np.pi, abs=1e-6)
