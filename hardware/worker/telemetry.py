"""How the arm is now, in one message."""

from dataclasses import replace
from typing import Final

from hardware.arm.servo_arm import ServoArm
from hardware.end_effector.end_effectors import EndEffector
from hardware.link.messages import ExecutionAccount, Failure, Telemetry

IDLE: Final = "idle"
FAULT: Final = "fault"


def telemetry(
    arm: ServoArm,
    end_effector: EndEffector,
    faults: tuple[Failure, ...],
    account: ExecutionAccount | None,
    overruns: int,
) -> Telemetry:
    """Telemetry from what was read last; nothing is read for it.

    Args:
        arm: the servos.
        end_effector: at the tool.
        faults: that are latched; with any of them the status is fault.
        account: of the execution under way, whose status is the worker's then.
        overruns: ticks that came late.
    """
    status = FAULT if faults else IDLE if account is None else account.status
    message = Telemetry(
        status=status,
        torque=arm.torque,
        end_effector_state=end_effector.state,
        faults=faults,
        servos=arm.chain.health(),
        overruns=overruns,
        execution_id=None if account is None else account.execution_id,
    )
    posture = arm.chain.last_posture()
    if posture is None:
        return message
    joints, read_at = posture
    return replace(message, joints=tuple(joints.tolist()), joints_read_at=read_at)
