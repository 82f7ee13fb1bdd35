"""Answers of plans, for the OpenAPI document; `app.services.plans.wire` makes the answers.

Clients must expect new fields and new values of every status, code and name.
"""

from pydantic import MISSING, BaseModel, Field

from app.schemas.options import ResolvedOptions


class SolverAnswer(BaseModel):
    """What the method did for one target."""

    method: str = Field(description="the method, as in `options`")
    elapsed_s: float = Field(
        description="time spent on this target, an equal share where several were solved together, "
        "without its certificate [s]; `elapsed_s` of "
        "the summary has all"
    )
    iterations: int = Field(
        description="what it took: iterations of a programme, or angles or arcs looked at; 0 "
        "without an approach"
    )
    status: str = Field(
        description="the method's own account, say solved or optimum_of_ladder; without an "
        "approach the code of the reason; more may come"
    )


class NearestAnswer(BaseModel):
    """The nearest feasible change to a target that has no approach."""

    kind: str = Field(
        description="angle (another approach angle is feasible) or displacement (of the target); "
        "more may come"
    )
    approach_angle_rad: float = Field(
        description="a feasible approach angle, above -pi up to pi, in the displaced target's "
        "approach frame [rad]"
    )
    displacement_m: list[float] = Field(
        description="three numbers, added to the position in the base frame; zero for an angle [m]"
    )
    verified: bool = Field(
        description="whether the change was made and the whole cut-in found feasible"
    )


class ReasonAnswer(BaseModel):
    """Why a target has no approach; docs/errors.md explains every code."""

    code: str = Field(
        description="out_of_reach, joint_limit, standby_infeasible, cut_in_infeasible, "
        "method_not_applicable or solver_failed; more may come"
    )
    detail: str = Field(description="a sentence for people")
    joint: str | MISSING = Field(
        default=MISSING, description="name of the joint that limits; absent if none does"
    )
    margin_rad: float | MISSING = Field(
        default=MISSING,
        description="how far that joint is inside its limits at best, negative beyond [rad]; "
        "absent where it turns too fast",
    )
    margin_m: float | MISSING = Field(
        default=MISSING,
        description="how far the wrist centre is inside the reach at best, negative beyond; or, "
        "where only `position_std_m` is in the way, by how much the target may move less than it "
        "has to, negative [m]",
    )
    proven: bool | MISSING = Field(
        default=MISSING,
        description="with `certify`: whether it is proven that no approach is feasible",
    )
    nearest: NearestAnswer | MISSING = Field(
        default=MISSING, description="the nearest feasible change; absent if none was found"
    )


class TransferAnswer(BaseModel):
    """Motion from the previous standby (or the start) to this standby."""

    planner: str = Field(description="how it was found: joint_line; more may come")
    joints: list[list[float]] = Field(
        description="its corner postures, each in joint order [rad, or m for a prismatic joint]"
    )
    length_rad: float = Field(
        description="sum of the Euclidean lengths of its pieces, revolute joints only [rad]"
    )


class SegmentAnswer(BaseModel):
    """A named part of a trajectory; the row at its end is the first of the next."""

    name: str = Field(description="transfer, cut_in, dwell or retreat; more may come")
    start_s: float = Field(description="when it begins, in the time of `times_s` [s]")
    end_s: float = Field(description="when it ends, in the time of `times_s` [s]")


class TrajectoryAnswer(BaseModel):
    """Timed motion for one target, joint-linear between rows."""

    times_s: list[float] = Field(
        description="of each row: from 0 for every target, strictly increasing [s]"
    )
    joints: list[list[float]] = Field(
        description="a posture for each time, in joint order [rad, or m for a prismatic joint]"
    )
    segments: list[SegmentAnswer] = Field(description="its parts, in order and without gaps")


class ArcAnswer(BaseModel):
    """Approach angles at which one branch is feasible in the whole cut-in."""

    tool_side: int = Field(
        description="1, or -1 for a symmetric tool turned about its axis by half a turn"
    )
    branch: int = Field(description="number of the inverse kinematics branch, 0 to 7")
    lower_rad: float = Field(description="where it begins, -pi to pi [rad]")
    upper_rad: float = Field(
        description="where it ends; beyond pi where the arc crosses the half turn [rad]"
    )
    lower_limit: str | MISSING = Field(
        default=MISSING,
        description="what ends it at `lower_rad`: a joint's name, reach, wrist_jump or "
        "uncertainty, more may come; absent for the whole turn",
    )
    upper_limit: str | MISSING = Field(
        default=MISSING, description="the same at `upper_rad`; absent for the whole turn"
    )


