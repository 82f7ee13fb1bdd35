"""What goes over the robot link, a WebSocket between the service and an arm's worker.

Every message is one JSON object; `type` names its class. Joint vectors are in the model's order
[rad], times in s, lengths in m, instants are RFC 3339 text in UTC. The link is an edge of both
programs, so messages are checked against these classes on arrival.
"""

from dataclasses import dataclass
from functools import cache
from typing import Annotated, Final, Literal, TypeVar, dataclass_transform

import orjson
from pydantic import ConfigDict, Field, TypeAdapter, ValidationError, with_config

from hardware.exceptions import HardwareError

HEARTBEAT_S: Final = 0.5
"""The service says something at least this often, and a worker sends telemetry more often."""

SILENCE_S: Final = 2.0
"""Silence after which either side takes the link for lost: four heartbeats."""

# An execution's status; a target's status within it.
QUEUED: Final = "queued"
EXECUTING: Final = "executing"
PAUSED: Final = "paused"
COMPLETED: Final = "completed"
FAILED: Final = "failed"
CANCELED: Final = "canceled"
ENDED: Final = (COMPLETED, FAILED, CANCELED)
NOT_STARTED: Final = "not_started"
DONE: Final = "done"
SKIPPED: Final = "skipped"
UNKNOWN: Final = "unknown"

T = TypeVar("T")
Count = Annotated[int, Field(ge=0, lt=2**31)]
Distance = Annotated[float, Field(ge=0)]
Rows = tuple[tuple[float, ...], ...]


@dataclass_transform(frozen_default=True)
def _message(cls: type[T]) -> type[T]:
    """A frozen dataclass that is checked strictly when it arrives."""
    config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)
    return with_config(config)(dataclass(frozen=True)(cls))


class InvalidMessage(HardwareError):
    """Something came over the link that is no message."""

    code = "invalid_message"


@_message
class Failure:
    """What went wrong: a code for programs, a sentence for people, and when."""

    code: str
    detail: str
    at: str


@_message
class ServoHealth:
    """What one servo said last.

    Attributes:
        torque: whether it is under power: torque enabled, and a torque limit above 0.
        errors: names of the error bits in its last answer.
        load_share: present load as a share of full torque, inferred by the servo, signed.
        retries: reads of it that had to be repeated since the worker started.
    """

    id: Count
    joint: str
    torque: bool
    position_rad: float
    load_share: float
    voltage_v: float
    temperature_c: Count
    errors: tuple[str, ...]
    retries: Count
    read_at: str


@_message
class TargetAccount:
    """What became of one target.

    Attributes:
        status: not_started, executing, done, skipped or unknown.
        measured_standby_joints, measured_thinning_joints: means of several reads after arrival.
        standby_error_m, target_error_m: distance of the tool centre point, by forward kinematics of
            these means, from where the plan has it.
    """

    target_id: str
    status: str
    measured_standby_joints: tuple[float, ...] | None = None
    measured_thinning_joints: tuple[float, ...] | None = None
    standby_error_m: Distance | None = None
    target_error_m: Distance | None = None
    error: Failure | None = None


# --- From the worker ------------------------------------------------------------------------------
@_message
class Hello:
    """The first message: who joins. `model_version` is the digest of the worker's model file."""

    robot: str
    model_version: str
    tool: str
    end_effector: str
    device: str
    simulated: bool
    calibration_rad: tuple[float, ...]
    version: str
    type: Literal["hello"] = "hello"


@_message
class Telemetry:
    """How the arm is now.

    Attributes:
        status: idle, executing, paused or fault.
        joints: from the last reads; absent until every servo has been read.
        joints_read_at: when the oldest of those reads was made.
        torque: on, off, partly, or unknown while a servo does not answer.
        end_effector_state: on, off, none or unknown.
        faults: latched until acknowledged.
        overruns: ticks of the control loop that came late since the worker started.
    """

    status: str
    torque: str
    end_effector_state: str
    faults: tuple[Failure, ...]
    servos: tuple[ServoHealth, ...]
    overruns: Count
    joints: tuple[float, ...] | None = None
    joints_read_at: str | None = None
    execution_id: str | None = None
    type: Literal["telemetry"] = "telemetry"


