"""The smallest displacement from one start, of constraints that are told, against SciPy's."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

from solver.approach.refusal import displacement_minimum as module
from solver.approach.refusal.displacement_constraints import Watched
from solver.approach.refusal.displacement_minimum import lagrangian_slope, minimise, violation
from solver.approach.refusal.penalty_programme import penalty_programme
from solver.approach.task.constraints import LIMITS
from tests.solver.interpreted import interpret, interpreted

Constraint = Callable[[np.ndarray], float]
FAR = np.full(4, math.inf)


def test_what_is_missing_is_added_up() -> None:
    values = np.array([0.1, -0.2, 0.0, -0.3, -9.0])
    assert violation(values, 4) == pytest.approx(0.5)
    assert violation(values, 1) == 0.0


def test_the_slope_of_the_lagrangian() -> None:
    """Of |delta|^2 / 2, which the angle has no part in, less what pushes."""
    x, gradients = np.array([0.1, 0.2, 0.3, 0.4]), np.arange(12.0).reshape(3, 4)
    slope = np.full(4, np.nan)
    lagrangian_slope(x, gradients, np.array([0.5, 0.0, 2.0]), 3, slope)
    expected = np.array([0.1, 0.2, 0.3, 0.0]) - 0.5 * gradients[0] - 2.0 * gradients[2]
    assert slope == pytest.approx(expected)
    lagrangian_slope(x, gradients, np.array([0.5, 0.0, 2.0]), 1, slope)
    assert slope == pytest.approx(np.array([0.1, 0.2, 0.3, 0.0]) - 0.5 * gradients[0])


class Told:
    """Constraints by functions of x, with slopes from differences; the rest is far from broken."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *functions: Constraint) -> None:
        self.functions, self.seen = functions, list[np.ndarray]()
        interpret(monkeypatch, module, constraints=self._constraints)

    def _constraints(self, task: Any, origin: Any, x: np.ndarray, turn: Any, branch: int,
                     watched: Any, scratch: Any, values: np.ndarray,
                     gradients: np.ndarray) -> None:  # fmt: skip
        self.seen.append(x.copy())
        values[:], gradients[:] = 1.0, 0.0
        for j, function in enumerate(self.functions):
            values[j] = function(x)
            for k, step in enumerate(1e-7 * np.eye(4)):
                gradients[j, k] = (function(x + step) - function(x - step)) / 2e-7

    def run(self, start: list[float], best: float = math.inf, known: np.ndarray = FAR,
            share: float = 1e-5, jumps: int = 0) -> tuple[float, np.ndarray]:  # fmt: skip
        watched = Watched(
            np.zeros(2, dtype=np.int64), 1, np.zeros(2, dtype=np.int64), jumps, 0, 0, 0
        )
        x = np.array(start)
        missing = interpreted(minimise)(None, None, x, None, 0, watched, known, best, share, None)
        assert LIMITS == 13
        return float(missing), x

    def best(self, start: list[float]) -> float:
        """The length that SciPy's method comes to."""
        rules = [{"type": "ineq", "fun": function} for function in self.functions]
        found = minimize(
            lambda x: float(x[:3] @ x[:3]) / 2, start, constraints=rules, tol=1e-14, method="SLSQP"
        )
        assert found.success
        return float(np.linalg.norm(found.x[:3]))


