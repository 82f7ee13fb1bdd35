"""One order being carried out, tick by tick, and the account of it.

queued ─► executing ◄─► paused
              │             │
              └──────┬──────┘
         completed, failed, canceled
"""

from collections.abc import Callable, Generator, Iterator
from dataclasses import replace

import numpy as np

from hardware.arm.servo_arm import ServoArm
from hardware.clock import timestamp
from hardware.end_effector.end_effectors import EndEffector
from hardware.exceptions import Canceled, HardwareError
from hardware.link.messages import (
    CANCELED,
    COMPLETED,
    DONE,
    EXECUTING,
    FAILED,
    NOT_STARTED,
    PAUSED,
    SKIPPED,
    UNKNOWN,
    ExecutionAccount,
    Failure,
    TargetAccount,
)
from hardware.tolerances import (
    APPROACH_SHARE,
    MEASURED_READS,
    PAUSE_RAMP_S,
    SETTLE_S,
    TICK_S,
)
from hardware.worker.order import Order, Segment, TargetOrder
from solver import Array, Robot, Tool, forward_kinematics, time_joint_line


class Execution:
    """An order on an arm.

    `steps` is advanced once a control tick; `pause`, `resume` and `cancel` act on the path, which
    the arm never leaves: it only goes along it slower, down to a stand.

    Args:
        order: what to do.
        arm: on what.
        tool: the mounted tool, for the measured errors.
        end_effector: what is on during the dwell.
        on_change: called with every new account.
    """

    def __init__(
        self,
        order: Order,
        arm: ServoArm,
        tool: Tool,
        end_effector: EndEffector,
        on_change: Callable[[ExecutionAccount], None],
    ) -> None:
        self._order = order
        self._arm = arm
        self._tool = tool
        self._end_effector = end_effector
        self._on_change = on_change
        self._pace = 1.0
        self._wanted_pace = 1.0
        self._canceling = False
        self._worked_on = False
        targets = tuple(TargetAccount(target.target_id, NOT_STARTED) for target in order.targets)
        self.account = ExecutionAccount(order.execution_id, EXECUTING, targets)

    def pause(self) -> None:
        """Slow down to a stand on the path."""
        self._wanted_pace = 0.0

    def resume(self) -> None:
        """Go on along the path, unless it was canceled."""
        if not self._canceling:
            self._wanted_pace = 1.0

    def cancel(self) -> None:
        """Slow down to a stand on the path and end there; nothing takes that back."""
        self._wanted_pace = 0.0
        self._canceling = True

    def steps(self) -> Iterator[None]:
        """Carry it out; yields when the next tick has to be waited for.

        Raises:
            Canceled: it stands, after `cancel`.
            HardwareError: something went wrong; the caller holds the arm and calls `end`.
        """
        self._change(segment="approach")
        self._arm.enable_torque()
        yield from self._stream(self._way_to_start())
        yield from self._settle()
        for index, target in enumerate(self._order.targets):
            self._worked_on = False
            self._change_target(index, status=EXECUTING)
            yield from self._thin(index, target)
        yield from self._settle()
        self._change(status=COMPLETED, segment=None)

    def end(self, error: HardwareError) -> None:
        """Close the account: canceled or failed, with the reason.

        The target in hand is skipped, or unknown once the end-effector was on it.
        """
        failure = Failure(error.code, error.detail, timestamp())
        for index, target in enumerate(self.account.targets):
            if target.status == EXECUTING:
                status = UNKNOWN if self._worked_on else SKIPPED
                self._change_target(index, status=status, error=failure)
        status = CANCELED if isinstance(error, Canceled) else FAILED
        self._change(status=status, segment=None, error=failure)

    def _thin(self, index: int, target: TargetOrder) -> Iterator[None]:
        transfer, cut_in, dwell, retreat = target.segments
        yield from self._stream(transfer)
        joints, error_m = yield from self._measure(target.standby)
        self._change_target(index, measured_standby_joints=joints, standby_error_m=error_m)
        yield from self._stream(cut_in)
        joints, error_m = yield from self._measure(target.thinning)
        self._change_target(index, measured_thinning_joints=joints, target_error_m=error_m)
        yield from self._dwell(dwell)
        self._change_target(index, status=DONE)
        yield from self._stream(retreat)

    def _way_to_start(self) -> Segment:
        motion = time_joint_line(
            _slowed(self._arm.robot), self._arm.commanded, self._order.start, TICK_S
        )
        return Segment("approach", motion.times_s, motion.joints)

    def _stream(self, segment: Segment) -> Iterator[None]:
        self._change(segment=segment.name)
        elapsed = 0.0
        while elapsed < segment.duration_s:
            elapsed = min(elapsed + TICK_S * self._next_pace(), segment.duration_s)
            self._arm.command(segment.posture(elapsed), TICK_S)
            yield

    def _dwell(self, segment: Segment) -> Iterator[None]:
        self._change(segment=segment.name)
        left, on = segment.duration_s, False
        while left > 0:
            if on != (self._wanted_pace > 0):
                on = not on
                self._worked_on = True
                self._end_effector.switch(on=on)
            self._next_pace()
            since = self._arm.clock.now()
            yield
            if on:
                # By the clock and not by ticks: a late tick is light all the same, if light it was.
                self._end_effector.stay_on()
                left -= self._arm.clock.now() - since
        self._end_effector.switch(on=False)

    def _settle(self) -> Iterator[None]:
        positions = self._arm.chain.sweep()
        for _ in range(round(SETTLE_S / TICK_S)):
            if self._arm.has_arrived(positions):
                return
            self._next_pace()
            yield
            positions = self._arm.chain.sweep()
        self._arm.check_arrived(positions)

    def _measure(self, planned: Array) -> Generator[None, None, tuple[tuple[float, ...], float]]:
        """After arrival: the mean of several reads, and how far the tool is from where it is due.

        Returns:
            The measured joints [rad] and the distance of the tool centre point [m].
        """
        yield from self._settle()
        reads = []
        for _ in range(MEASURED_READS):
            reads.append(self._arm.read_joints())
            self._next_pace()
            yield
        measured = np.mean(reads, axis=0)
        poses = forward_kinematics(self._arm.robot, self._tool, np.stack((measured, planned)))
        error_m = float(np.linalg.norm(poses[0, :3, 3] - poses[1, :3, 3]))
        return tuple(measured.tolist()), error_m

    def _next_pace(self) -> float:
        most = TICK_S / PAUSE_RAMP_S
        self._pace += min(most, max(-most, self._wanted_pace - self._pace))
        standing = self._pace <= 0
        if standing and self._canceling:
            raise Canceled("canceled on request; the arm holds where it stands")
        self._change(status=PAUSED if standing else EXECUTING)
        return self._pace

    def _change(self, **fields: object) -> None:
        changed = replace(self.account, **fields)  # type: ignore[arg-type]
        if changed != self.account:
            self.account = changed
            self._on_change(changed)

    def _change_target(self, index: int, **fields: object) -> None:
        targets = list(self.account.targets)
        targets[index] = replace(targets[index], **fields)  # type: ignore[arg-type]
        self._change(targets=tuple(targets))


def _slowed(robot: Robot) -> Robot:
    joints = tuple(
        replace(
            joint,
            velocity=joint.velocity * APPROACH_SHARE,
            acceleration=joint.acceleration * APPROACH_SHARE,
        )
        for joint in robot.joints
    )
    return replace(robot, joints=joints)
