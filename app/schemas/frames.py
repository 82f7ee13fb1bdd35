"""Bodies of frames: poses, pairs of points, and what they say of each other.

Structure and types only: what a value may be, `solver.frames` decides.
Clients must expect new fields and new values of every code and name.
"""

from typing import Annotated

from pydantic import MISSING, BaseModel, Field

from app.schemas.requests import Quaternion, Vector
from app.schemas.strict_body import StrictBody


class PointPairBody(StrictBody):
    """One point, measured in the frame and in the robot's base frame."""

    frame_m: Vector = Field(
        description="three numbers, each at most 1e7: the point in the frame, say as the camera "
        "sees it [m]"
    )
    base_m: Vector = Field(
        description="three numbers, each at most 1e7: the same point in the robot's base frame [m]"
    )


class FrameRequest(StrictBody):
    """Where a frame stands in the robot's base frame: base_from_frame, with one rotation."""

    position_m: Vector = Field(
        description="three numbers, each at most 1e7: the frame's origin in the base [m]"
    )
    quaternion_xyzw: Quaternion | MISSING = Field(
        default=MISSING, description="four numbers, real part last; length 1 to within 0.001"
    )
    rotation_matrix: Annotated[list[Vector], Field(fail_fast=True)] | MISSING = Field(
        default=MISSING,
        description="instead of the quaternion: three rows; its columns are the frame's axes in "
        "the base; orthonormal to within 0.002 and right-handed",
        json_schema_extra={"minItems": 3, "maxItems": 3},
    )
    check_pairs: Annotated[list[PointPairBody], Field(fail_fast=True)] | MISSING = Field(
        default=MISSING,
        description="1 to 1000 points that the pose is compared with; they do not change it",
        json_schema_extra={"minItems": 1, "maxItems": 1000},
    )


class FrameRegistrationRequest(StrictBody):
    """Points from which a frame's pose is estimated."""

    pairs: Annotated[list[PointPairBody], Field(fail_fast=True)] = Field(
        description="3 to 1000 points that are on no line; four or more tell errors",
        json_schema_extra={"minItems": 3, "maxItems": 1000},
    )
    robot: str | MISSING = Field(
        default=MISSING,
        description="the arm that touched the points, a name of GET /v1/robots: its reach tells "
        "exchanged points; default: the longest of all robots",
    )


class FrameWarningAnswer(BaseModel):
    """Something that is probably wrong with a frame."""

    code: str = Field(
        description="few_digits, far, few_pairs, scaled, mirrored, inverted, large_residual, "
        "uncertain_rotation, more may come; docs/frames.md tells what to do"
    )
    detail: str = Field(description="what it is, for people")


class FrameAnswer(BaseModel):
    """A frame: p_base = rotation_matrix p_frame + position_m."""

    name: str = Field(description="under which it is registered")
    source: str = Field(description="given (a pose) or estimated (from pairs); more may come")
    position_m: list[float] = Field(description="three numbers: its origin in the base [m]")
    quaternion_xyzw: list[float] = Field(
        description="four numbers of length 1, real part last and not negative"
    )
    rotation_matrix: list[list[float]] = Field(
        description="three rows of three numbers; its columns are the frame's axes in the base"
    )
    residuals_m: list[float] | MISSING = Field(
        default=MISSING,
        description="of each pair, as sent: how far base_m is from where the pose puts frame_m "
        "[m]; absent without pairs and in lists",
    )
    rms_residual_m: float | MISSING = Field(
        default=MISSING, description="their root mean square [m]"
    )
    max_residual_m: float | MISSING = Field(default=MISSING, description="the largest [m]")
    scale: float | MISSING = Field(
        default=MISSING,
        description="distances in the base over those in the frame, 1 if all is well; the pose has "
        "none of it; absent where the pairs are fewer than three or on a line",
    )
    rotation_std_rad: float | MISSING = Field(
        default=MISSING,
        description="of an estimated pose: standard deviation of its rotation about the axis "
        "where it is known worst [rad]",
    )
    warnings: list[FrameWarningAnswer] = Field(description="empty if nothing seems wrong")
    created_at: str = Field(description="when the name was registered first, RFC 3339 in UTC")
    updated_at: str = Field(description="when this pose was registered, RFC 3339 in UTC")


class FramesAnswer(BaseModel):
    """All frames, by name, without the residuals of single pairs."""

    frames: list[FrameAnswer] = Field(description="by name; `base` is not among them")