CASES: dict[str, tuple[Constraint, ...]] = {
    "plane": (lambda x: x[0] + 0.5 * x[1] - 0.03,),
    "two planes": (lambda x: x[0] - 0.02, lambda x: x[1] + x[2] - 0.03),
    "ball": (lambda x: 0.05 - math.hypot(*(x[:3] - np.array([0.1, 0.02, 0.0]))),),
    "turning": (lambda x: x[0] * math.cos(x[3]) + x[1] * math.sin(x[3]) - 0.03,
                lambda x: x[3] - 0.4, lambda x: 0.9 - x[3]),
    "bent": (lambda x: x[2] - 0.02 - 3 * x[0] ** 2 - 0.01 * math.sin(3 * x[3]),),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("start", [[0.05, 0.04, 0.03, 0.5], [0.0, 0.0, 0.0, 0.6]])
def test_the_shortest_displacement_that_meets_all(
    monkeypatch: pytest.MonkeyPatch, name: str, start: list[float]
) -> None:
    told = Told(monkeypatch, *CASES[name])
    missing, x = told.run(start)
    assert 0.0 <= missing <= 1e-5
    assert sum(max(0.0, -function(x)) for function in CASES[name]) <= 1e-5 + 1e-12
    length = float(np.linalg.norm(x[:3]))
    assert length <= told.best(start) * (1 + 2e-3) + 1e-5
    assert len(told.seen) < 80
    assert np.abs(np.diff([one[3] for one in told.seen[:2]])).max() <= 0.3 + 1e-12


def test_nothing_broken_needs_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch, lambda x: 1.0)
    missing, x = told.run([0.02, -0.01, 0.03, 0.2])
    assert missing == 0.0
    assert np.abs(x[:3]).max() < 1e-6
    assert x[3] == pytest.approx(0.2)


def test_what_leads_further_than_the_best_known_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a third; the length needed here is 0.0268."""
    told = Told(monkeypatch, *CASES["plane"])
    assert told.run([0.2, 0.1, 0.0, 0.0], best=0.03)[0] <= 1e-5
    assert told.run([0.2, 0.1, 0.0, 0.0], best=0.024)[0] <= 1e-5
    assert told.run([0.2, 0.1, 0.0, 0.0], best=0.018)[0] == math.inf


def test_what_leads_to_the_one_that_is_known_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """Within a hundredth of the best one's length; not before the fourth step."""
    told = Told(monkeypatch, *CASES["plane"])
    start, needed = [0.2, 0.1, 0.0, 0.0], np.array([0.024, 0.012, 0.0, 0.0])
    _, x = told.run(start)
    assert x == pytest.approx(needed, abs=1e-5)
    length = float(np.linalg.norm(x[:3]))
    assert told.run(start, best=length * 1.1, known=x)[0] <= 1e-5
    monkeypatch.setattr(module, "NEAREST_TRIAL_STEPS", 0)
    assert told.run(start, best=length * 1.1, known=x)[0] == math.inf
    beside = x + np.array([0.0, 0.0, 0.02 * length, 0.0])
    assert told.run(start, best=length * 1.1, known=beside)[0] <= 1e-5
    near = x + np.array([0.0, 0.0, 0.005 * length, 0.0])
    assert told.run(start, best=length * 1.1, known=near)[0] == math.inf


def test_constraints_that_exclude_each_other_are_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    told = Told(monkeypatch, lambda x: x[0] - 0.02, lambda x: -0.01 - x[0])
    missing, _ = told.run([0.05, 0.0, 0.0, 0.0])
    assert missing >= 0.03 - 1e-9


def test_rates_get_more_and_shorter_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a corner that no step gains on."""

    def corner(x: np.ndarray) -> float:
        return float(0.03 - abs(x[0] - 0.05) - 40 * abs(x[1] - 0.3 * x[0]))

    plain = Told(monkeypatch, corner)
    plain.run([0.4, -0.3, 0.0, 0.0])
    few = len(plain.seen)
    more = Told(monkeypatch, corner)
    more.run([0.4, -0.3, 0.0, 0.0], jumps=1)
    assert len(more.seen) >= few


def test_the_penalty_is_ten_times_the_start_and_two_centimetres(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[float] = []

    def spying(*given: Any) -> None:
        asked.append(float(given[4]))
        interpreted(penalty_programme)(*given)

    told = Told(monkeypatch, *CASES["plane"])
    monkeypatch.setattr(module, "penalty_programme", spying)
    for start in ([0.02, 0.03, 0.06, 0.5], [0.0, 0.0, 0.0, 0.5]):
        asked.clear()
        told.run(start)
        length = float(np.linalg.norm(start[:3]))
        assert asked == pytest.approx([10 * (length + 0.02)] * len(asked))
