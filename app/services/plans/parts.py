"""A plan's answer in parts: a head without approaches, and arrays of approaches, all JSON."""

import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import orjson

from app.observation.measures import PlanFigures
from app.services.plans.wire import plan_to_wire
from solver import Choice, Plan, Problem, plan_part


@dataclass(frozen=True)
class SolvedPart:
    """Some targets of a batch, for another process.

    Attributes:
        approaches: a JSON array.
        effort: sum over the planned ones.
        figures: what is counted.
    """

    approaches: bytes
    effort: float
    figures: PlanFigures


@dataclass(frozen=True)
class Totals:
    """What a plan's summary says of all its parts."""

    planned: int
    infeasible: int
    effort: float
    elapsed_s: float


def solve_part(
    problem: Problem, choice: Choice, first: int, count: int, reference: Sequence[float]
) -> tuple[Plan, SolvedPart]:
    """Some targets of a batch by `solver.solving.staged.plan_part`, and the part they make."""
    started = time.perf_counter()
    approaches = plan_part(problem, choice, first, count, reference)
    plan = Plan(problem, approaches, time.perf_counter() - started)
    body = orjson.dumps(plan_to_wire(plan, "")["approaches"])
    return plan, SolvedPart(body, plan.total_effort, plan_figures(plan))


def plan_figures(plan: Plan) -> PlanFigures:
    """What is counted of a plan."""
    reasons = [entry.reason.code for entry in plan.approaches if entry.reason is not None]
    return PlanFigures(plan.problem.options.method, plan.planned, Counter(reasons), plan.elapsed_s)


def added(figures: Iterable[PlanFigures]) -> PlanFigures:
    """The figures of a plan whose shares were solved side by side."""
    shares = list(figures)
    reasons = sum((Counter(share.infeasible) for share in shares), Counter[str]())
    return PlanFigures(
        shares[0].method,
        sum(share.planned for share in shares),
        reasons,
        max(share.elapsed_s for share in shares),
    )


def head_of(problem: Problem, plan_id: str, totals: Totals) -> bytes:
    """The answer of a plan without its approaches."""
    head = plan_to_wire(Plan(problem, (), totals.elapsed_s), plan_id)
    del head["approaches"]
    head["summary"] |= {
        "planned": totals.planned,
        "infeasible": totals.infeasible,
        "total_effort": totals.effort,
    }
    return orjson.dumps(head)


def joined(head: bytes, arrays: Iterable[bytes]) -> Iterator[bytes]:
    """A whole answer, in pieces."""
    yield head[:-1] + b',"approaches":'
    yield from joined_arrays(arrays)
    yield b"}"


def joined_arrays(arrays: Iterable[bytes]) -> Iterator[bytes]:
    """One JSON array of all elements, in pieces."""
    yield b"["
    between = b""
    for array in arrays:
        if inside := array[1:-1]:
            yield between + inside
            between = b","
    yield b"]"
