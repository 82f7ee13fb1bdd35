"""Bodies of executions and of robots as they are now; `app.services` makes the answers.

Clients must expect new fields and new values of every status and code.
"""

from pydantic import MISSING, BaseModel, Field

from app.schemas.requests import StrictBody


class ExecutionRequest(StrictBody):
    """Which plan to execute, on which robot."""

    plan_id: str
    robot: str = Field(description="the plan's own, or another of the same model")


class FailureAnswer(BaseModel):
    """What went wrong: a code for programs, a sentence for people, and when."""

    code: str
    detail: str
    at: str


class TargetAccountAnswer(BaseModel):
    """What became of one target: not_started, executing, done, skipped or unknown."""

    target_id: str
    status: str
    measured_standby_joints: list[float] | MISSING = MISSING
    measured_thinning_joints: list[float] | MISSING = MISSING
    standby_error_m: float | MISSING = MISSING
    target_error_m: float | MISSING = MISSING
    error: FailureAnswer | MISSING = MISSING


class ExecutionAnswer(BaseModel):
    """An execution: queued, executing, paused, and in the end completed, failed or canceled."""

    id: str
    plan_id: str
    robot: str
    simulated: bool = Field(description="whether the servos are simulated ones")
    status: str
    created_at: str
    started_at: str | MISSING = MISSING
    ended_at: str | MISSING = MISSING
    segment: str | MISSING = Field(
        default=MISSING, description="approach, transfer, cut_in, dwell or retreat"
    )
    targets: list[TargetAccountAnswer] = Field(description="all of the plan, in its order")
    error: FailureAnswer | MISSING = MISSING


class ExecutionSummary(BaseModel):
    """An execution in the list."""

    id: str
    plan_id: str
    robot: str
    status: str
    created_at: str
    updated_at: str


class ExecutionsAnswer(BaseModel):
    """Executions, newest first."""

    executions: list[ExecutionSummary]


class ServoAnswer(BaseModel):
    """What one servo said last."""

    id: int
    joint: str
    torque: bool = Field(description="whether it is under power")
    position_rad: float
    load_share: float = Field(description="present load as a share of full torque, signed")
    voltage_v: float
    temperature_c: int
    errors: list[str]
    retries: int
    read_at: str


class RobotStateAnswer(BaseModel):
    """A robot as its worker described it last; without a worker only the first four fields."""

    robot: str
    connected: bool
    status: str = Field(description="idle, executing, paused, fault, unknown or disconnected")
    simulated: bool = Field(description="whether the servos are, or would have to be, simulated")
    joints: list[float] | MISSING = MISSING
    joints_read_at: str | MISSING = MISSING
    tool: str | MISSING = MISSING
    end_effector: str | MISSING = MISSING
    end_effector_state: str | MISSING = MISSING
    torque: str | MISSING = MISSING
    device: str | MISSING = MISSING
    execution_id: str | MISSING = MISSING
    faults: list[FailureAnswer] | MISSING = Field(
        default=MISSING, description="latched until acknowledged"
    )
    servos: list[ServoAnswer] | MISSING = MISSING
    overruns: int | MISSING = MISSING
    telemetry_age_s: float | MISSING = MISSING


class StopAnswer(BaseModel):
    """What a stop did, and whether reading the servos confirmed it."""

    stopped: bool
    verified: bool
    joints: list[float] | MISSING = MISSING
    joints_read_at: str | MISSING = MISSING
    detail: str


class AcknowledgeAnswer(BaseModel):
    """The faults that are left."""

    faults: list[FailureAnswer]
