"""The arm on its bus: joint vectors in and out, every goal checked, every read judged."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from hardware.arm.safety import check_goal, check_posture
from hardware.arm.servo_chain import ServoChain
from hardware.arm.setup_check import check_pair, check_setup
from hardware.bus.bus import ServoBus
from hardware.clock import RobotClock
from hardware.exceptions import FollowingError, PairDisagreement, TorqueLost, WrongSetting
from hardware.servos.joints import ArmMap, JointDrive
from hardware.servos.units import speed_ticks, ticks_per_radian
from hardware.tolerances import (
    CATCH_UP,
    FOLLOWING_RAD,
    HOLD_SPEED_RAD_S,
    LOWEST_SPEED_RAD_S,
    PERSISTENT_POLLS,
    SETTLE_TICKS,
    STILL_INTERVAL_S,
    STILL_S,
    STILL_TICKS,
    TORQUE_JUMP_TICKS,
)
from solver import Array, Robot


@dataclass(frozen=True)
class HeldPosture:
    """What a hold did.

    Attributes:
        still: whether every servo answered, and two reads in succession
            found them standing.
        joints: the last posture read [rad]; None if a servo could not be read.
        detail: what is wrong, or "".
    """

    still: bool
    joints: Array | None
    detail: str


class ServoArm:
    """An arm's servos behind a bus. One thread uses it.

    Attributes:
        clock: robot time.
    """

    def __init__(self, robot: Robot, arm: ArmMap, bus: ServoBus, clock: RobotClock) -> None:
        self.robot = robot
        self.map = arm
        self.chain = ServoChain(arm, bus)
        self.clock = clock
        self._holding = False
        self._commanded: Array | None = None
        self._next_poll = 0
        self._lagging: Counter[str] = Counter()
        self._disagreeing: Counter[str] = Counter()

    @property
    def torque(self) -> str:
        """By the last reads: on, off or partly; unknown while a servo does not answer."""
        powered = [self.chain.powered.get(motor.id) for motor in self.map.motors]
        if None in powered:
            return "unknown"
        return "on" if all(powered) else "partly" if any(powered) else "off"

    @property
    def commanded(self) -> Array:
        """The last posture that was commanded, shape (n,) [rad]; RuntimeError before any was."""
        if self._commanded is None:
            raise RuntimeError("torque has to be enabled before a goal is commanded")
        return self._commanded

    def check(self) -> None:
        """Learn where torque is on, then check every servo's kind, settings and health.

        Raises:
            HardwareError: see `hardware.arm.setup_check.check_setup`.
        """
        self.chain.survey()
        self._holding = self.torque == "on"
        if not self._holding:
            self._forget_command()
        check_setup(self.robot, self.chain)

    def read_joints(self) -> Array:
        """The posture, from one read of every servo, shape (n,) [rad].

        Raises:
            HardwareError: a servo does not answer or reports an error.
        """
        return self.map.joints(self.chain.sweep())

    def enable_torque(self) -> None:
        """Put the arm under power where it stands.

        Each servo gets its present position as goal, with a low speed, both are read back, and only
        then is torque enabled: a stale goal would be run to at full speed.

        Raises:
            OutsideLimits: it stands outside its joint limits.
            HardwareError: a servo refused, or moved.
        """
        before = self.chain.sweep()
        check_posture(self.robot, self.map, self.map.joints(before))
        for drive in self.map.drives:
            check_pair(drive, drive.first_motor_ticks(before))
        goals, speed = self._goals_at(before), speed_ticks(HOLD_SPEED_RAD_S)
        self.chain.send(goals, dict.fromkeys(goals, speed))
        for motor in self.map.motors:
            if motor.id in goals:
                self.chain.expect(motor, "goal_position", goals[motor.id])
                self.chain.expect(motor, "moving_speed", speed)
        for motor in self.map.motors:
            self.chain.enable_torque(motor)
        for servo_id, ticks in self.chain.sweep().items():
            if abs(ticks - before[servo_id]) > TORQUE_JUMP_TICKS:
                detail = f"moved by {ticks - before[servo_id]} counts when torque came on"
                raise WrongSetting(servo_id, detail)
        self._holding = True
        self._commanded = self.map.joints(before)

    def command(self, goal: Array, step_s: float) -> None:
        """Send every joint to a goal, to arrive in one step; nothing is sent that fails the check.

        Args:
            goal: shape (n,) [rad].
            step_s: time in which it is to be reached [s].

        Raises:
            UnsafeGoal: see `hardware.arm.safety.check_goal`.
        """
        check_goal(self.robot, self.map, self.commanded, goal, step_s)
        needed = np.abs(goal - self.commanded) / step_s * CATCH_UP
        counts = [speed_ticks(max(speed, LOWEST_SPEED_RAD_S)) for speed in needed.tolist()]
        speeds = {
            motor.id: speed
            for drive, speed in zip(self.map.drives, counts, strict=True)
            for motor in drive.motors
        }
        self.chain.send(self.map.goals(goal), speeds)
        self._commanded = goal.copy()

    def poll(self) -> None:
        """Read the next joint in rotation, and judge what it says about the last goal.

        Raises:
            TorqueLost: a servo is without power while the arm is held or moved.
            FollowingError: it lags behind its goal, read after read.
            PairDisagreement: its two servos stand apart, read after read.
            HardwareError: a servo does not answer or reports an error.
        """
        i = self._next_poll
        self._next_poll = (i + 1) % len(self.map.drives)
        drive = self.map.drives[i]
        says = self.chain.read_drive(drive)
        self._watch_pair(drive, says)
        if self._holding:
            self._watch_power(drive)
        if self._commanded is not None:
            error = drive.angle(sum(says) / len(says)) - float(self._commanded[i])
            self._watch_lag(drive, error)

    def has_arrived(self, positions: Mapping[int, int]) -> bool:
        """Whether every servo stands at the last goal, by counts just read."""
        return not self._away_from_goal(positions)

    def check_arrived(self, positions: Mapping[int, int]) -> None:
        """Raise FollowingError for the joint that is furthest from the last goal."""
        if away := self._away_from_goal(positions):
            joint = max(away, key=lambda name: abs(away[name]))
            raise FollowingError(joint, away[joint], "did not arrive: it is off its goal")

    def hold(self) -> HeldPosture:
        """Stop where the arm stands, and see whether it does.

        Only servos under power get a goal, as a goal would put the others under power. One that
        cannot be read keeps its last goal, which is a short step away. The two of a pair that
        disagree are each held where they say they stand, which moves neither.

        Raises:
            BusLost: nothing could be sent.
        """
        positions = self.chain.survey()
        powered = self.chain.powered
        goals = self._goals_at(positions)
        if held := {servo_id: goals[servo_id] for servo_id in goals if powered.get(servo_id)}:
            self.chain.send(held, dict.fromkeys(held, speed_ticks(HOLD_SPEED_RAD_S)))
        missing = self._missing(positions)
        deadline = self.clock.now() + STILL_S
        still = False
        while not missing and not still and self.clock.now() < deadline:
            self.clock.sleep(STILL_INTERVAL_S)
            last = positions
            positions = self.chain.survey()
            missing = self._missing(positions)
            still = not missing and all(
                abs(ticks - last[servo_id]) <= STILL_TICKS for servo_id, ticks in positions.items()
            )
        if missing:
            return HeldPosture(False, None, f"these servos cannot be read: {missing}")
        posture = self.map.joints(positions)
        if self.torque == "on" and self._commanded is not None:
            self._commanded = posture
        else:
            self._forget_command()
        return HeldPosture(still, posture, self._doubts(positions, still))

    def _doubts(self, positions: Mapping[int, int], still: bool) -> str:
        """What keeps a hold from being one, in words; "" if nothing does."""
        doubts = [] if still else ["the arm still moves"]
        if self.torque == "partly":
            without = (str(i) for i, powered in self.chain.powered.items() if not powered)
            doubts.append(f"these servos have no torque and are not held: {', '.join(without)}")
        for drive in self.map.drives:
            try:
                check_pair(drive, drive.first_motor_ticks(positions))
            except PairDisagreement as error:
                doubts.append(error.detail)
        return "; ".join(doubts)

    def _forget_command(self) -> None:
        self._commanded = None
        self._lagging.clear()
        self._disagreeing.clear()

    def _missing(self, positions: Mapping[int, int]) -> str:
        return ", ".join(str(motor.id) for motor in self.map.motors if motor.id not in positions)

    def _goals_at(self, positions: Mapping[int, int]) -> dict[int, int]:
        """Goals that keep every joint of which all motors are known where it stands."""
        goals: dict[int, int] = {}
        for drive in self.map.drives:
            if any(motor.id not in positions for motor in drive.motors):
                continue
            says = drive.first_motor_ticks(positions)
            own = drive.goals(round(sum(says) / len(says)))
            try:
                check_pair(drive, says)
            except PairDisagreement:
                own = {servo_id: positions[servo_id] for servo_id in own}
            goals |= own
        return goals

    def _watch_power(self, drive: JointDrive) -> None:
        for motor in drive.motors:
            if not self.chain.powered[motor.id]:
                self._holding = False
                self._forget_command()
                raise TorqueLost(motor.id, "has lost its torque: its power failed, or it shut down")

    def _watch_lag(self, drive: JointDrive, error: float) -> None:
        self._lagging[drive.joint] += 1
        if abs(error) <= FOLLOWING_RAD:
            self._lagging[drive.joint] = 0
        if self._lagging[drive.joint] >= PERSISTENT_POLLS:
            self._lagging.clear()
            raise FollowingError(drive.joint, error, "lags behind its goal")

    def _watch_pair(self, drive: JointDrive, says: tuple[float, ...]) -> None:
        try:
            check_pair(drive, says)
        except PairDisagreement:
            self._disagreeing[drive.joint] += 1
            if self._disagreeing[drive.joint] >= PERSISTENT_POLLS:
                self._disagreeing.clear()
                raise
        else:
            self._disagreeing[drive.joint] = 0

    def _away_from_goal(self, positions: Mapping[int, int]) -> dict[str, float]:
        away: dict[str, float] = {}
        if self._commanded is None:
            return away
        for drive, q in zip(self.map.drives, self._commanded.tolist(), strict=True):
            goal = drive.ticks(q)
            worst = max((says - goal for says in drive.first_motor_ticks(positions)), key=abs)
            if abs(worst) > SETTLE_TICKS:
                away[drive.joint] = drive.sign * worst / ticks_per_radian(drive.servo)
        return away
