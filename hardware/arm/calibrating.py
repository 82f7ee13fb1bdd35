"""`prunus calibrate`: offsets of the joints from one posture that is known to be true."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from hardware.arm.servo_chain import ServoChain
from hardware.arm.setup_check import check_model, check_pair
from hardware.bus.dynamixel_bus import DynamixelBus
from hardware.exceptions import OutsideLimits
from hardware.options import joints_from_degrees
from hardware.servos.instances import load_instance
from hardware.servos.joints import ArmMap, load_arm
from hardware.tolerances import LARGEST_CALIBRATION_RAD, MEASURED_READS
from solver import Array


def calibrate_arm(
    robot: str, port: str, baud_rate: int, joints_deg: str, output: Path
) -> dict[str, float]:
    """Measure an arm's offsets over its bus and write the file.

    Args:
        robot: its name.
        port: serial device of its servos.
        baud_rate: of the bus [1/s].
        joints_deg: where it truly stands, see `joints_from_degrees`.
        output: where the file goes.

    Returns:
        The offset of each joint [rad].

    Raises:
        UnknownRobot, HardwareError, OSError: it cannot be measured or written.
    """
    instance = load_instance(robot)
    posture = joints_from_degrees(joints_deg, len(instance.robot.joints))
    arm = _uncalibrated(load_arm(instance.robot, instance.model))
    bus = DynamixelBus(port, baud_rate)
    try:
        offsets = measure_offsets(ServoChain(arm, bus), posture)
    finally:
        bus.close()
    day = datetime.now(UTC).date().isoformat()
    # Whole or not at all: an earlier calibration is not lost to a full disk.
    whole = output.with_name(f".{output.name}.new")
    whole.write_bytes(calibration_file(arm, offsets, f"measured {day}"))
    whole.replace(output)
    return dict(zip(instance.robot.joint_names, offsets.tolist(), strict=True))


def measure_offsets(chain: ServoChain, true_joints: Sequence[float]) -> Array:
    """What has to be added to each joint's motor angle. Nothing is written to a servo.

    Args:
        chain: the servos, with an uncalibrated map.
        true_joints: where the arm stands, measured by somebody, shape (n,) [rad].

    Returns:
        Offsets, shape (n,) [rad]: mean of several reads, as fine as a servo's count.

    Raises:
        OutsideLimits: an offset so large that it is none: the posture or the assembly is wrong.
        HardwareError: a servo does not answer, reports an error, or a pair disagrees.
    """
    drives = chain.map.drives
    for motor in chain.map.motors:
        check_model(chain, motor)
    reads = []
    for _ in range(MEASURED_READS):
        positions = chain.sweep()
        for drive in drives:
            check_pair(drive, drive.first_motor_ticks(positions))
        reads.append(chain.map.joints(positions))
    signs = np.array([drive.sign for drive in drives])
    offsets = np.asarray(signs * (np.mean(reads, axis=0) - np.asarray(true_joints)))
    for drive, offset in zip(drives, offsets.tolist(), strict=True):
        if abs(offset) > LARGEST_CALIBRATION_RAD:
            raise OutsideLimits(drive.joint, f"reads {offset:.3f} rad off; that is no calibration")
    return offsets


def calibration_file(arm: ArmMap, offsets: Array, note: str) -> bytes:
    """A calibration file, see `hardware.servos.joints.calibrated`."""
    lines = [
        "# Added to each joint's motor angle, in degrees.",
        f'robot = "{arm.robot}"',
        f'note = "{note}"',
        "",
        "[offset_deg]",
        *(
            f"{drive.joint} = {offset:.3f}"
            for drive, offset in zip(arm.drives, np.degrees(offsets).tolist(), strict=True)
        ),
    ]
    return ("\n".join(lines) + "\n").encode()


def _uncalibrated(arm: ArmMap) -> ArmMap:
    drives = (replace(drive, calibration_rad=0.0) for drive in arm.drives)
    return replace(arm, drives=tuple(drives))
