"""What can go wrong with the servos, as exceptions with data. `code` is what clients get to see."""

from typing import ClassVar


class HardwareError(Exception):
    """Root of everything this package raises on purpose."""

    code: ClassVar[str] = "hardware"

    def __init__(self, detail: str) -> None:
        super().__init__(detail)
        self.detail = detail


class InvalidArm(HardwareError):
    """An arm or calibration file that cannot be read or does not fit its robot."""

    code = "invalid_arm"


class PortUnavailable(HardwareError):
    """The serial device cannot be opened: not there, not allowed, or somebody else's."""

    code = "port_unavailable"


class BusLost(HardwareError):
    """The serial device went away while it was in use."""

    code = "bus_lost"


class ServoError(HardwareError):
    """Something about one servo."""

    def __init__(self, servo_id: int, detail: str) -> None:
        super().__init__(f"servo {servo_id}: {detail}")
        self.servo_id = servo_id


class ServoMissing(ServoError):
    """A servo does not answer."""

    code = "servo_missing"


class CorruptPackets(ServoError):
    """A servo's answers stay unreadable, or it reports ours to be, after every retry."""

    code = "corrupt_packets"


class ServoAlarm(ServoError):
    """A servo reports errors: overload, overheating, voltage, a value that it refuses."""

    code = "servo_alarm"

    def __init__(self, servo_id: int, errors: tuple[str, ...]) -> None:
        super().__init__(servo_id, f"reports {', '.join(errors)}")
        self.errors = errors


class WrongSetting(ServoError):
    """A servo is not what the arm file says, or a register of it forbids safe use."""

    code = "wrong_setting"


class TorqueLost(ServoError):
    """A servo is not under power any more, though nobody here switched it off."""

    code = "torque_lost"


class JointError(HardwareError):
    """Something about one joint."""

    def __init__(self, joint: str, detail: str) -> None:
        super().__init__(f"{joint}: {detail}")
        self.joint = joint


class PairDisagreement(JointError):
    """Two servos on one joint do not stand at the same angle."""

    code = "pair_disagreement"

    def __init__(self, joint: str, apart_rad: float) -> None:
        super().__init__(joint, f"its two servos are {apart_rad:.4f} rad apart")
        self.apart_rad = apart_rad


class UnsafeGoal(JointError):
    """A goal outside the limits, or a step faster than the joint may turn. It was not sent."""

    code = "unsafe_goal"


class OutsideLimits(JointError):
    """The arm stands outside its joint limits, so no motion from there is known to be safe."""

    code = "outside_limits"


class FollowingError(JointError):
    """A joint lags behind its goal, or did not arrive at it."""

    code = "following_error"

    def __init__(self, joint: str, error_rad: float, detail: str) -> None:
        super().__init__(joint, f"{detail} by {abs(error_rad):.4f} rad")
        self.error_rad = error_rad


class EndEffectorFailed(HardwareError):
    """The end-effector's output is not what was commanded."""

    code = "end_effector_failed"


class OrderRefused(HardwareError):
    """An execution that this worker must not run: another model or tool, or run before."""

    code = "order_refused"


class JournalFailed(HardwareError):
    """The journal cannot be written, so an execution could be carried out twice."""

    code = "journal_failed"


class LinkLost(HardwareError):
    """The service was not heard for too long while the arm was moving."""

    code = "link_lost"


class Interrupted(HardwareError):
    """An earlier worker ended in the middle of an execution: where it stopped is unknown."""

    code = "interrupted"


class WorkerEnded(HardwareError):
    """The worker was told to end while the arm was moving."""

    code = "worker_ended"


class InternalError(HardwareError):
    """A defect of the worker; its log has it in full."""

    code = "internal_error"


class Stopped(HardwareError):
    """Somebody asked for a stop."""

    code = "stopped"


class Canceled(HardwareError):
    """Somebody canceled the execution."""

    code = "canceled"
