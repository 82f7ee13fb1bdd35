"""Joints and motors: which servos drive a joint, and what their ticks mean for it."""

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import resources
from pathlib import Path
from typing import Any, Final

import numpy as np

from hardware.exceptions import InvalidArm
from hardware.servos.control_tables import ServoModel, servo_models
from hardware.servos.units import motor_angle, position_ticks
from hardware.tolerances import LARGEST_CALIBRATION_RAD
from solver import Array, Robot

SINGLE: Final = "single"
MIRRORED: Final = "mirrored"
SYNC_CABLE: Final = "sync_cable"


@dataclass(frozen=True)
class Motor:
    """One servo on the bus."""

    id: int
    servo: ServoModel


@dataclass(frozen=True)
class JointDrive:
    """A joint and its motor, or its pair of motors back to back.

    motor angle = sign * joint angle + offset_rad + calibration_rad; a partner's count is the mirror
    of the first motor's whole count, so that the two never disagree by rounding.

    Attributes:
        coupling: "single"; "mirrored": both motors get goals; "sync_cable": the partner follows by
            a cable of its own and gets none.
    """

    joint: str
    sign: int
    offset_rad: float
    motors: tuple[Motor, ...]
    coupling: str
    calibration_rad: float = 0.0

    @property
    def servo(self) -> ServoModel:
        """The kind of servo; the same for both of a pair."""
        return self.motors[0].servo

    def ticks(self, q: float) -> int:
        """The first motor's count at a joint angle [rad]; it may be outside the servo's range."""
        angle = self.sign * q + self.offset_rad + self.calibration_rad
        return position_ticks(self.servo, angle)

    def reaches(self, q: float) -> bool:
        """Whether a joint angle is inside the servo's range [rad]."""
        return 0 <= self.ticks(float(q)) <= self.servo.highest_position

    def angle(self, ticks: float) -> float:
        """The joint angle at a count of the first motor [rad]."""
        angle = motor_angle(self.servo, ticks)
        return self.sign * (angle - self.offset_rad - self.calibration_rad)

    def mirrored(self, ticks: float) -> float:
        """The partner's count where the first motor stands at `ticks`, and the other way round."""
        return self.servo.highest_position - ticks

    def goals(self, ticks: int) -> dict[int, int]:
        """Counts to send, by servo id, for a count of the first motor."""
        sent = {self.motors[0].id: ticks}
        if self.coupling == MIRRORED:
            sent[self.motors[1].id] = round(self.mirrored(ticks))
        return sent

    def first_motor_ticks(self, positions: Mapping[int, float]) -> tuple[float, ...]:
        """What each motor of the joint says about the first one's count."""
        first, *partner = (positions[motor.id] for motor in self.motors)
        return (first, *map(self.mirrored, partner))


@dataclass(frozen=True)
class ArmMap:
    """All joints of an arm, in the order of its joint vectors."""

    robot: str
    drives: tuple[JointDrive, ...]

    @property
    def motors(self) -> tuple[Motor, ...]:
        """Every servo, in joint order."""
        return tuple(motor for drive in self.drives for motor in drive.motors)

    @property
    def calibration_rad(self) -> tuple[float, ...]:
        """The calibration of each joint [rad]."""
        return tuple(drive.calibration_rad for drive in self.drives)

    def goals(self, q: Sequence[float] | Array) -> dict[int, int]:
        """Counts to send for a joint vector [rad], by servo id."""
        sent: dict[int, int] = {}
        for drive, angle in zip(self.drives, q, strict=True):
            sent |= drive.goals(drive.ticks(float(angle)))
        return sent

    def joints(self, positions: Mapping[int, float]) -> Array:
        """The joint vector at counts, or means of counts, of every servo [rad].

        The two motors of a pair are averaged. It inverts `goals`, calibration included.
        """
        ticks = (drive.first_motor_ticks(positions) for drive in self.drives)
        means = (sum(values) / len(values) for values in ticks)
        return np.array([d.angle(mean) for d, mean in zip(self.drives, means, strict=True)])


def arm_names() -> tuple[str, ...]:
    """Robots with an arm file, sorted."""
    folder = resources.files("hardware.servos.arms")
    files = (Path(entry.name) for entry in folder.iterdir())
    return tuple(sorted(file.stem for file in files if file.suffix == ".toml"))


def load_arm(robot: Robot, model: str, calibration: Path | None = None) -> ArmMap:
    """The map of the arm file of that model, with a calibration file or else the one that ships.

    Raises:
        InvalidArm: no such file, or one that does not fit the robot.
    """
    if model not in arm_names():
        raise InvalidArm(f"{model} has no arm file; known: {', '.join(arm_names())}")
    arm = _parse_arm((resources.files("hardware.servos.arms") / f"{model}.toml").read_bytes())
    if tuple(drive.joint for drive in arm.drives) != robot.joint_names:
        raise InvalidArm(f"the arm file of {model} has other joints than the robot")
    shipped = resources.files("hardware.servos.calibrations") / f"{model}.toml"
    try:
        document = shipped.read_bytes() if calibration is None else calibration.read_bytes()
    except OSError as error:
        raise InvalidArm(f"{error.filename}: {error.strerror}") from error
    return calibrated(arm, document)


def calibrated(arm: ArmMap, document: bytes) -> ArmMap:
    """The arm with the offsets of a calibration file.

    Raises:
        InvalidArm: not TOML, another robot's, or a joint missing or unknown.
    """
    try:
        data = tomllib.loads(document.decode())
        if data["robot"] != arm.robot:
            raise InvalidArm(f"the calibration is of {data['robot']}, not of {arm.robot}")
        offsets = {name: math.radians(value) for name, value in data["offset_deg"].items()}
    except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError) as error:
        raise InvalidArm(f"the calibration file cannot be read: {error}") from error
    except RecursionError as error:
        raise InvalidArm("the calibration file is nested too deeply") from error
    if set(offsets) != {drive.joint for drive in arm.drives}:
        raise InvalidArm("the calibration needs one offset for each joint, and no other")
    if not all(abs(value) <= LARGEST_CALIBRATION_RAD for value in offsets.values()):
        most = math.degrees(LARGEST_CALIBRATION_RAD)
        raise InvalidArm(
            f"the calibration has an offset that is not a number within {most:.1f} deg"
        )
    drives = (replace(drive, calibration_rad=offsets[drive.joint]) for drive in arm.drives)
    return replace(arm, drives=tuple(drives))


def _parse_arm(document: bytes) -> ArmMap:
    data = tomllib.loads(document.decode())
    return ArmMap(data["robot"], tuple(map(_parse_drive, data["joints"])))


def _parse_drive(entry: Mapping[str, Any]) -> JointDrive:
    motors = tuple(Motor(motor["id"], servo_models()[motor["servo"]]) for motor in entry["motors"])
    coupling = entry.get("coupling", SINGLE)
    wanted = {SINGLE: 1, MIRRORED: 2, SYNC_CABLE: 2}
    if wanted.get(coupling) != len(motors):
        raise InvalidArm(f"{entry['name']}: {len(motors)} motors do not make it {coupling!r}")
    return JointDrive(
        joint=entry["name"],
        sign=entry["sign"],
        offset_rad=math.radians(entry["offset_deg"]),
        motors=motors,
        coupling=coupling,
    )
