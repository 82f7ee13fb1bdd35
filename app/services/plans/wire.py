"""Between the wire and the solver: one code path for the service and the command line.

Fields that are absent are left out, in both directions; nothing is ever null.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from app.schemas.requests import PlanRequest, StoredPlanRequest
from app.services.plans.sent_frames import FindFrame, sent_frame
from app.version import prunus_version
from hardware.servos.instances import load_instance
from solver import (
    Fault,
    InvalidProblem,
    NamedFrame,
    Options,
    Plan,
    Problem,
    Robot,
    Target,
    UnknownRobot,
    targets_in_base,
)
from solver.comparison.strawberry.mechanism import NAME as STRAWBERRY


def parse_request(body: bytes) -> PlanRequest:
    """The request in a JSON document.

    Raises:
        pydantic.ValidationError: not JSON, or not the schema's structure.
        InvalidProblem: an object has a name twice.
    """
    return PlanRequest.from_json(body)


def parse_stored_request(body: bytes) -> StoredPlanRequest:
    """A request as `stored_request` wrote it, or an earlier version of the service.

    Raises:
        pydantic.ValidationError: not JSON, or not the schema's structure.
    """
    return StoredPlanRequest.model_validate_json(body)


def problem_from_wire(request: PlanRequest, find_frame: FindFrame | None = None) -> Problem:
    """The problem that a request asks for, with its targets in the base frame.

    Args:
        request: as sent, or as stored.
        find_frame: the registered frames; None where there is no service to have any.

    Raises:
        InvalidProblem: with every fault found; no fault repeats what was sent.
    """
    given: Mapping[str, Any] = request.model_dump()
    faults = list(_not_available(given))
    targets = _targets(given)
    frame = None
    try:
        frame = sent_frame(given, find_frame)
        if frame is not None and "frame_transform" not in given:
            targets = targets_in_base(targets, frame.base_from_frame)
    except InvalidProblem as error:
        faults += error.faults
    try:
        problem = _problem(given, load_instance(request.robot).robot, targets, frame)
    except UnknownRobot as error:
        faults.append(Fault(("robot",), _why_unknown(error)))
    except InvalidProblem as error:
        faults += error.faults
    if faults:
        raise InvalidProblem(tuple(faults))
    return problem


def _why_unknown(error: UnknownRobot) -> str:
    if error.name == STRAWBERRY:
        return (
            "this mechanism has no approach to plan; compare its methods: prunus compare strawberry"
        )
    return f"unknown robot; known: {', '.join(error.known)}"


def _targets(given: Mapping[str, Any]) -> Sequence[Target]:
    return [
        Target(
            target["id"],
            tuple(target["position_m"]),
            tuple(target["branch_direction"]),
            target.get("position_std_m"),
        )
        for target in given["targets"]
    ]


def _problem(
    given: Mapping[str, Any], robot: Robot, targets: Sequence[Target], frame: NamedFrame | None
) -> Problem:
    options = Options(**given.get("options", {}))
    return Problem(
        robot,
        targets,
        options,
        tool=given.get("tool"),
        start_joints=given.get("start_joints"),
        frame=frame,
    )


def _not_available(given: Mapping[str, Any]) -> list[Fault]:
    if "scene" in given:
        return [Fault(("scene",), "obstacles are not available yet")]
    return []


def plan_to_wire(plan: Plan, plan_id: str) -> dict[str, Any]:
    """A plan as JSON values: the body of the answer, and the file that `prunus plan` writes."""
    return {"id": plan_id, "version": prunus_version(), **plan.to_dict()}
