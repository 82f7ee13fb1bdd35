"""An offer is looked at in the cell of its angle alone, with the answer that all arcs give."""

import numpy as np

from solver import Options, Problem, Robot
from solver.approach.arcs.arcs import task_arcs
from solver.approach.refusal.offered import on_an_arc
from solver.approach.task.task import approach_task
from tests.solver.problems import random_targets


def test_one_cell_tells_what_all_arcs_tell(tabletop: Robot) -> None:
    rng = np.random.default_rng(81)
    problem = Problem(tabletop, random_targets(82, 60), options=Options(method="ssas"))
    inside = 0
    for target in problem.targets:
        task = approach_task(problem, target, problem.start)
        arcs = task_arcs(task)
        spots = [(branch, angle) for branch in range(8) for angle in rng.uniform(-np.pi, np.pi, 4)]
        # In each arc too, and just beside its ends.
        for arc in arcs:
            hair = 1e-6
            ends = (arc.lower_rad - hair, arc.lower_rad + hair, arc.upper_rad + hair)
            spots += [(arc.branch, angle) for angle in (*ends, (arc.lower_rad + arc.upper_rad) / 2)]
        for branch, angle in spots:
            turned = float(np.remainder(angle + np.pi, 2 * np.pi) - np.pi)
            expected = any(
                arc.branch == branch
                and (turned - arc.lower_rad) % (2 * np.pi) <= arc.upper_rad - arc.lower_rad
                for arc in arcs
            )
            assert on_an_arc(task.packed(1), branch, turned) == expected, (target, branch, angle)
            inside += expected
    assert inside > 50
