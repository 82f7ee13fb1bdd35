"""An execution as the service sends it, checked as a whole before anything moves."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hardware.arm.safety import check_rows
from hardware.exceptions import OrderRefused
from hardware.link.messages import Execute, TargetMotion
from hardware.servos.joints import ArmMap
from hardware.tolerances import JOINED_RAD
from solver import Array, Robot, Tool

SEGMENTS = ("transfer", "cut_in", "dwell", "retreat")


@dataclass(frozen=True)
class Segment:
    """A piece of a target's motion: times from 0 [s], rows of joint vectors (n, joints) [rad]."""

    name: str
    times_s: Array
    rows: Array

    @property
    def duration_s(self) -> float:
        """How long it takes at full pace [s]."""
        return float(self.times_s[-1])

    def posture(self, time_s: float) -> Array:
        """The joint vector at a time, linear between rows [rad]."""
        columns = (np.interp(time_s, self.times_s, column) for column in self.rows.T)
        return np.array(list(columns))


@dataclass(frozen=True)
class TargetOrder:
    """The motion for one target.

    Attributes:
        standby, thinning: where the tool is to arrive, shape (n,) [rad].
        segments: transfer, cut_in, dwell, retreat.
    """

    target_id: str
    standby: Array
    thinning: Array
    segments: tuple[Segment, ...]


@dataclass(frozen=True)
class Order:
    """A whole execution: from `start` through every target's segments, without a gap."""

    execution_id: str
    start: Array
    targets: tuple[TargetOrder, ...]


def build_order(
    robot: Robot, tool: Tool, arm: ArmMap, execute: Execute, motions: Sequence[TargetMotion]
) -> Order:
    """The order in an `execute` message and its `target_motion` messages.

    Raises:
        OrderRefused: for another model or tool, incomplete, or with a gap in its motion.
        UnsafeGoal: a row or a step that must not be commanded.
    """
    if execute.model_version != robot.version:
        raise OrderRefused("the plan was made with another version of the robot's model")
    if execute.tool != tool.name:
        raise OrderRefused(f"the plan is for the tool {execute.tool}, mounted is {tool.name}")
    if [motion.index for motion in motions] != list(range(execute.target_count)):
        raise OrderRefused("a target's motion is missing")
    if len(execute.start_joints) != len(robot.joints):
        raise OrderRefused(f"the start needs {len(robot.joints)} joints")
    targets = tuple(_target(motion, len(robot.joints)) for motion in motions)
    start = np.array(execute.start_joints)
    last = start
    for target in targets:
        if tuple(segment.name for segment in target.segments) != SEGMENTS:
            raise OrderRefused(f"target {target.target_id}: the motion has other segments")
        for segment in target.segments:
            check_rows(robot, arm, segment.times_s, segment.rows)
            if np.abs(segment.rows[0] - last).max() > JOINED_RAD:
                raise OrderRefused(f"target {target.target_id}: {segment.name} begins elsewhere")
            last = segment.rows[-1]
    return Order(execute.execution_id, start, targets)


def _target(motion: TargetMotion, joints: int) -> TargetOrder:
    vectors = (motion.standby_joints, motion.thinning_joints, *motion.joints)
    if {len(vector) for vector in vectors} != {joints}:
        raise OrderRefused(f"target {motion.target_id}: rows need {joints} joints")
    if len(motion.times_s) != len(motion.joints):
        raise OrderRefused(f"target {motion.target_id}: rows and times differ in number")
    times, rows = np.array(motion.times_s), np.array(motion.joints)
    segments = []
    for part in motion.segments:
        inside = (times >= part.start_s) & (times <= part.end_s)
        if not inside.any():
            raise OrderRefused(f"target {motion.target_id}: {part.name} has no rows")
        segments.append(Segment(part.name, times[inside] - times[inside][0], rows[inside]))
    return TargetOrder(
        motion.target_id,
        np.array(motion.standby_joints),
        np.array(motion.thinning_joints),
        tuple(segments),
    )
