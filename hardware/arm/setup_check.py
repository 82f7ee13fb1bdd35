"""Is every servo the one of the arm file, healthy, and set up for safe use?"""

from hardware.arm.servo_chain import ServoChain
from hardware.exceptions import PairDisagreement, WrongSetting
from hardware.servos.control_tables import SIMULATED_FIRMWARE
from hardware.servos.joints import SYNC_CABLE, JointDrive, Motor
from hardware.servos.units import ticks_per_radian
from hardware.tolerances import PAIR_RAD
from solver import Joint, Robot

ALL_ANSWERS = 2
SLAVE = 2


def is_simulated(chain: ServoChain) -> bool:
    """Whether servos answer, and all that do say that they are simulated.

    Raises:
        BusLost: the device is gone.
    """
    versions = chain.values_of_what_answers("firmware_version").values()
    return bool(versions) and all(version == SIMULATED_FIRMWARE for version in versions)


def check_setup(robot: Robot, chain: ServoChain) -> None:
    """Check every servo.

    Raises:
        HardwareError: the first servo that is missing, wrong, in alarm, or set up so that a goal
            would not be what it says.
    """
    for joint, drive in zip(robot.joints, chain.map.drives, strict=True):
        for motor in drive.motors:
            _check_servo(chain, drive, motor)
            _check_range(chain, joint, drive, motor)
        check_pair(drive, chain.read_drive(drive))


def check_pair(drive: JointDrive, says: tuple[float, ...]) -> None:
    """Check that the two servos of a joint stand at one angle.

    Args:
        drive: the joint.
        says: what each of its motors says about the first one's count.

    Raises:
        PairDisagreement: they do not.
    """
    apart = (max(says) - min(says)) / ticks_per_radian(drive.servo)
    if apart > PAIR_RAD:
        raise PairDisagreement(drive.joint, apart)


def check_model(chain: ServoChain, motor: Motor) -> None:
    """Check that a servo is of the kind that the arm file says; WrongSetting if not."""
    number = chain.value(motor, "model_number")
    if number != motor.servo.model_number:
        detail = f"is model {number}, the arm file says {motor.servo.name}"
        raise WrongSetting(motor.id, detail)


def _check_servo(chain: ServoChain, drive: JointDrive, motor: Motor) -> None:
    check_model(chain, motor)
    level = chain.value(motor, "status_return_level")
    if level != ALL_ANSWERS:
        raise WrongSetting(motor.id, f"status return level is {level}, needs {ALL_ANSWERS}")
    if chain.value(motor, "torque_limit") == 0:
        detail = "torque limit is 0, as after a shutdown; find the cause, then cycle its power"
        raise WrongSetting(motor.id, detail)
    if "drive_mode" in motor.servo.registers:
        follows = drive.coupling == SYNC_CABLE and motor is not drive.motors[0]
        mode, wanted = chain.value(motor, "drive_mode"), SLAVE if follows else 0
        if mode != wanted:
            detail = f"drive mode is {mode}, coupling {drive.coupling!r} needs {wanted}"
            raise WrongSetting(motor.id, detail)


def _check_range(chain: ServoChain, joint: Joint, drive: JointDrive, motor: Motor) -> None:
    lowest = chain.value(motor, "cw_angle_limit")
    highest = chain.value(motor, "ccw_angle_limit")
    if not (lowest or highest):
        raise WrongSetting(motor.id, "both angle limits are 0: it would turn without end")
    ends = [float(drive.ticks(joint.lower)), float(drive.ticks(joint.upper))]
    if motor is not drive.motors[0]:
        ends = [drive.mirrored(end) for end in ends]
    if lowest > max(0, min(ends)) or highest < min(motor.servo.highest_position, max(ends)):
        detail = f"its angle limits, {lowest} to {highest}, cut into the range of {joint.name}"
        raise WrongSetting(motor.id, detail)
