"""A batch as it is sent, read and checked: what a plan is made of, or a job."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import orjson

from app.services.exceptions import told_as_invalid
from app.services.plans.sent_frames import stored_request
from app.services.plans.wire import parse_request, plan_to_wire, problem_from_wire
from solver import Fault, InvalidProblem, Plan, Problem, RigidTransform

LARGE_BODY_BYTES = 256 * 1024
"""Of two thousand targets or so. Parsing holds up all of its process, 1.4 s for 100,000 targets,
so from here on a batch is read in a solver process."""


@dataclass(frozen=True)
class BatchLimits:
    """How many targets a batch may have.

    Attributes:
        at_once: larger ones become jobs.
        at_all: larger ones are refused.
    """

    at_once: int
    at_all: int


@dataclass(frozen=True)
class PlanOrder:
    """A batch that is answered at once: its problem, and the request as it is kept, JSON."""

    problem: Problem
    request: str


@dataclass(frozen=True)
class JobOrder:
    """A batch that becomes a job; `request` is JSON with every default filled in."""

    robot: str
    targets: int
    request: str


def read_batch(
    body: bytes,
    limits: BatchLimits,
    as_job: bool,
    find_frame: Callable[[str], RigidTransform | None],
) -> PlanOrder | JobOrder:
    """What a body of POST /v1/plans asks for.

    Args:
        body: JSON.
        limits: of targets.
        as_job: whether the client wants a job however few targets there are.
        find_frame: the registered frames.

    Raises:
        InvalidRequest: the request makes no sense.
    """
    with told_as_invalid():
        request = parse_request(body)
        if len(request.targets) > limits.at_all:
            raise InvalidProblem((Fault(("targets",), f"more than {limits.at_all} targets"),))
        problem = problem_from_wire(request, find_frame)
    kept = stored_request(request, problem)
    if as_job or len(problem.targets) > limits.at_once:
        return JobOrder(problem.robot.name, len(problem.targets), resolved_request(kept, problem))
    return PlanOrder(problem, kept)


def resolved_request(request: str, problem: Problem) -> str:
    """A stored request with every default filled in, JSON: the same for ever after."""
    head = plan_to_wire(Plan(problem, (), 0.0), "")
    resolved: dict[str, Any] = {name: head[name] for name in ("tool", "start_joints", "options")}
    return orjson.dumps({**orjson.loads(request), **resolved}).decode()
