"""What a solver process is started with, and what it does for plans."""

import orjson

from app.observation.logs import LogOptions, configure_logs
from app.observation.measures import PlanFigures
from app.services.plans.parts import SolvedPart, plan_figures, solve_part
from app.services.plans.wire import plan_to_wire
from app.services.solving.long_lived import keep_for_good
from solver import Problem, choose, solve


def solve_to_json(problem: Problem, plan_id: str) -> tuple[bytes, PlanFigures]:
    """The answer's body, and its figures; runs in a worker."""
    plan = solve(problem)
    return orjson.dumps(plan_to_wire(plan, plan_id)), plan_figures(plan)


def solve_share(problem: Problem) -> SolvedPart:
    """A share of a batch of independent targets; runs in a worker."""
    _, part = solve_part(problem, choose(problem), 0, len(problem.targets), problem.start)
    return part


def prepare(logs: LogOptions) -> None:
    """Make a solver process ready: its logs, then its kernels."""
    configure_logs(logs)
    from solver.warm_up import warm_up

    warm_up()
    keep_for_good()
