"""The pieces of the polish: parabolas, the chain in them, Newton's step, the linear system."""

import numpy as np
import pytest

from solver.problem.options import Norm
from solver.sequencing.batch import arc_postures
from solver.sequencing.polish import (
    _adapt_reach,
    _model_efforts,
    _model_minimum,
    _newton_step,
    _parabola,
    _parabolas,
    _shifted,
    _solve_tridiagonal,
    _stage_efforts,
    polished,
)
from solver.sequencing.tolerances import CHAIN_REACH_RAD, CHAIN_STILL_RAD
from tests.solver.sequencing.synthetic import batch, cost

N = 4


def model(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Parabolas of thinning and of what comes before, (3, 6, N); nothing moves before the first."""
    rng = np.random.default_rng(seed)
    thinning, before = rng.uniform(-1.0, 1.0, (2, 3, 6, N))
    # Postures bend little within the reach of a step.
    thinning[2] *= 0.2
    before[2] *= 0.2
    before[1:, :, 0] = 0.0
    return thinning, before


def plain(thinning: np.ndarray, before: np.ndarray, x: np.ndarray, *, squared: bool) -> np.ndarray:
    """The effort of each stage, joint by joint."""
    stages = np.zeros(N)
    for k in range(N):
        y = x[k - 1] if k else 0.0
        for i in range(6):
            here = sum(thinning[power, i, k] * x[k] ** power for power in range(3))
            there = sum(before[power, i, k] * y**power for power in range(3))
            stages[k] += (here - there) ** 2 if squared else abs(here - there)
    return stages


@pytest.mark.parametrize("squared", [False, True])
def test_the_model_is_the_effort_in_the_parabolas(squared: bool) -> None:
    thinning, before = model(1)
    x = np.array([0.1, -0.2, 0.3, 0.05])
    stages = np.empty(N)
    total = _model_efforts(thinning, before, x, squared, 0.0, stages)
    assert stages == pytest.approx(plain(thinning, before, x, squared=squared), rel=1e-13)
    assert total == pytest.approx(stages.sum(), rel=1e-14)
    rounded = np.empty(N)
    _model_efforts(thinning, before, x, squared, 0.5, rounded)
    assert np.all(rounded == stages) if squared else np.all(rounded > stages)
    assert _shifted(x).tolist() == [0.0, 0.1, -0.2, 0.3]


def test_a_rounded_norm_is_a_root_of_squares() -> None:
    thinning, before, stages = np.zeros((3, 6, 1)), np.zeros((3, 6, 1)), np.empty(1)
    thinning[0, 0, 0] = 3.0
    assert _model_efforts(thinning, before, np.zeros(1), False, 4.0, stages) == 5.0 + 5 * 4.0


def test_tridiagonal_systems_are_solved() -> None:
    rng = np.random.default_rng(2)
    for n in (1, 2, 7):
        middle, beside, right = 3.0 + rng.uniform(size=n), rng.uniform(-1, 1, n), rng.normal(size=n)
        matrix = np.diag(middle) + np.diag(beside[1:], 1) + np.diag(beside[1:], -1)
        expected = np.linalg.solve(matrix, right)
        _solve_tridiagonal(middle, beside, right)
        assert right == pytest.approx(expected, rel=1e-12)


def test_a_parabola_goes_through_its_points() -> None:
    def curve(x: float) -> float:
        return 0.3 - 1.2 * x + 2.5 * x * x

    off, e = 0.2, 0.25
    # Where it stands, and the three around the middle, which is `off` before it.
    values = np.array([curve(0.0), *(curve(-off + step) for step in (-e, 0.0, e))])
    coefficients = np.empty(3)
    _parabola(values, e, off, coefficients)
    assert coefficients == pytest.approx([0.3, -1.2, 2.5])
    _parabola(values, 0.0, 0.0, coefficients)
    assert coefficients.tolist() == [0.3, 0.0, 0.0]


@pytest.mark.parametrize("place", [0.0, 0.4, 1.0])
def test_parabolas_follow_the_postures(place: float) -> None:
    of = batch()
    low, high = of.arc_lower[2], of.arc_upper[2]
    angle = low + place * (high - low)
    thinning, standby = np.empty((3, 6)), np.empty((3, 6))
    _parabolas(of, 2, angle, thinning, standby)
    step = 2e-3 * (1 if place < 0.5 else -1)
    at, end = np.empty((6, 2)), np.empty((6, 2))
    arc_postures(of, np.array([2, 2]), np.array([angle, angle + step]), at, end)
    for coefficients, rows in ((thinning, at), (standby, end)):
        assert coefficients[0] == pytest.approx(rows[:, 0], abs=1e-14)
        moved = coefficients[0] + step * (coefficients[1] + step * coefficients[2])
        assert moved == pytest.approx(rows[:, 1], abs=1e-6)
        assert np.abs(moved - rows[:, 0]).max() > 1e-4


@pytest.mark.parametrize("squared", [False, True])
@pytest.mark.parametrize("seed", range(5))
def test_the_model_s_minimum_is_one(squared: bool, seed: int) -> None:
    """No small change of one angle, or of two neighbours, is cheaper in the parabolas."""
    thinning, before = model(seed)
    of = batch()._replace(arc_lower=np.full(N, -0.2), arc_upper=np.full(N, 0.25), squared=squared)
    reach = np.array([0.15, 1.0, 0.05, 1.0])
    x = _model_minimum(of, np.arange(N), np.zeros(N), thinning, before, reach, 0.1)
    low, high = np.maximum(-0.2, -reach), np.minimum(0.25, reach)
    assert np.all((low <= x) & (x <= high))
    least = plain(thinning, before, x, squared=squared).sum()
    assert least <= plain(thinning, before, np.zeros(N), squared=squared).sum()
    rng = np.random.default_rng(seed)
    for change in rng.normal(0.0, 1e-3, (300, N)) * rng.integers(0, 2, (300, N)):
        tried = np.clip(x + change, low, high)
        assert plain(thinning, before, tried, squared=squared).sum() >= least - 1e-6


@pytest.mark.parametrize("squared", [False, True])
def test_a_newton_step_gains_and_keeps_within_its_bounds(squared: bool) -> None:
    thinning, before = model(6)
    x, dual = np.zeros(N), np.zeros((6, N))
    low, high = np.full(N, -0.1), np.full(N, 0.1)
    efforts = [_model_efforts(thinning, before, x, squared, 0.05, np.empty(N))]
    gained = True
    while gained:
        gained = bool(_newton_step(thinning, before, x, dual, low, high, squared, 0.05))
        efforts.append(_model_efforts(thinning, before, x, squared, 0.05, np.empty(N)))
        assert np.all(np.abs(x) <= 0.1)
        assert np.all(np.abs(dual) <= 1.0)
        assert len(efforts) < 60
    assert efforts == sorted(efforts, reverse=True)
    assert efforts[-1] < efforts[0] - 1e-3
    assert len(efforts) < 20
    # It stands for r / sqrt(r^2 + mu^2), which away from zero is nearly a sign.
    assert squared or np.median(np.abs(dual)) > 0.5


def test_where_nothing_bends_one_step_of_squares_is_the_whole_way() -> None:
    thinning, before = model(7)
    thinning[2], before[2] = 0.0, 0.0
    x, free = np.zeros(N), np.full(N, np.inf)
    assert _newton_step(thinning, before, x, np.zeros((6, N)), -free, free, True, 0.0)
    least = plain(thinning, before, x, squared=True).sum()
    rng = np.random.default_rng(8)
    for change in rng.normal(0.0, 1e-3, (100, N)):
        assert plain(thinning, before, x + change, squared=True).sum() >= least - 1e-9


def test_reach_follows_the_errors_of_the_parabolas() -> None:
    reach = np.array([0.01, 0.01, 0.01, CHAIN_REACH_RAD, 0.01])
    errors = np.array([0.0, 0.0, 5.0, 0.0, 0.0])
    _adapt_reach(reach, errors, 1.0, True)
    # The second and the third angle take part in the stage that was wrong.
    assert reach.tolist() == [0.02, 0.0025, 0.0025, CHAIN_REACH_RAD, 0.02]
    _adapt_reach(reach, errors, 1.0, False)
    assert reach[1:3].tolist() == [0.0025, 0.0025]
    for _ in range(40):
        _adapt_reach(reach, errors, 1.0, True)
    assert reach[1] == CHAIN_STILL_RAD
    assert reach[0] == CHAIN_REACH_RAD


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_polished_angles_are_a_minimum_of_the_true_effort(norm: Norm) -> None:
    of = batch(norm)
    arcs = np.array([0, 2, 5])
    begun = (of.arc_lower + 0.7 * (of.arc_upper - of.arc_lower))[arcs]
    found, effort = polished(of, arcs, begun)

    def true(angles: np.ndarray) -> float:
        stages = np.empty(3)
        _stage_efforts(of, arcs, angles, stages)
        thinning, standby = np.empty((6, 3)), np.empty((6, 3))
        arc_postures(of, arcs, angles, thinning, standby)
        before = np.column_stack((of.start, standby[:, :2]))
        total = cost(thinning - before, squared=norm == "l2")
        assert stages.sum() == pytest.approx(total, rel=1e-13)
        return total

    assert effort == pytest.approx(true(found), rel=1e-13)
    assert effort < true(begun) - 1e-3
    low, high = of.arc_lower[arcs], of.arc_upper[arcs]
    assert np.all((low <= found) & (found <= high))
    rng = np.random.default_rng(3)
    for change in rng.normal(0.0, 1e-3, (40, 3)):
        assert true(np.clip(found + change, low, high)) >= effort - 1e-6
