"""Answer bodies, for the OpenAPI document; the answers themselves are made by `app.services.wire`.

Clients must expect new fields and new values of every status, code and name.
"""

from pydantic import MISSING, BaseModel, Field


class ResolvedOptions(BaseModel):
    """The options with every default filled in."""

    method: str
    order: str
    norm: str
    weights: str
    joint_weights: list[float] | MISSING = Field(default=MISSING, description="if given")
    standoff_m: float
    path_points: int
    straightness_m: float
    dwell_s: float
    limit_margin_rad: float
    symmetric_tool: bool
    strike_zone_m: float
    tilt_tolerance_rad: float
    samples: int
    seed: int
    certify: bool
    nlp_backend: str
    qp_solver: str
    include: list[str]


class SolverAnswer(BaseModel):
    """What the method did for one target."""

    method: str
    elapsed_s: float
    iterations: int
    status: str


class NearestAnswer(BaseModel):
    """The nearest feasible change to a target that has no approach."""

    kind: str = Field(description="angle, or displacement of the target")
    approach_angle_rad: float = Field(description="in the displaced target's approach frame")
    displacement_m: list[float] = Field(
        description="added to the position, in the base frame; zero for an angle"
    )
    verified: bool


class ReasonAnswer(BaseModel):
    """Why a target has no approach."""

    code: str
    detail: str
    joint: str | MISSING = MISSING
    margin_rad: float | MISSING = MISSING
    margin_m: float | MISSING = MISSING
    proven: bool | MISSING = Field(
        default=MISSING, description="with `certify`: proven that no approach is feasible"
    )
    nearest: NearestAnswer | MISSING = MISSING


class TransferAnswer(BaseModel):
    """Motion from the previous standby (or the start) to this standby."""

    planner: str
    joints: list[list[float]]
    length_rad: float


class SegmentAnswer(BaseModel):
    """A named part of a trajectory: transfer, cut_in, dwell, retreat."""

    name: str
    start_s: float
    end_s: float


class TrajectoryAnswer(BaseModel):
    """Timed motion for one target, joint-linear between rows."""

    times_s: list[float]
    joints: list[list[float]]
    segments: list[SegmentAnswer]


class ArcAnswer(BaseModel):
    """Approach angles at which one branch is feasible in the whole cut-in.

    What ends an arc: a joint's name, reach, wrist_jump or uncertainty; absent for the whole turn.
    """

    tool_side: int
    branch: int
    lower_rad: float
    upper_rad: float = Field(description="beyond pi where the arc crosses the half turn")
    lower_limit: str | MISSING = MISSING
    upper_limit: str | MISSING = MISSING


class ApproachAnswer(BaseModel):
    """The answer for one target: planned, or infeasible with a reason."""

    target_id: str
    status: str
    approach_angle_rad: float | MISSING = MISSING
    tool_side: int | MISSING = MISSING
    branch: int | MISSING = MISSING
    strike_m: float | MISSING = Field(
        default=MISSING,
        description="tool centre point beyond the target along z; with a strike zone only",
    )
    tilt_rad: float | MISSING = Field(
        default=MISSING,
        description="between the tool's y axis and the branch; with a tilt tolerance only",
    )
    thinning_joints: list[float] | MISSING = MISSING
    standby_joints: list[float] | MISSING = MISSING
    path_joints: list[list[float]] | MISSING = Field(
        default=MISSING, description="the first row is standby, the last thinning"
    )
    path_deviation_m: float | MISSING = MISSING
    effort: float | MISSING = MISSING
    lower_bound: float | MISSING = Field(
        default=MISSING, description="with `certify`: proven, no approach has a lower effort"
    )
    margin_rad: float | MISSING = MISSING
    displacement_margin_m: float | MISSING = Field(
        default=MISSING, description="how far the target may move until the path meets a limit"
    )
    solver: SolverAnswer
    transfer: TransferAnswer | MISSING = MISSING
    trajectory: TrajectoryAnswer | MISSING = MISSING
    reason: ReasonAnswer | MISSING = MISSING
    arcs: list[ArcAnswer] | MISSING = Field(
        default=MISSING, description="if included: every feasible arc, without the relaxations"
    )


class SummaryAnswer(BaseModel):
    """The plan in four numbers."""

    planned: int
    infeasible: int
    total_effort: float
    elapsed_s: float


class PoseAnswer(BaseModel):
    """Where a frame stands in the robot's base frame."""

    position_m: list[float] = Field(description="three numbers: the frame's origin [m]")
    quaternion_xyzw: list[float] = Field(description="four numbers of length 1, real part last")


class PlanAnswer(BaseModel):
    """A plan, with what it was made from as resolved."""

    id: str
    robot: str
    tool: str
    frame: str | MISSING = Field(
        default=MISSING,
        description="in which the targets were sent; absent for base. All of the answer is in base",
    )
    frame_transform: PoseAnswer | MISSING = Field(
        default=MISSING, description="its pose as it was used; absent for base"
    )
    version: str = Field(description="of Prunus")
    model_version: str = Field(description="digest of the robot's model file")
    start_joints: list[float]
    joint_weights: list[float]
    options: ResolvedOptions
    approaches: list[ApproachAnswer] = Field(description="in execution order")
    summary: SummaryAnswer


class JointAnswer(BaseModel):
    """A joint: its link's Denavit-Hartenberg row (classic convention) and its limits.

    The limits of a revolute joint are in radians, those of a prismatic joint in metres.
    """

    name: str
    kind: str = Field(description="revolute or prismatic")
    a_m: float
    alpha_rad: float
    d_m: float
    offset_rad: float
    lower_rad: float | MISSING = MISSING
    upper_rad: float | MISSING = MISSING
    velocity_rad_s: float | MISSING = MISSING
    acceleration_rad_s2: float | MISSING = MISSING
    lower_m: float | MISSING = MISSING
    upper_m: float | MISSING = MISSING
    velocity_m_s: float | MISSING = MISSING
    acceleration_m_s2: float | MISSING = MISSING
    mass_kg: float | MISSING = Field(default=MISSING, description="of the link behind it")


class ToolAnswer(BaseModel):
    """An end-effector, and how far the arm reaches with it at most."""

    name: str
    description: str
    length_m: float
    reach_m: float


class RobotSummary(BaseModel):
    """A robot in the list."""

    name: str
    model: str
    simulated: bool = Field(description="whether only simulated servos may stand behind it")
    model_version: str
    description: str
    tools: list[str]


class RobotsAnswer(BaseModel):
    """All robots."""

    robots: list[RobotSummary]


class RobotAnswer(BaseModel):
    """One robot in full."""

    name: str
    model: str
    simulated: bool = Field(description="whether only simulated servos may stand behind it")
    model_version: str
    description: str
    source: str
    joints: list[JointAnswer]
    mount_position_m: list[float] = Field(description="of the first joint's frame")
    mount_rpy_rad: list[float] = Field(description="about the base frame's x, then y, then z")
    flange_roll_rad: float = Field(description="a last turn about the last z axis")
    mass_source: str | MISSING = Field(
        default=MISSING, description="where the masses are from; absent without masses"
    )
    tools: list[ToolAnswer]
    default_tool: str
    home_joints: list[float]
    calibration_rad: list[float] | MISSING = Field(
        default=MISSING, description="offset of each joint's servo, while a worker is connected"
    )


class HealthAnswer(BaseModel):
    """How the service is."""

    status: str
