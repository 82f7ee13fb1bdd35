"""The last check before a goal goes to the servos. It refuses; it never bends a goal."""

import numpy as np
from numpy.typing import NDArray

from hardware.exceptions import OutsideLimits, UnsafeGoal
from hardware.servos.joints import ArmMap, JointDrive
from hardware.servos.units import ticks_per_radian
from hardware.tolerances import LIMIT_TICKS, SPEED_EXCESS
from solver import Array, Robot


def slack_rad(arm: ArmMap, ticks: int = LIMIT_TICKS) -> Array:
    """What `ticks` counts of each joint's servo are, shape (n,) [rad]."""
    return np.array([ticks / ticks_per_radian(drive.servo) for drive in arm.drives])


def check_posture(robot: Robot, arm: ArmMap, q: Array) -> None:
    """Refuse to move from where the arm stands when that is outside the joint limits.

    Raises:
        OutsideLimits: a joint is further outside than rounding and read noise explain.
    """
    outside = np.maximum(robot.lower - q, q - robot.upper) - slack_rad(arm)
    if (outside > 0).any():
        i = int(outside.argmax())
        detail = f"stands at {q[i]:.4f} rad, {outside[i]:.4f} rad outside its limits"
        raise OutsideLimits(robot.joint_names[i], detail)


def check_goal(robot: Robot, arm: ArmMap, last: Array, goal: Array, step_s: float) -> None:
    """Check a joint vector that is about to be commanded.

    Args:
        robot: joint and velocity limits.
        arm: its servos.
        last: what was commanded before, shape (n,) [rad].
        goal: what is to be commanded, shape (n,) [rad].
        step_s: time in which the joints are to get there [s].

    Raises:
        UnsafeGoal: not finite, outside the joint limits, outside the servo's range, or too fast.
    """
    _check_steps(robot, arm, last[None], goal[None], np.array([step_s]))


def check_rows(robot: Robot, arm: ArmMap, times_s: Array, rows: Array) -> None:
    """Check a whole timed motion before its first row is commanded.

    Args:
        robot: joint and velocity limits.
        arm: its servos.
        times_s: shape (n,) [s].
        rows: shape (n, joints) [rad].

    Raises:
        UnsafeGoal: times that do not rise, or a row or step that `check_goal` would refuse.
    """
    if not (np.isfinite(times_s).all() and (np.diff(times_s) > 0).all()):
        raise UnsafeGoal(robot.joint_names[0], "the times do not rise")
    steps = np.diff(times_s, prepend=times_s[0])
    _check_steps(robot, arm, np.concatenate((rows[:1], rows[:-1])), rows, steps)


def _check_steps(robot: Robot, arm: ArmMap, lasts: Array, goals: Array, steps: Array) -> None:
    finite = np.isfinite(goals).all(axis=0)
    if not finite.all():
        raise UnsafeGoal(robot.joint_names[finite.argmin()], "a goal is not finite")
    slack = slack_rad(arm)
    outside = np.maximum(robot.lower - goals, goals - robot.upper) > slack
    change = np.abs(goals - lasts)
    fast = change > steps[:, None] * robot.velocity * SPEED_EXCESS + slack
    for i, drive in enumerate(arm.drives):
        angles = goals[:, i]
        _refuse(drive, outside[:, i], angles, "goal of {:.4f} rad is outside its limits")
        _refuse(drive, fast[:, i], change[:, i], "a step of {:.4f} rad is too fast")
        ends = np.array([angles.argmin(), angles.argmax()])
        beyond = np.array([not drive.reaches(angles[k]) for k in ends])
        _refuse(drive, beyond, angles[ends], "goal of {:.4f} rad is outside its servo's range")


def _refuse(drive: JointDrive, broken: NDArray[np.bool_], values: Array, detail: str) -> None:
    if broken.any():
        raise UnsafeGoal(drive.joint, detail.format(values[broken.argmax()]))