class ApproachAnswer(BaseModel):
    """The answer for one target: planned, or infeasible with a reason.

    Without an approach only `target_id`, `status`, `solver`, `reason` and `arcs` are there.
    """

    target_id: str = Field(description="the target's `id`, as sent")
    status: str = Field(description="planned or infeasible; more may come")
    approach_angle_rad: float | MISSING = Field(
        default=MISSING,
        description="of the approach direction about the branch, above -pi up to pi; 0 comes "
        "straight out from the base [rad]",
    )
    tool_side: int | MISSING = Field(
        default=MISSING,
        description="1, or -1 where a symmetric tool is turned about its axis by half a turn",
    )
    branch: int | MISSING = Field(
        default=MISSING,
        description="number of the inverse kinematics branch, 0 to 7; absent for an arm without a "
        "closed form",
    )
    strike_m: float | MISSING = Field(
        default=MISSING,
        description="tool centre point beyond the target along z, 0 to `strike_zone_m`; with a "
        "strike zone only [m]",
    )
    tilt_rad: float | MISSING = Field(
        default=MISSING,
        description="between the tool's y axis and the branch, 0 to `tilt_tolerance_rad`; with a "
        "tilt tolerance only [rad]",
    )
    thinning_joints: list[float] | MISSING = Field(
        default=MISSING,
        description="posture at the target, in joint order [rad, or m for a prismatic joint]",
    )
    standby_joints: list[float] | MISSING = Field(
        default=MISSING,
        description="posture `standoff_m` behind it, in joint order [rad, or m for a prismatic "
        "joint]",
    )
    path_joints: list[list[float]] | MISSING = Field(
        default=MISSING,
        description="if included: the cut-in, `path_points` postures, the first standby, the last "
        "thinning [rad, or m for a prismatic joint]",
    )
    path_deviation_m: float | MISSING = Field(
        default=MISSING,
        description="largest distance of the tool centre point from the straight cut-in, between "
        "rows too [m]",
    )
    effort: float | MISSING = Field(
        default=MISSING,
        description="weighted joint travel from the previous planned standby (or the start) to "
        "thinning [rad, with norm l2 rad2; a slide's travel counts in m]",
    )
    lower_bound: float | MISSING = Field(
        default=MISSING,
        description="with `certify`: proven, no approach has a lower `effort`, in its unit",
    )
    margin_rad: float | MISSING = Field(
        default=MISSING,
        description="smallest distance of a revolute joint to its limit in the whole cut-in [rad]",
    )
    displacement_margin_m: float | MISSING = Field(
        default=MISSING,
        description="how far the target may move, in any direction, until the path meets a limit "
        "[m]; absent for an arm without a closed form",
    )
    position_margin_m: float | MISSING = Field(
        default=MISSING,
        description="the largest of the option, its half, quarter, eighth and 0 that some approach "
        "of the method bears, and this one does [m]; absent if not asked for",
    )
    margin_short: bool | MISSING = Field(
        default=MISSING, description="true where that is below the option; else absent"
    )
    solver: SolverAnswer = Field(description="what the method did")
    transfer: TransferAnswer | MISSING = Field(
        default=MISSING, description="if included: the motion to this standby"
    )
    trajectory: TrajectoryAnswer | MISSING = Field(
        default=MISSING, description="if included: the timed motion for this target"
    )
    reason: ReasonAnswer | MISSING = Field(
        default=MISSING, description="why there is no approach; absent if there is one"
    )
    arcs: list[ArcAnswer] | MISSING = Field(
        default=MISSING,
        description="if included: every feasible arc, without the relaxations; may be empty",
    )


class SummaryAnswer(BaseModel):
    """The plan in four numbers."""

    planned: int = Field(description="how many targets have an approach")
    infeasible: int = Field(description="how many targets have none")
    total_effort: float = Field(
        description="sum of the efforts of the planned targets, in its unit"
    )
    elapsed_s: float = Field(description="how long the solver took, certificates included [s]")


class PoseAnswer(BaseModel):
    """Where a frame stands in the robot's base frame."""

    position_m: list[float] = Field(description="three numbers: the frame's origin [m]")
    quaternion_xyzw: list[float] = Field(
        description="four numbers of length 1, real part last and not negative"
    )


class PlanAnswer(BaseModel):
    """A plan, with what it was made from as resolved."""

    id: str = Field(description="the plan's id; GET /v1/plans/{plan_id} has it again")
    robot: str = Field(description="the robot it was made for, by name")
    tool: str = Field(description="the tool it was made for, by name")
    frame: str | MISSING = Field(
        default=MISSING,
        description="in which the targets were sent; absent for base. All of the answer is in base",
    )
    frame_transform: PoseAnswer | MISSING = Field(
        default=MISSING, description="its pose as it was used; absent for base"
    )
    version: str = Field(description="of Prunus")
    model_version: str = Field(description="digest of the robot's model file")
    start_joints: list[float] = Field(
        description="the start posture, in joint order [rad, or m for a prismatic joint]"
    )
    joint_weights: list[float] = Field(
        description="weight of each joint in the effort, in joint order, without unit"
    )
    options: ResolvedOptions = Field(description="as used, every default filled in")
    approaches: list[ApproachAnswer] = Field(description="one for each target, in execution order")
    summary: SummaryAnswer = Field(description="the plan in four numbers")


class HealthAnswer(BaseModel):
    """How the service is."""

    status: str = Field(description="ok or ready; more may come")
