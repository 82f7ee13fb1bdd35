"""Request bodies. Structure and types only: what a value may be, `solver.Problem` decides."""

from typing import Annotated

from pydantic import MISSING, BaseModel, ConfigDict, Field

# Lists stop at their first fault: millions of faults in one body would fill the memory.
Numbers = Annotated[list[float], Field(fail_fast=True)]
Vector = Annotated[Numbers, Field(description="three numbers")]
JointVector = Annotated[
    Numbers, Field(description="in joint order; radians (revolute) or metres (prismatic)")
]


class StrictBody(BaseModel):
    """Nothing unknown, nothing converted, nothing that is not finite."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


class TargetBody(StrictBody):
    """A blossom to remove."""

    id: str = Field(description="not empty, once in a batch")
    position_m: Vector
    branch_direction: Vector = Field(description="along the branch, any length above zero")
    position_std_m: float | MISSING = Field(
        default=MISSING,
        description="standard deviation of the position in every direction; default: exact",
    )


class SceneBranchBody(StrictBody):
    """A branch as a chain of capsules."""

    id: str
    points_m: Annotated[list[Vector], Field(fail_fast=True)]
    radius_m: float


class SceneBody(StrictBody):
    """What stands around the arm."""

    branches: Annotated[list[SceneBranchBody], Field(fail_fast=True)] | MISSING = MISSING


class OptionsBody(StrictBody):
    """How to solve; absent fields take their defaults, which the answer shows."""

    method: str | MISSING = MISSING
    order: str | MISSING = MISSING
    norm: str | MISSING = MISSING
    weights: str | MISSING = MISSING
    joint_weights: Numbers | MISSING = Field(
        default=MISSING, description="one a joint; replaces `weights`"
    )
    standoff_m: float | MISSING = MISSING
    path_points: int | MISSING = MISSING
    straightness_m: float | MISSING = MISSING
    dwell_s: float | MISSING = MISSING
    limit_margin_rad: float | MISSING = MISSING
    symmetric_tool: bool | MISSING = MISSING
    strike_zone_m: float | MISSING = MISSING
    tilt_tolerance_rad: float | MISSING = MISSING
    samples: int | MISSING = MISSING
    seed: int | MISSING = MISSING
    nlp_backend: str | MISSING = MISSING
    qp_solver: str | MISSING = MISSING
    certify: bool | MISSING = Field(
        default=MISSING, description="add a proven lower bound on each effort"
    )
    include: Annotated[list[str], Field(fail_fast=True)] | MISSING = Field(
        default=MISSING,
        description="any of path, transfer, trajectory, arcs; default: the first three up to 50 "
        "targets, then path",
    )


class PlanRequest(StrictBody):
    """A batch of targets for one robot."""

    robot: str
    tool: str | MISSING = Field(default=MISSING, description="default: the robot's own")
    frame: str | MISSING = Field(
        default=MISSING,
        description="in which the targets are: `base`, the default, or a name of GET /v1/frames",
    )
    start_joints: JointVector | MISSING = Field(default=MISSING, description="default: home")
    targets: Annotated[list[TargetBody], Field(fail_fast=True)]
    scene: SceneBody | MISSING = Field(default=MISSING, description="not available yet")
    options: OptionsBody | MISSING = MISSING


class PoseBody(StrictBody):
    """Where a frame stood in the base frame when a request was read."""

    position_m: Vector
    quaternion_xyzw: Numbers


class StoredPlanRequest(PlanRequest):
    """A request as the store has it: with a pose its targets are in the base frame already."""

    frame_transform: PoseBody | MISSING = MISSING
