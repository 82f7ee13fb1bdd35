from dataclasses import replace

import pytest

from solver import Options, Plan, Problem, Robot, load_robot, solve
from solver.problem.options import MethodName, Order
from solver.problem.solution import INFEASIBLE, Approach
from solver.solving.staged import (
    choice_from_json,
    choice_to_json,
    choose,
    in_answer_order,
    next_reference,
    plan_part,
)
from tests.solver.problems import random_targets
from tests.solver.solving.test_solve import comparable


def in_parts(problem: Problem, size: int) -> Plan:
    """The plan as a job makes it: everything between two parts goes through text."""
    text = choice_to_json(choose(problem))
    reference, approaches = problem.start, list[Approach]()
    for first in range(0, len(problem.targets), size):
        again = replace(problem)
        part = plan_part(again, choice_from_json(again, text), first, size, reference)
        reference = next_reference(again, part, reference)
        approaches += part
    return Plan(problem, in_answer_order(problem, approaches), 0.0)


@pytest.mark.parametrize("order", ["independent", "given", "optimal"])
@pytest.mark.parametrize("method", ["floating_z", "ssas", "ncos"])
@pytest.mark.parametrize("size", [1, 4, 100])
def test_parts_make_the_same_plan(
    tabletop: Robot, order: Order, method: MethodName, size: int
) -> None:
    options = Options(order=order, method=method, include=("path",))
    problem = Problem(tabletop, random_targets(seed=81, count=12), options=options)
    whole = solve(problem)
    assert 0 < whole.planned < len(problem.targets)
    assert comparable(in_parts(problem, size)) == comparable(whole)


def test_an_arm_on_a_rail_goes_in_parts_too() -> None:
    options = Options(method="ssas", include=("path",))
    problem = Problem(load_robot("puma560_rail"), random_targets(seed=82, count=4), options=options)
    assert comparable(in_parts(problem, 1)) == comparable(solve(problem))


def test_a_chosen_target_that_fails_comes_last(tabletop: Robot) -> None:
    options = Options(method="ssas", order="optimal", include=("path",))
    problem = Problem(tabletop, random_targets(seed=81, count=12), options=options)
    first, *others = solve(problem).approaches
    failed = Approach(first.target_id, INFEASIBLE, first.solver)
    assert in_answer_order(problem, [failed, *others])[0] is others[0]
    assert next_reference(problem, [failed], problem.start) == problem.start
