"""The effort of arrays, of kernels and of scaled postures is one effort."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from solver import Options, Problem, Robot
from solver.approach.task.feasibility import effort
from solver.approach.task.task import approach_task
from solver.compiled import kernel
from solver.problem.effort import cost_scale, joint_cost, joint_costs, posture_effort
from solver.problem.options import NORMS, Norm
from solver.robots.model import Array
from solver.sequencing.min_plus import chain_effort, relax
from tests.solver.problems import random_targets

POSTURES = arrays(np.float64, 6, elements=st.floats(-7.0, 7.0))
WEIGHTS = arrays(np.float64, 6, elements=st.floats(0.0, 1e6))
ROUNDING = 1e-13


@kernel
def _cost(change: float, squared: bool) -> float:
    return float(joint_cost(change, squared))


@given(POSTURES, POSTURES, WEIGHTS, st.sampled_from(NORMS))
def test_kernels_and_arrays_agree(q: Array, reference: Array, weights: Array, norm: Norm) -> None:
    squared, change = norm == "l2", q - reference
    assert [_cost(one, squared) for one in change] == joint_costs(change, norm).tolist()
    expected = posture_effort(q, reference, weights.tolist(), norm)
    scale = cost_scale(weights, norm)
    start, thinning = (scale * reference)[:, None], (scale * q)[:, None]
    chain = chain_effort(start, thinning, thinning, np.array([0]), squared)
    assert chain == pytest.approx(expected, rel=1e-9, abs=ROUNDING * (1 + weights.max()))
    values = np.full(1, np.inf)
    relax(values, start, 0, 0.0, thinning, 0, 1, squared)
    assert values[0] == pytest.approx(chain, rel=ROUNDING)


@pytest.mark.parametrize("norm", NORMS)
def test_a_task_counts_as_arrays_do(tabletop: Robot, norm: Norm) -> None:
    options = Options(norm=norm, joint_weights=(5, 4, 3, 0, 0.5, 1))
    problem = Problem(tabletop, random_targets(1, 1), options=options)
    task = approach_task(problem, problem.targets[0], problem.start)
    for q in np.random.default_rng(2).uniform(tabletop.lower, tabletop.upper, (20, 6)):
        expected = posture_effort(q, task.reference, task.joint_weights, norm)
        assert effort(task.for_kernels(1), q) == pytest.approx(expected, rel=ROUNDING)
