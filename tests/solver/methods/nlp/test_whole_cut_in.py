"""Rows between thinning and standby hold too: where one does not, it becomes a posture."""

import math

import numpy as np
import pytest

from solver import Options, Problem, Robot
from solver.approach.cut_in.cut_in import retreat_rows
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import approach_task
from solver.methods.nlp import whole_cut_in
from solver.methods.nlp.starts import start_at
from solver.methods.nlp.whole_cut_in import solve_whole_cut_in
from solver.methods.semi_analytic import solve_ssas
from solver.tolerances import LIMIT_EXCESS_RAD
from tests.solver.problems import random_targets


@pytest.mark.parametrize("index", [38, 53, 119])
def test_a_row_that_does_not_hold_becomes_a_posture(
    tabletop: Robot, monkeypatch: pytest.MonkeyPatch, index: int
) -> None:
    """Targets whose first answer leaves the limits in the middle of a cut-in of 8 cm."""
    options = Options(strike_zone_m=0.02, tilt_tolerance_rad=math.radians(10), standoff_m=0.08)
    problem = Problem(tabletop, random_targets(seed=63, count=120), options=options)
    task = approach_task(problem, problem.targets[index], problem.start)
    warm = solve_ssas(task)
    assert isinstance(warm, Candidate)
    assert warm.branch is not None
    start = start_at(task, warm.tool_side, warm.branch, np.asarray(warm.thinning_joints))
    answer = solve_whole_cut_in(task, start)
    assert answer.status == "solved"
    assert answer.thinning is not None
    rows = retreat_rows(
        task.robot, task.tool, tuple(answer.thinning), answer.branch, np.asarray(task.retreats_m)
    )
    assert np.minimum(rows - task.lower, task.upper - rows).min() >= -LIMIT_EXCESS_RAD
    monkeypatch.setattr(whole_cut_in, "WHOLE_CUT_IN_ROUNDS", 1)
    assert solve_whole_cut_in(task, start).status == "cut_in_infeasible"
