"""End-effector off, arm held: what every fault and every stop does, and what came of it."""

from dataclasses import dataclass
from typing import Final

from hardware.arm.servo_arm import HeldPosture, ServoArm
from hardware.clock import timestamp
from hardware.end_effector.end_effectors import EndEffector
from hardware.exceptions import HardwareError
from hardware.link.messages import StopReport

TORQUE_UNKNOWN: Final = "it is not known where torque is on; nothing moves"
DETAILS: Final = {
    "on": "the arm holds where it stands",
    "off": "torque is off: nothing was held, and nothing moves",
}


@dataclass(frozen=True)
class SafeState:
    """What came of it.

    Attributes:
        held: what the hold did; None if it could not be sent.
        trouble: what did not work, in sentences.
    """

    held: HeldPosture | None
    trouble: tuple[str, ...]


def make_safe(arm: ServoArm, end_effector: EndEffector) -> SafeState:
    """Switch the end-effector off and hold the arm; whatever fails, the rest is done."""
    trouble: list[str] = []
    try:
        end_effector.switch(on=False)
    except HardwareError as error:
        trouble.append(error.detail)
        try:
            end_effector.recover()
        except HardwareError as error:
            trouble.append(error.detail)
        else:
            trouble.append("another guard switched it off")
    try:
        held = arm.hold()
    except HardwareError as error:
        trouble.append(f"the arm could not be told to hold: {error.detail}")
        return SafeState(None, tuple(trouble))
    if held.detail:
        trouble.append(held.detail)
    return SafeState(held, tuple(trouble))


def stop_report(request_id: str, safe: SafeState, torque: str) -> StopReport:
    """The answer to a stop; it claims nothing that was not read back."""
    detail = "; ".join(safe.trouble) or DETAILS.get(torque, TORQUE_UNKNOWN)
    held = safe.held
    if held is None or held.joints is None:
        return StopReport(request_id, stopped=False, verified=False, detail=detail)
    return StopReport(
        request_id,
        stopped=held.still,
        verified=held.still and not safe.trouble,
        detail=detail,
        joints=tuple(held.joints.tolist()),
        joints_read_at=timestamp(),
    )
