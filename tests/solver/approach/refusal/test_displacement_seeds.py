"""Where searches start: postures that exist, on the branch that they are told for."""

import numpy as np

from solver import Options, Problem, Robot
from solver.approach.refusal.displacement_constraints import copy_at
from solver.approach.refusal.displacement_seeds import seeds
from solver.approach.refusal.tolerances import SEED_BINS
from solver.approach.task.feasibility import posture, tool_axes
from solver.approach.task.task import approach_task
from tests.solver.problems import random_targets

ROUNDING_M = 1e-9
ROUNDING_RAD = 1e-9


def test_starts_are_within_reach_and_inside_the_arm_s_limits(tabletop: Robot) -> None:
    problem = Problem(tabletop, random_targets(83, 40), options=Options(method="ssas"))
    looked_at = 0
    for target in problem.targets:
        task = approach_task(problem, target, problem.start).for_kernels(1)
        needed, starts = np.empty((8, SEED_BINS)), np.empty((8, SEED_BINS, 4))
        seeds(task, needed, starts)
        assert np.isfinite(needed).any()
        for branch, part in np.argwhere(np.isfinite(needed)):
            start, axes, q = starts[branch, part], np.empty((3, 3)), np.empty(6)
            assert np.linalg.norm(start[:3]) <= needed[branch, part] + ROUNDING_M
            tool_axes(task, start[3], axes)
            there = copy_at(task, task.position + start[:3])
            assert posture(there, axes, 0.0, int(branch), q) >= -ROUNDING_M
            inside = np.minimum(q - task.lower, task.upper - q)[:3]
            assert inside.min() >= -ROUNDING_RAD, (target, branch, q)
            looked_at += 1
    assert looked_at > 200
