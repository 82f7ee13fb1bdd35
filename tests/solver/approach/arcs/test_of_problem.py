"""The feasible arcs of a whole problem."""

import math
from dataclasses import replace

from solver import Options, Problem, Robot, Target
from solver.approach.arcs.arcs import task_arcs
from solver.approach.arcs.of_problem import feasible_arcs
from solver.approach.task.task import approach_task
from tests.solver.problems import random_targets


def test_a_batch_has_the_arcs_of_its_targets_in_any_order(tabletop: Robot) -> None:
    targets = random_targets(44, 40)
    problem = Problem(tabletop, targets, options=Options(symmetric_tool=True, include=("path",)))
    found = feasible_arcs(problem)
    backwards = feasible_arcs(replace(problem, targets=targets[::-1]))
    assert found == backwards
    for target in targets:
        alone = task_arcs(approach_task(problem, target, problem.start))
        assert sorted(map(repr, found[target.id])) == sorted(map(repr, alone))
    assert sum(map(len, found.values())) > 40


def test_joints_without_limits_have_whole_turns(tabletop: Robot) -> None:
    joints = tuple(replace(joint, lower=-4.0, upper=4.0) for joint in tabletop.joints)
    free = replace(tabletop, joints=joints)
    target = Target("1", (0.17, 0.0, 0.2), (0.15, 0.0, 0.09))
    arcs = feasible_arcs(Problem(free, [target]))["1"]
    whole = [arc for arc in arcs if arc.upper_rad - arc.lower_rad >= 2 * math.pi - 1e-12]
    assert whole
    assert all(arc.lower_limit is None and arc.upper_limit is None for arc in whole)