@_message
class ExecutionAccount:
    """How an execution stands, in full each time, so that a lost message costs nothing.

    Attributes:
        status: executing, paused, completed, failed or canceled.
        segment: what the arm is doing: approach (to the plan's start), transfer, cut_in, dwell,
            retreat; absent when nothing.
    """

    execution_id: str
    status: str
    targets: tuple[TargetAccount, ...]
    segment: str | None = None
    error: Failure | None = None
    type: Literal["execution_account"] = "execution_account"


@_message
class StopReport:
    """The answer to a stop: what was done and what was verified by reading.

    Attributes:
        stopped: nothing is commanded any more, a hold was sent where torque is on, and every servo
            was read twice after that and stood still.
        verified: that, and the end-effector was read back as off.
        joints: from the last of these reads.
    """

    request_id: str
    stopped: bool
    verified: bool
    detail: str
    joints: tuple[float, ...] | None = None
    joints_read_at: str | None = None
    type: Literal["stop_report"] = "stop_report"


@_message
class AcknowledgeReport:
    """The answer to an acknowledgement: the faults that are left; none if it cleared."""

    request_id: str
    faults: tuple[Failure, ...]
    type: Literal["acknowledge_report"] = "acknowledge_report"


# --- From the service -----------------------------------------------------------------------------
@_message
class Welcome:
    """The answer to a hello that is accepted."""

    robot: str
    type: Literal["welcome"] = "welcome"


@_message
class Heartbeat:
    """The service is there."""

    type: Literal["heartbeat"] = "heartbeat"


@_message
class Execute:
    """An execution follows: this, then `target_count` messages of type target_motion."""

    execution_id: str
    plan_id: str
    tool: str
    model_version: str
    start_joints: tuple[float, ...]
    target_count: Count
    type: Literal["execute"] = "execute"


@_message
class SegmentTimes:
    """A named part of a trajectory: transfer, cut_in, dwell, retreat."""

    name: str
    start_s: float
    end_s: float


@_message
class TargetMotion:
    """The verified, timed motion for one target, joint-linear between rows."""

    execution_id: str
    index: Count
    target_id: str
    standby_joints: tuple[float, ...]
    thinning_joints: tuple[float, ...]
    times_s: tuple[float, ...]
    joints: Rows
    segments: tuple[SegmentTimes, ...]
    type: Literal["target_motion"] = "target_motion"


@_message
class Pause:
    """Slow down to a stand on the path."""

    execution_id: str
    type: Literal["pause"] = "pause"


@_message
class Resume:
    """Go on along the path."""

    execution_id: str
    type: Literal["resume"] = "resume"


@_message
class Cancel:
    """Slow down to a stand on the path and end there."""

    execution_id: str
    type: Literal["cancel"] = "cancel"


@_message
class Stop:
    """Hold at once, in whatever state."""

    request_id: str
    type: Literal["stop"] = "stop"


@_message
class Acknowledge:
    """A person has seen the faults: check again and clear what is gone."""

    request_id: str
    type: Literal["acknowledge"] = "acknowledge"


FromWorker = Hello | Telemetry | ExecutionAccount | StopReport | AcknowledgeReport
FromService = (
    Welcome | Heartbeat | Execute | TargetMotion | Pause | Resume | Cancel | Stop | Acknowledge
)


def encode(message: FromWorker | FromService) -> str:
    """A message as JSON text."""
    return orjson.dumps(message).decode()


def decode_from_worker(text: str | bytes) -> FromWorker:
    """The worker's message in a text; InvalidMessage if it is none."""
    try:
        return _worker_messages().validate_json(text)
    except ValidationError as error:
        raise InvalidMessage(_first_fault(error)) from error


def decode_from_service(text: str | bytes) -> FromService:
    """The service's message in a text; InvalidMessage if it is none."""
    try:
        return _service_messages().validate_json(text)
    except ValidationError as error:
        raise InvalidMessage(_first_fault(error)) from error


@cache
def _worker_messages() -> TypeAdapter[FromWorker]:
    return TypeAdapter(Annotated[FromWorker, Field(discriminator="type")])


@cache
def _service_messages() -> TypeAdapter[FromService]:
    return TypeAdapter(Annotated[FromService, Field(discriminator="type")])


def _first_fault(error: ValidationError) -> str:
    fault = error.errors(include_url=False, include_input=False, include_context=False)[0]
    return f"{'/'.join(map(str, fault['loc']))}: {fault['msg']}"
