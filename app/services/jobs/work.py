"""A job's work in a process of its own: everything but a few numbers stays there, or is bytes."""

import json
import logging
from dataclasses import dataclass

from app.observation.measures import PlanFigures
from app.services.plans import parts
from app.services.plans.wire import parse_stored_request, problem_from_wire
from app.store.jobs import NewPart
from solver import (
    METHODS,
    Choice,
    Problem,
    choice_from_json,
    choice_to_json,
    choose,
    family_of,
    next_reference,
)

logger = logging.getLogger(__name__)

PART_TARGETS_SLOW = 10
"""In a part without a closed form, or with certificates."""


@dataclass
class _Loaded:
    """The job that this process works on."""

    job_id: str
    problem: Problem
    choice: Choice | None


# Set by `load_job`; each process works on one job at a time.
_loaded: _Loaded | None = None


def load_job(job_id: str, request: str, choice: str | None) -> None:
    """Make a job ready, with what its batch decided as one if it has."""
    global _loaded
    problem = problem_from_wire(parse_stored_request(request.encode()))
    known = None if choice is None else choice_from_json(problem, choice)
    _loaded = _Loaded(job_id, problem, known)


def choose_for_job(job_id: str) -> str:
    """What the job's batch decides as one, as text."""
    loaded = _job(job_id)
    logger.info("job choosing", extra={"job_id": job_id})
    loaded.choice = choose(loaded.problem)
    return choice_to_json(loaded.choice)


def solve_part(
    job_id: str, number: int, first: int, reference: str | None
) -> tuple[NewPart, PlanFigures]:
    """The part of a job that begins at a place of its order, from a posture, JSON."""
    loaded = _job(job_id)
    problem, choice = loaded.problem, loaded.choice
    assert choice is not None, "parts come after the choice"
    logger.info("job part started", extra={"job_id": job_id, "part": number})
    began = tuple(json.loads(reference)) if reference is not None else problem.start
    plan, solved = parts.solve_part(problem, choice, first, part_targets(problem), began)
    part = NewPart(
        number=number,
        first=first,
        planned=plan.planned,
        infeasible=plan.infeasible,
        total_effort=plan.total_effort,
        elapsed_s=plan.elapsed_s,
        reference=json.dumps(next_reference(problem, plan.approaches, began)),
        approaches=solved.approaches.decode(),
    )
    return part, solved.figures


def part_targets(problem: Problem) -> int:
    """How many targets a part has."""
    family = family_of(problem.robot, problem.mounted_tool)
    quick = family.has_closed_form and not problem.options.certify
    return METHODS[problem.options.method].targets_in_a_part if quick else PART_TARGETS_SLOW


def plan_head(job_id: str, totals: parts.Totals) -> str:
    """The answer of a job's plan without its approaches, JSON."""
    return parts.head_of(_job(job_id).problem, job_id, totals).decode()


def _job(job_id: str) -> _Loaded:
    if _loaded is None or _loaded.job_id != job_id:
        raise RuntimeError("this process works on another job")
    return _loaded
