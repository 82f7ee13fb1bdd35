"""Postures at angles of arcs, against those of the task."""

import numpy as np
import pytest

from solver import Options, Problem, load_robot
from solver.approach.task.task import approach_task
from solver.problem.options import Norm
from solver.sequencing.batch import arc_postures, end_postures, turning_postures
from tests.solver.problems import DATA_SET_3
from tests.solver.sequencing.synthetic import batch

WEIGHTS = (4.0, 1.0, 2.0, 0.0, 9.0, 1.0)


@pytest.mark.parametrize("norm", ["l1", "l2"])
@pytest.mark.parametrize("kernel", [arc_postures, end_postures, turning_postures])
def test_postures_are_the_task_s_scaled(norm: Norm, kernel: object) -> None:
    of = batch(norm, weights=WEIGHTS)
    problem = Problem(load_robot("tabletop"), DATA_SET_3[:3], Options(norm=norm))
    roots = np.sqrt(WEIGHTS) if norm == "l2" else np.array(WEIGHTS)
    assert of.scale == pytest.approx(roots)
    assert of.start == pytest.approx(roots * np.array(problem.start))
    arcs = np.array([0, 0, 1, 2, 4, 5])
    angles = (of.arc_lower + 0.3 * (of.arc_upper - of.arc_lower))[arcs]
    angles[1] += 0.02
    thinning, standby = np.empty((6, 6)), np.empty((6, 6))
    if kernel is arc_postures:
        arc_postures(of, arcs, angles, thinning, standby)
    else:
        for k, arc in enumerate(arcs):
            own = slice(k, k + 1)
            kernel(of, arc, angles[own], thinning[:, own], standby[:, own])  # type: ignore[operator]
    for k, arc in enumerate(arcs):
        target = problem.targets[arc // 2]
        task = approach_task(problem, target, problem.start)
        rows = task.postures(float(angles[k]), 1, 2, np.array([0.04, 0.0]))
        assert thinning[:, k] == pytest.approx(roots * rows[-1], abs=1e-12)
        assert standby[:, k] == pytest.approx(roots * rows[0], abs=1e-12)
