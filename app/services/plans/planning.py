"""Planning in this process, as the command line does it."""

import math
import uuid
from typing import Any

import orjson

from app.services.plans.wire import parse_request, plan_to_wire, problem_from_wire
from solver import solve


def plan_request(body: bytes, *, degrees: bool = False) -> tuple[dict[str, Any], bytes]:
    """The plan for a request's JSON, as values and as JSON.

    Args:
        body: what POST /v1/plans takes.
        degrees: whether the request's start_joints are in degrees.

    Raises:
        pydantic.ValidationError: not JSON, or not the schema's structure.
        InvalidProblem: a request that makes no sense.
    """
    request = parse_request(body)
    if degrees and "start_joints" in request.model_fields_set:
        start = [math.radians(value) for value in request.model_dump()["start_joints"]]
        request = request.model_copy(update={"start_joints": start})
    answer = plan_to_wire(solve(problem_from_wire(request)), uuid.uuid4().hex)
    return answer, orjson.dumps(answer)
