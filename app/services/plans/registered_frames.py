"""Frames by name: registered, estimated, and found for a request. Its calls block."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Final

import orjson
from pydantic import MISSING

from app.schemas.frames import FrameRegistrationRequest, FrameRequest, PointPairBody
from app.schemas.present import present
from app.services.exceptions import Conflict, InvalidRequest, NotFound, invalid_request
from app.services.plans.sent_frames import BASE_FRAME
from app.store import FramesFull, FrameStore, NewKey, StoredFrame
from hardware.clock import instant_text
from hardware.servos.instances import instance_names, load_instance
from solver import (
    Agreement,
    Fault,
    FrameWarning,
    PointPair,
    RigidTransform,
    Robot,
    UnknownRobot,
    check_frame,
    register_frame,
    transform_from_matrix,
    transform_from_quaternion,
)

# No dot first: clients and proxies take "." and ".." in a path for something else.
NAME_PATTERN: Final = "[A-Za-z0-9_-][A-Za-z0-9_.-]{0,99}"
NAME: Final = re.compile(NAME_PATTERN)

GIVEN: Final = "given"
ESTIMATED: Final = "estimated"


@dataclass(frozen=True)
class _Frame:
    name: str
    source: str
    base_from_frame: RigidTransform
    warnings: Sequence[FrameWarning]
    agreement: Agreement | None


class FrameService:
    """The frames of the service. Its calls block: keep them off the event loop."""

    def __init__(self, store: FrameStore) -> None:
        self._store = store

    def put(self, name: str, request: FrameRequest) -> StoredFrame:
        """Register a pose, in place of what had the name.

        Raises:
            InvalidProblem: a pose or pairs that make no sense.
            InvalidRequest: the name is none, or there is not just one rotation.
            Conflict: there are too many frames.
        """
        _check_name(name)
        pose, warnings = _pose(request.model_dump())
        agreement = None
        if request.check_pairs is not MISSING:
            agreement = check_frame(pose, _pairs(request.check_pairs))
            warnings = (*warnings, *agreement.warnings)
        return self._keep(_Frame(name, GIVEN, pose, warnings, agreement))

    def register(
        self, name: str, request: FrameRegistrationRequest, key: NewKey | None = None
    ) -> StoredFrame:
        """Estimate a pose from pairs of points and register it, in place of what had the name.

        Raises:
            InvalidProblem: pairs from which no pose follows.
            KeyTaken: something was created under the key before.
            InvalidRequest: the name is none, or the robot's.
            Conflict: there are too many frames.
        """
        _check_name(name)
        agreement = register_frame(_pairs(request.pairs), reach_m=_reach_m(request.robot))
        pose = agreement.base_from_frame
        return self._keep(_Frame(name, ESTIMATED, pose, agreement.warnings, agreement), key)

    def document(self, name: str) -> str:
        """A frame's JSON.

        Raises:
            NotFound: there is none.
        """
        document = self._find(name)
        if document is None:
            raise _unknown()
        return document

    def documents(self) -> bytes:
        """The JSON of all frames, each without the residuals of its pairs."""
        frames = [orjson.loads(document) for document in self._store.documents()]
        for frame in frames:
            frame.pop("residuals_m", None)
        return orjson.dumps({"frames": frames})

    def remove(self, name: str) -> None:
        """Remove a frame. What was planned in it stays planned.

        Raises:
            NotFound: there is none.
        """
        if not NAME.fullmatch(name) or not self._store.remove(name):
            raise _unknown()

    def transform(self, name: str) -> RigidTransform | None:
        """Where a frame stands in the base, if there is one of that name."""
        document = self._find(name)
        return None if document is None else _transform(orjson.loads(document))

    def transforms(self) -> dict[str, RigidTransform]:
        """Where every frame stands, by name."""
        frames = [orjson.loads(document) for document in self._store.documents()]
        return {frame["name"]: _transform(frame) for frame in frames}

    def _find(self, name: str) -> str | None:
        return self._store.document(name) if NAME.fullmatch(name) else None

    def _keep(self, frame: _Frame, key: NewKey | None = None) -> StoredFrame:
        try:
            return self._store.put(
                frame.name,
                lambda created_at, updated_at: _json(frame, created_at, updated_at),
                key,
                location_of(frame.name),
            )
        except FramesFull:
            detail = "There are as many frames as are kept; delete some."
            raise Conflict("frames_full", detail) from None


def location_of(name: str) -> str:
    """A frame's path."""
    return f"/v1/frames/{name}"


def _check_name(name: str) -> None:
    if not NAME.fullmatch(name):
        raise InvalidRequest(
            "invalid_frame_name",
            "A frame's name is 1 to 100 characters of A-Z, a-z, 0-9, _, - and ., no dot first.",
        )
    if name == BASE_FRAME:
        raise InvalidRequest(
            "invalid_frame_name", f"{BASE_FRAME!r} is the robot's own frame and stays so."
        )


def _unknown() -> NotFound:
    return NotFound("not_found", "There is no frame of this name.")


def _pose(given: dict[str, Any]) -> tuple[RigidTransform, tuple[FrameWarning, ...]]:
    quaternion, matrix = given.get("quaternion_xyzw"), given.get("rotation_matrix")
    if quaternion is not None and matrix is not None:
        detail = "beside quaternion_xyzw: give one rotation only"
        raise invalid_request([Fault(("rotation_matrix",), detail)])
    if quaternion is not None:
        return transform_from_quaternion(given["position_m"], quaternion)
    if matrix is not None:
        return transform_from_matrix(given["position_m"], matrix)
    detail = "needs a rotation: quaternion_xyzw or rotation_matrix"
    raise invalid_request([Fault((), detail)])


def _pairs(bodies: Sequence[PointPairBody]) -> list[PointPair]:
    return [PointPair(body.frame_m, body.base_m) for body in bodies]


def _reach_m(robot: str | MISSING) -> float:
    names = instance_names() if robot is MISSING else (robot,)
    try:
        return max(_longest_reach_m(load_instance(name).robot) for name in names)
    except UnknownRobot as error:
        detail = f"unknown robot; known: {', '.join(error.known)}"
        raise invalid_request([Fault(("robot",), detail)]) from None


def _transform(pose: dict[str, Any]) -> RigidTransform:
    return RigidTransform(tuple(pose["position_m"]), tuple(pose["quaternion_xyzw"]))


def _longest_reach_m(robot: Robot) -> float:
    return max(robot.reach_m(tool) for tool in robot.tools)


def _json(frame: _Frame, created_at: datetime, updated_at: datetime) -> str:
    pose, agreement = frame.base_from_frame, frame.agreement
    values = present(
        name=frame.name,
        source=frame.source,
        position_m=list(pose.position_m),
        quaternion_xyzw=list(pose.quaternion_xyzw),
        rotation_matrix=pose.rotation.tolist(),
        residuals_m=None if agreement is None else agreement.residuals_m.tolist(),
        rms_residual_m=None if agreement is None else agreement.rms_residual_m,
        max_residual_m=None if agreement is None else agreement.max_residual_m,
        scale=None if agreement is None else agreement.scale,
        rotation_std_rad=None if agreement is None else agreement.rotation_std_rad,
        warnings=[{"code": row.code, "detail": row.detail} for row in frame.warnings],
        created_at=instant_text(created_at),
        updated_at=instant_text(updated_at),
    )
    return orjson.dumps(values).decode()
