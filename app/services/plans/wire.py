"""Between the wire and the solver: one code path for the service and the command line.

Fields that are absent are left out, in both directions; nothing is ever null.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.schemas.present import present
from app.schemas.requests import PlanRequest, StoredPlanRequest
from app.services.plans.sent_frames import FindFrame, pose_to_wire, sent_frame
from app.version import prunus_version
from hardware.servos.instances import load_instance
from solver import (
    Approach,
    Arc,
    Fault,
    InvalidProblem,
    Nearest,
    Options,
    Plan,
    Problem,
    Reason,
    Robot,
    Target,
    Trajectory,
    Transfer,
    UnknownRobot,
)
from solver.comparison.strawberry.mechanism import NAME as STRAWBERRY
from solver.frames.transforms import NamedFrame
from solver.problem.targets import targets_in_base


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
    return Problem(robot, targets, given.get("tool"), given.get("start_joints"), options, frame)


def _not_available(given: Mapping[str, Any]) -> list[Fault]:
    if "scene" in given:
        return [Fault(("scene",), "obstacles are not available yet")]
    return []


def plan_to_wire(plan: Plan, plan_id: str) -> dict[str, Any]:
    """A plan as JSON values: the body of the answer, and the file that `prunus plan` writes."""
    problem = plan.problem
    include = frozenset(problem.options.include or ())
    frame = problem.frame
    sent_in = (
        {}
        if frame is None
        else {
            "frame": frame.name,
            "frame_transform": pose_to_wire(frame.base_from_frame),
        }
    )
    return {
        "id": plan_id,
        "robot": problem.robot.name,
        "tool": problem.mounted_tool.name,
        **sent_in,
        "version": prunus_version(),
        "model_version": problem.robot.version,
        "start_joints": [_number(value) for value in problem.start],
        "joint_weights": [_number(value) for value in problem.joint_weights],
        "options": _options(problem.options),
        "approaches": [_approach(approach, include) for approach in plan.approaches],
        "summary": {
            "planned": plan.planned,
            "infeasible": plan.infeasible,
            "total_effort": _number(plan.total_effort),
            "elapsed_s": _number(plan.elapsed_s),
        },
    }


def _options(options: Options) -> dict[str, Any]:
    values = {entry.name: getattr(options, entry.name) for entry in fields(options)}
    return {
        name: list(value) if isinstance(value, tuple) else value
        for name, value in present(**values).items()
    }


def _approach(approach: Approach, include: frozenset[str]) -> dict[str, Any]:
    path = approach.path_joints if "path" in include else None
    transfer = approach.transfer if "transfer" in include else None
    trajectory = approach.trajectory if "trajectory" in include else None
    arcs = approach.arcs if "arcs" in include else None
    solver = approach.solver
    return present(
        target_id=approach.target_id,
        status=approach.status,
        approach_angle_rad=_optional(approach.approach_angle_rad),
        tool_side=None if approach.tool_side is None else int(approach.tool_side),
        branch=None if approach.branch is None else int(approach.branch),
        strike_m=_optional(approach.strike_m),
        tilt_rad=_optional(approach.tilt_rad),
        thinning_joints=_numbers(approach.thinning_joints),
        standby_joints=_numbers(approach.standby_joints),
        path_joints=_numbers(path),
        path_deviation_m=_optional(approach.path_deviation_m),
        effort=_optional(approach.effort),
        lower_bound=_optional(approach.lower_bound),
        margin_rad=_optional(approach.margin_rad),
        displacement_margin_m=_optional(approach.displacement_margin_m),
        position_margin_m=_optional(approach.position_margin_m),
        margin_short=approach.margin_short,
        solver={
            "method": solver.method,
            "elapsed_s": _number(solver.elapsed_s),
            "iterations": int(solver.iterations),
            "status": solver.status,
        },
        transfer=None if transfer is None else _transfer(transfer),
        trajectory=None if trajectory is None else _trajectory(trajectory),
        reason=None if approach.reason is None else _reason(approach.reason),
        arcs=None if arcs is None else [_arc(arc) for arc in arcs],
    )


def _arc(arc: Arc) -> dict[str, Any]:
    return present(
        tool_side=int(arc.tool_side),
        branch=int(arc.branch),
        lower_rad=_number(arc.lower_rad),
        upper_rad=_number(arc.upper_rad),
        lower_limit=arc.lower_limit,
        upper_limit=arc.upper_limit,
    )


def _reason(reason: Reason) -> dict[str, Any]:
    return present(
        code=reason.code,
        joint=reason.joint,
        detail=reason.detail,
        margin_rad=_optional(reason.margin_rad),
        margin_m=_optional(reason.margin_m),
        proven=reason.proven,
        nearest=None if reason.nearest is None else _nearest(reason.nearest),
    )


def _nearest(nearest: Nearest) -> dict[str, Any]:
    return {
        "kind": nearest.kind,
        "approach_angle_rad": _number(nearest.approach_angle_rad),
        "displacement_m": [_number(value) for value in nearest.displacement_m],
        "verified": bool(nearest.verified),
    }


def _transfer(transfer: Transfer) -> dict[str, Any]:
    return {
        "planner": transfer.planner,
        "joints": _numbers(transfer.joints),
        "length_rad": _number(transfer.length_rad),
    }


def _trajectory(trajectory: Trajectory) -> dict[str, Any]:
    return {
        "times_s": _numbers(trajectory.times_s),
        "joints": _numbers(trajectory.joints),
        "segments": [
            {"name": part.name, "start_s": _number(part.start_s), "end_s": _number(part.end_s)}
            for part in trajectory.segments
        ],
    }


def _number(value: float) -> float:
    # JSON has no NaN and no infinity; orjson would write null, which the contract does not know.
    if not math.isfinite(value):
        raise ValueError("a plan has a number that is not finite")
    return float(value)


def _optional(value: float | None) -> float | None:
    return None if value is None else _number(value)


def _numbers(values: NDArray[np.float64] | None) -> list[Any] | None:
    if values is None:
        return None
    if not np.isfinite(values).all():
        raise ValueError("a plan has a number that is not finite")
    rows: list[Any] = np.asarray(values, dtype=np.float64).tolist()
    return rows
