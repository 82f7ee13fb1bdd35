import numpy as np

from solver.motion.rates import rate_ratios


def test_ratios_see_a_start_that_is_not_from_rest() -> None:
    times, rows = np.array([0.0, 1.0]), np.array([[0.0], [1.0]])
    assert rate_ratios(times, rows, np.array([0.5]), np.array([1.0])) == (2.0, 2.0)
