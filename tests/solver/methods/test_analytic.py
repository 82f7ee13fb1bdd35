import pytest

from solver import Options, Problem, Robot, solve
from solver.approach.arcs.arcs import task_arcs
from solver.approach.task.frame import signed_angle
from solver.approach.task.task import approach_task
from tests.solver.problems import random_targets


@pytest.mark.parametrize("symmetric", [False, True])
def test_middle_of_the_widest_arc(tabletop: Robot, symmetric: bool) -> None:
    options = Options(
        method="as", order="independent", symmetric_tool=symmetric, position_margin_m=0.0
    )
    problem = Problem(tabletop, random_targets(seed=22, count=80), options=options)
    planned = 0
    for target, approach in zip(problem.targets, solve(problem).approaches, strict=True):
        arcs = task_arcs(approach_task(problem, target, problem.start))
        assert (approach.status == "planned") == bool(arcs)
        if not arcs:
            continue
        planned += 1
        own = [
            arc
            for arc in arcs
            if signed_angle((arc.lower_rad + arc.upper_rad) / 2) == approach.approach_angle_rad
            and (arc.branch, arc.tool_side) == (approach.branch, approach.tool_side)
        ]
        assert len(own) == 1
        widest = max(arc.upper_rad - arc.lower_rad for arc in arcs)
        assert own[0].upper_rad - own[0].lower_rad == widest
    assert planned > 20
