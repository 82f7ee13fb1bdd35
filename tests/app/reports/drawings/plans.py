"""Plans that are drawn: the JSON answer, and the problem that it answers."""

from typing import Any

import orjson

from app.services.plans.wire import parse_request, plan_to_wire, problem_from_wire
from solver import Problem, solve

Planned = tuple[dict[str, Any], Problem]
FAR = {"id": "far", "position_m": [0.0, 2.0, 0.1], "branch_direction": [0, 0, 1]}


def planned(request: dict[str, Any]) -> Planned:
    problem = problem_from_wire(parse_request(orjson.dumps(request)))
    return plan_to_wire(solve(problem), "0" * 32), problem
