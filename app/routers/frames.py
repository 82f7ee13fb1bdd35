"""Frames: where cameras stand in the robot's base frame, given or estimated from points."""

from typing import Annotated, Any

from fastapi import APIRouter, Path, Request, Response

from app.routers.dependencies import TheFrames, TheIdempotency
from app.routers.idempotency_key import CREATED_HEADERS, once, with_key
from app.routers.problem_answers import problem_answers
from app.routers.requests import body_of, json_body
from app.schemas.frames import FrameAnswer, FrameRegistrationRequest, FrameRequest, FramesAnswer
from app.services.plans.registered_frames import NAME_PATTERN, location_of
from app.services.store_calls import store_call
from app.store import NewKey

router = APIRouter(prefix="/v1/frames", tags=["frames"])

# Told, not checked, here: FastAPI's own answer to a name that is none is no problem document.
Name = Annotated[
    str,
    Path(
        description="the frame's name: 1 to 100 characters of A-Z, a-z, 0-9, _, - and ., no dot "
        "first; not `base`",
        json_schema_extra={"pattern": f"^{NAME_PATTERN}$"},
    ),
]
_LOCATION: dict[str, Any] = {"Location": {"schema": {"type": "string"}}}


@router.get(
    "",
    operation_id="list_frames",
    summary="All registered frames",
    responses={200: {"model": FramesAnswer}, **problem_answers(500)},
)
async def list_frames(frames: TheFrames) -> Response:
    """By name, without `residuals_m`; `base`, the robot's own, is not among them."""
    body = await store_call(frames.documents)
    return Response(body, media_type="application/json")


@router.put(
    "/{name}",
    operation_id="put_frame",
    summary="Register a frame, or replace it",
    status_code=201,
    responses={
        200: {"model": FrameAnswer, "description": "It replaces an earlier one of this name"},
        201: {"model": FrameAnswer, "headers": _LOCATION},
        **problem_answers(408, 409, 413, 415, 422, 500),
    },
    openapi_extra=body_of(FrameRequest),
)
async def put_frame(name: Name, request: Request, frames: TheFrames) -> Response:
    """The pose of the frame in the robot's base frame (base_from_frame), with one rotation.

    `check_pairs` are compared with it, and warnings tell whether it seems inverted, or the points
    scaled or mirrored; it is registered all the same. Plans that exist do not change.
    """
    body = await json_body(request)
    stored = await store_call(lambda: frames.put(name, FrameRequest.from_json(body)))
    if stored.is_new:
        return _created(name, stored.document)
    return Response(stored.document, media_type="application/json")


@router.post(
    "/{name}/registration",
    operation_id="register_frame",
    summary="Estimate a frame from points, and register it",
    status_code=201,
    responses={
        201: {"model": FrameAnswer, "headers": CREATED_HEADERS},
        **problem_answers(408, 409, 413, 415, 422, 500),
    },
    openapi_extra=with_key(body_of(FrameRegistrationRequest)),
)
async def register_frame(
    name: Name, request: Request, frames: TheFrames, keys: TheIdempotency
) -> Response:
    """By least squares from points measured in the frame and in the robot's base frame.

    It is registered with its warnings, in place of what had the name. Points on a line, mirror
    images, and points that do not belong together are refused.
    """
    body = await json_body(request)

    async def create(key: NewKey | None) -> Response:
        stored = await store_call(
            lambda: frames.register(name, FrameRegistrationRequest.from_json(body), key)
        )
        return _created(name, stored.document)

    return await once(keys, request, body, create)


@router.get(
    "/{name}",
    operation_id="get_frame",
    summary="One frame",
    responses={200: {"model": FrameAnswer}, **problem_answers(404, 500)},
)
async def get_frame(name: Name, frames: TheFrames) -> Response:
    """As it was answered when it was registered."""
    document = await store_call(frames.document, name)
    return Response(document, media_type="application/json")


@router.delete(
    "/{name}",
    operation_id="delete_frame",
    summary="Remove a frame",
    status_code=204,
    responses={204: {"description": "Removed"}, **problem_answers(404, 500)},
)
async def delete_frame(name: Name, frames: TheFrames) -> Response:
    """Plans that were made in it stay, and can be executed."""
    await store_call(frames.remove, name)
    return Response(status_code=204)


def _created(name: str, document: str) -> Response:
    headers = {"Location": location_of(name)}
    return Response(document, 201, media_type="application/json", headers=headers)
