"""Request bodies. Structure and types only: what a value may be, `solver.Problem` decides.

Bounds in `json_schema_extra` are told to clients and not enforced here: the solver refuses what is
outside, with its own pointers.
"""

from typing import Annotated

from pydantic import MISSING, Field

from app.schemas.options import asked
from app.schemas.strict_body import StrictBody

# Lists stop at their first fault: millions of faults in one body would fill the memory.
Numbers = Annotated[list[float], Field(fail_fast=True)]
Vector = Annotated[
    Numbers, Field(description="three numbers", json_schema_extra={"minItems": 3, "maxItems": 3})
]
Quaternion = Annotated[Numbers, Field(json_schema_extra={"minItems": 4, "maxItems": 4})]


class TargetBody(StrictBody):
    """A blossom to remove."""

    id: str = Field(
        description="not empty, once in a batch; the answer names the target by it",
        json_schema_extra={"minLength": 1},
    )
    position_m: Vector = Field(
        description="three numbers: the blossom in the request's frame [m]; at most 20 times the "
        "arm's reach from the base"
    )
    branch_direction: Vector = Field(
        description="three numbers: along the branch in the request's frame, any length above "
        "1e-9; the approach angle turns about it"
    )
    position_std_m: float | MISSING = Field(
        default=MISSING,
        description="standard deviation of the position in every direction [m], 0 to a quarter of "
        "the arm's reach, above 0 with a closed form only; default: exact",
        json_schema_extra={"minimum": 0},
    )


class SceneBranchBody(StrictBody):
    """A branch as a chain of capsules."""

    id: str = Field(description="the branch's name; not read yet")
    points_m: Annotated[list[Vector], Field(fail_fast=True)] = Field(
        description="points along the branch, three numbers each [m]; not read yet"
    )
    radius_m: float = Field(description="radius of its capsules [m]; not read yet")


class SceneBody(StrictBody):
    """What stands around the arm; no request may have one yet."""

    branches: Annotated[list[SceneBranchBody], Field(fail_fast=True)] | MISSING = Field(
        default=MISSING, description="branches around the arm; not read yet"
    )


class OptionsBody(StrictBody):
    """How to solve; absent fields take their defaults, which the answer shows."""

    method: str | MISSING = asked("method")
    order: str | MISSING = asked("order")
    norm: str | MISSING = asked("norm")
    weights: str | MISSING = asked("weights")
    joint_weights: Numbers | MISSING = asked("joint_weights")
    standoff_m: float | MISSING = asked("standoff_m")
    path_points: int | MISSING = asked("path_points")
    straightness_m: float | MISSING = asked("straightness_m")
    dwell_s: float | MISSING = asked("dwell_s")
    limit_margin_rad: float | MISSING = asked("limit_margin_rad")
    symmetric_tool: bool | MISSING = asked("symmetric_tool")
    strike_zone_m: float | MISSING = asked("strike_zone_m")
    tilt_tolerance_rad: float | MISSING = asked("tilt_tolerance_rad")
    position_margin_m: float | MISSING = asked("position_margin_m")
    samples: int | MISSING = asked("samples")
    seed: int | MISSING = asked("seed")
    nlp_backend: str | MISSING = asked("nlp_backend")
    qp_solver: str | MISSING = asked("qp_solver")
    certify: bool | MISSING = asked("certify")
    include: Annotated[list[str], Field(fail_fast=True)] | MISSING = asked("include")


class PlanRequest(StrictBody):
    """A batch of targets for one robot."""

    robot: str = Field(description="a name of GET /v1/robots")
    tool: str | MISSING = Field(
        default=MISSING, description="a name among the robot's `tools`; default: its `default_tool`"
    )
    frame: str | MISSING = Field(
        default=MISSING,
        description="in which the targets are: `base`, the default, or a name of GET /v1/frames",
    )
    start_joints: Numbers | MISSING = Field(
        default=MISSING,
        description="where the arm stands at first: one number a joint within its limits, in joint "
        "order [rad, or m for a prismatic joint]; default: the robot's `home_joints`",
    )
    targets: Annotated[list[TargetBody], Field(fail_fast=True)] = Field(
        description="at least one; at most as many as the setting PRUNUS_JOB_TARGETS_LIMIT allows",
        json_schema_extra={"minItems": 1},
    )
    scene: SceneBody | MISSING = Field(
        default=MISSING,
        description="leave it out: obstacles are not available yet, and a request with a scene, "
        "even an empty one, is refused with 422 at `#/scene`",
    )
    options: OptionsBody | MISSING = Field(
        default=MISSING, description="how to solve; default: every option's own"
    )


class PoseBody(StrictBody):
    """Where a frame stood in the base frame when a request was read."""

    position_m: Vector
    quaternion_xyzw: Numbers


class StoredPlanRequest(PlanRequest):
    """A request as the store has it: with a pose its targets are in the base frame already."""

    frame_transform: PoseBody | MISSING = MISSING
