"""From a problem to a verified plan."""

import time

from solver.problem.plan import Plan
from solver.problem.problem import Problem
from solver.solving.staged import choose, in_answer_order, plan_part


def solve(problem: Problem) -> Plan:
    """The plan for a batch: an approach for every target, planned and verified or with a reason.

    With order "independent" every target starts from the start posture. With "given" and "optimal"
    each starts from the previous planned standby, and the batch is planned as one, for the least
    total effort, by the methods that choose among all approaches; the others go greedily, from
    target to target.
    """
    started = time.perf_counter()
    choice = choose(problem)
    approaches = plan_part(problem, choice, 0, len(choice.order), problem.start)
    ordered = in_answer_order(problem, approaches)
    return Plan(problem, ordered, time.perf_counter() - started)
