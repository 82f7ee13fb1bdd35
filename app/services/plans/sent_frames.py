"""The frame that a request's targets are in: found, kept with the request, told in the answer."""

from collections.abc import Callable, Mapping
from typing import Any

import orjson

from app.schemas.requests import PlanRequest
from solver import Fault, InvalidProblem, NamedFrame, Problem, RigidTransform

BASE_FRAME = "base"

FindFrame = Callable[[str], RigidTransform | None]
"""Where the frame of a name stands in the robot's base frame, if there is one."""


def sent_frame(given: Mapping[str, Any], find_frame: FindFrame | None) -> NamedFrame | None:
    """The frame of a request's values; None for the base.

    Args:
        given: the request; a stored one has the pose that was used.
        find_frame: the registered frames; None where there is no service to have any.

    Raises:
        InvalidProblem: there is no such frame.
    """
    name = given.get("frame", BASE_FRAME)
    if name == BASE_FRAME:
        return None
    if "frame_transform" in given:
        pose = given["frame_transform"]
        used = RigidTransform(tuple(pose["position_m"]), tuple(pose["quaternion_xyzw"]))
        return NamedFrame(name, used)
    if find_frame is None:
        detail = (
            f"only {BASE_FRAME!r} without a service; other frames are registered with one "
            "(PUT /v1/frames/NAME) and used in POST /v1/plans"
        )
        raise InvalidProblem((Fault(("frame",), detail),))
    found = find_frame(name)
    if found is None:
        detail = "no frame of this name is registered; GET /v1/frames has all"
        raise InvalidProblem((Fault(("frame",), detail),))
    return NamedFrame(name, found)


def stored_request(request: PlanRequest, problem: Problem) -> str:
    """A request as it is kept, JSON: with its targets in the base frame.

    So a frame that is registered anew later changes nothing of what is planned already.
    """
    if problem.frame is None:
        return request.model_dump_json()
    kept = request.model_dump()
    kept["targets"] = [
        {**sent, "position_m": list(own.position_m), "branch_direction": list(own.branch_direction)}
        for sent, own in zip(kept["targets"], problem.targets, strict=True)
    ]
    kept["frame_transform"] = problem.frame.base_from_frame.to_dict()
    return orjson.dumps(kept).decode()
