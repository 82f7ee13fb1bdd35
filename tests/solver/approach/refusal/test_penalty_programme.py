"""Small quadratic programmes with a penalty, by their conditions, and updates of curvature."""

import numpy as np
import pytest

from solver.approach.refusal.penalty_programme import lead, penalty_programme, reset, update


def drawn(seed: int, count: int) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(4, 4))
    hessian = root @ root.T + 0.5 * np.eye(4)
    return hessian, rng.normal(size=4), rng.normal(size=count), rng.normal(size=(count, 4))


def solved(
    hessian: np.ndarray, slope: np.ndarray, values: np.ndarray, gradients: np.ndarray,
    most: float, multipliers: np.ndarray, sweeps: int = 3000,
) -> np.ndarray:  # fmt: skip
    count, step = len(values), np.full(4, np.nan)
    penalty_programme(
        np.linalg.inv(hessian), slope, values, gradients, most, multipliers, step,
        np.full((count, 4), np.nan), np.full(count, np.nan), 1e-13, sweeps,
    )  # fmt: skip
    return step


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("most", [100.0, 0.3])
@pytest.mark.parametrize("warm", [False, True])
def test_a_step_meets_the_conditions_of_a_minimum(seed: int, most: float, warm: bool) -> None:
    """What is missing is paid for at the full price, what pushes is met, what does not is not."""
    hessian, slope, values, gradients = drawn(seed, 5)
    multipliers = np.abs(np.random.default_rng(seed).normal(size=5)) * warm
    step = solved(hessian, slope, values, gradients, most, multipliers)
    assert hessian @ step + slope - gradients.T @ multipliers == pytest.approx(
        np.zeros(4), abs=1e-9
    )
    left = values + gradients @ step
    assert np.all((multipliers >= 0.0) & (multipliers <= most))
    for room, price in zip(left, multipliers, strict=True):
        if room > 1e-7:
            assert price == 0.0
        elif room < -1e-7:
            assert price == most
    cost = _cost(hessian, slope, values, gradients, most, step)
    for change in np.random.default_rng(9).normal(0.0, 0.05, (50, 4)):
        assert cost <= _cost(hessian, slope, values, gradients, most, step + change) + 1e-9


def _cost(hessian, slope, values, gradients, most, step) -> float:  # type: ignore[no-untyped-def]
    missing = np.maximum(0.0, -(values + gradients @ step)).sum()
    return float(step @ hessian @ step / 2 + slope @ step + most * missing)


def test_no_sweep_leaves_the_step_that_the_given_multipliers_make() -> None:
    hessian, slope, values, gradients = drawn(7, 3)
    multipliers = np.array([0.5, 0.0, 0.25])
    step = solved(hessian, slope, values, gradients, 10.0, multipliers, sweeps=0)
    expected = np.linalg.solve(hessian, gradients.T @ multipliers - slope)
    assert step == pytest.approx(expected)
    assert multipliers.tolist() == [0.5, 0.0, 0.25]


def test_one_sweep_meets_each_in_its_turn() -> None:
    """Hildreth's: the last one is met exactly where only it pushes."""
    hessian, slope = np.diag([1.0, 2.0, 4.0, 8.0]), np.array([1.0, 2.0, 4.0, 8.0])
    gradients, values = np.array([[1.0, 1.0, 0, 0], [1.0, 0.0, 0, 0]]), np.array([3.0, 2.5])
    multipliers = np.zeros(2)
    step = solved(hessian, slope, values, gradients, 100.0, multipliers, sweeps=1)
    assert step.tolist() == [-1.0, -1.0, -1.0, -1.0]
    step = solved(hessian, slope, values - 2.0, gradients, 100.0, multipliers, sweeps=1)
    # The first is 1 short, over 1 + 1 / 2; that leaves the second with room.
    assert multipliers == pytest.approx([2 / 3, 0.0])
    assert step == pytest.approx([-1 / 3, -2 / 3, -1.0, -1.0])
    tight = np.zeros(2)
    solved(hessian, slope, values - 2.0, gradients, 0.5, tight, sweeps=1)
    assert tight == pytest.approx([0.5, 0.0])


def test_where_a_constraint_pushes() -> None:
    hessian, _, _, gradients = drawn(8, 3)
    inverse = np.linalg.inv(hessian)
    towards, curvature = np.full((3, 4), np.nan), np.full(3, np.nan)
    lead(inverse, gradients, 1, towards, curvature)
    assert towards[1] == pytest.approx(inverse @ gradients[1])
    assert curvature[1] == pytest.approx(gradients[1] @ inverse @ gradients[1])
    assert np.isnan(towards[[0, 2]]).all()
    lead(inverse, np.zeros((3, 4)), 1, towards, curvature)
    assert curvature[1] > 0.0


def test_the_first_curvature_weighs_a_radian_as_five_centimetres() -> None:
    hessian, inverse = np.full((4, 4), 9.0), np.full((4, 4), 9.0)
    reset(hessian, inverse)
    assert hessian == pytest.approx(np.diag([1.0, 1.0, 1.0, 0.05**2]))
    assert inverse == pytest.approx(np.diag([1.0, 1.0, 1.0, 1 / 0.05**2]))


@pytest.mark.parametrize("seed", range(5))
def test_an_update_is_bfgs_with_powell_s_damping(seed: int) -> None:
    hessian, step, _, _ = drawn(seed, 1)
    inverse, rng = np.linalg.inv(hessian), np.random.default_rng(seed)
    change = hessian @ step * rng.uniform(-1.0, 2.0) + 0.1 * rng.normal(size=4)
    curved, along = step @ hessian @ step, step @ change
    share = 1.0 if along >= 0.2 * curved else 0.8 * curved / (curved - along)
    damped = share * change + (1 - share) * (hessian @ step)
    towards = hessian @ step
    expected = hessian + np.outer(damped, damped) / (damped @ step)
    expected -= np.outer(towards, towards) / curved
    update(hessian, inverse, step, change)
    assert hessian == pytest.approx(expected)
    assert inverse == pytest.approx(np.linalg.inv(expected), rel=1e-8, abs=1e-10)
    assert hessian @ step == pytest.approx(damped)
    assert np.linalg.eigvalsh(hessian).min() > 0.0
    # No step tells nothing.
    kept = hessian.copy()
    update(hessian, inverse, np.zeros(4), np.ones(4))
    assert np.array_equal(hessian, kept)
