"""Bodies of executions and of robots as they are now; `app.services` makes the answers.

Clients must expect new fields and new values of every status and code.
"""

from pydantic import MISSING, BaseModel, Field

from app.schemas.strict_body import StrictBody


class ExecutionRequest(StrictBody):
    """Which plan to execute, on which robot."""

    plan_id: str = Field(description="the id of a plan with a planned target")
    robot: str = Field(description="the plan's own, or another of the same model")


class FailureAnswer(BaseModel):
    """What went wrong: a code for programs, a sentence for people, and when."""

    code: str = Field(description="docs/errors.md has the codes; more may come")
    detail: str = Field(description="a sentence for people")
    at: str = Field(description="when it was noticed, RFC 3339 in UTC")


class TargetAccountAnswer(BaseModel):
    """What became of one target."""

    target_id: str = Field(description="the target's `id` in the plan")
    status: str = Field(
        description="not_started, executing, done, skipped or unknown; more may come"
    )
    measured_standby_joints: list[float] | MISSING = Field(
        default=MISSING,
        description="posture at standby, mean of several reads, in joint order [rad]; absent until "
        "it was there",
    )
    measured_thinning_joints: list[float] | MISSING = Field(
        default=MISSING,
        description="posture at the target, mean of several reads, in joint order [rad]; absent "
        "until it was there",
    )
    standby_error_m: float | MISSING = Field(
        default=MISSING,
        description="how far the tool centre point then was, by these reads, from where the plan "
        "has it at standby [m]",
    )
    target_error_m: float | MISSING = Field(
        default=MISSING,
        description="how far the tool centre point then was, by these reads, from where the plan "
        "has it at the target [m]",
    )
    error: FailureAnswer | MISSING = Field(
        default=MISSING, description="why it was skipped or is unknown, where that is known"
    )


class ExecutionAnswer(BaseModel):
    """An execution, as its worker told it last."""

    id: str = Field(description="the execution's id")
    plan_id: str = Field(description="the plan that it carries out")
    robot: str = Field(description="the robot that it moves, by name")
    simulated: bool = Field(description="whether the servos are simulated ones")
    status: str = Field(
        description="queued, executing, paused, and in the end completed, failed or canceled; more "
        "may come"
    )
    created_at: str = Field(description="when it was taken on, RFC 3339 in UTC")
    started_at: str | MISSING = Field(
        default=MISSING, description="when the worker began, RFC 3339 in UTC; absent before"
    )
    ended_at: str | MISSING = Field(
        default=MISSING, description="when it ended, RFC 3339 in UTC; absent before"
    )
    segment: str | MISSING = Field(
        default=MISSING,
        description="what the arm does: approach (to the plan's start), transfer, cut_in, dwell or "
        "retreat, more may come; absent while it does nothing",
    )
    targets: list[TargetAccountAnswer] = Field(description="all of the plan, in its order")
    error: FailureAnswer | MISSING = Field(
        default=MISSING, description="why it failed or was canceled, where that is known"
    )


class ExecutionSummary(BaseModel):
    """An execution in the list."""

    id: str = Field(description="the execution's id")
    plan_id: str = Field(description="the plan that it carries out")
    robot: str = Field(description="the robot that it moves, by name")
    status: str = Field(
        description="queued, executing, paused, completed, failed or canceled; more may come"
    )
    created_at: str = Field(description="when it was taken on, RFC 3339 in UTC")
    updated_at: str = Field(description="when it last changed, RFC 3339 in UTC")


class ExecutionsAnswer(BaseModel):
    """Executions, newest first."""

    executions: list[ExecutionSummary] = Field(description="newest first, 50 at most")


class ServoAnswer(BaseModel):
    """What one servo said last."""

    id: int = Field(description="its number on the bus")
    joint: str = Field(description="name of the joint that it moves, alone or with another")
    torque: bool = Field(description="whether it is under power")
    position_rad: float = Field(description="the joint's position by this servo alone [rad]")
    load_share: float = Field(
        description="present load as a share of full torque, -1 to 1, inferred by the servo"
    )
    voltage_v: float = Field(description="its supply [V]")
    temperature_c: int = Field(description="inside it [°C]")
    errors: list[str] = Field(
        description="voltage, angle_limit, overheating, range, checksum, overload, instruction or "
        "unknown, more may come; empty if it reports none"
    )
    retries: int = Field(description="reads that had to be repeated since the worker started")
    read_at: str = Field(description="when it said this, RFC 3339 in UTC")


class RobotStateAnswer(BaseModel):
    """A robot as its worker described it last; without a worker only the first four fields."""

    robot: str = Field(description="the robot's name")
    connected: bool = Field(description="whether a worker is connected")
    status: str = Field(
        description="idle, executing, paused, fault, unknown (not told yet) or disconnected; more "
        "may come"
    )
    simulated: bool = Field(description="whether the servos are, or would have to be, simulated")
    joints: list[float] | MISSING = Field(
        default=MISSING,
        description="posture by the last reads, in joint order [rad]; absent until every servo has "
        "been read",
    )
    joints_read_at: str | MISSING = Field(
        default=MISSING, description="when the oldest of these reads was made, RFC 3339 in UTC"
    )
    tool: str | MISSING = Field(default=MISSING, description="the mounted tool, by name")
    end_effector: str | MISSING = Field(
        default=MISSING, description="what is on during a dwell: none or simulated; more may come"
    )
    end_effector_state: str | MISSING = Field(
        default=MISSING,
        description="what was verified last: on, off, none (there is none) or unknown; more may "
        "come",
    )
    torque: str | MISSING = Field(
        default=MISSING,
        description="on, off, partly, or unknown while a servo does not answer; more may come",
    )
    device: str | MISSING = Field(
        default=MISSING, description="serial device of the servos, on the worker's machine"
    )
    execution_id: str | MISSING = Field(
        default=MISSING, description="the execution under way; absent without one"
    )
    faults: list[FailureAnswer] | MISSING = Field(
        default=MISSING, description="latched until acknowledged, the first first"
    )
    servos: list[ServoAnswer] | MISSING = Field(
        default=MISSING, description="those that have been read, in joint order"
    )
    overruns: int | MISSING = Field(
        default=MISSING,
        description="ticks of the control loop that came late since the worker started",
    )
    telemetry_age_s: float | MISSING = Field(
        default=MISSING, description="how long ago the worker said this [s]"
    )


class StopAnswer(BaseModel):
    """What a stop did, and whether reading the servos confirmed it."""

    stopped: bool = Field(
        description="whether two reads of every servo in succession found the arm standing"
    )
    verified: bool = Field(
        description="whether it stands and nothing else went wrong: the end-effector is off, the "
        "servos agree"
    )
    joints: list[float] | MISSING = Field(
        default=MISSING,
        description="posture by the last of these reads, in joint order [rad]; absent if a servo "
        "could not be read",
    )
    joints_read_at: str | MISSING = Field(
        default=MISSING, description="when they were made, RFC 3339 in UTC"
    )
    detail: str = Field(description="what was done, and what was not, a sentence for people")


class AcknowledgeAnswer(BaseModel):
    """The faults that are left."""

    faults: list[FailureAnswer] = Field(description="those that are left; empty if all are gone")
