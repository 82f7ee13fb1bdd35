"""How far is too far and how fast is too fast: to the count, joint by joint, row by row."""

import math
from dataclasses import replace

import numpy as np
import pytest

from hardware.arm.safety import check_goal, check_posture, check_rows, slack_rad
from hardware.exceptions import OutsideLimits, UnsafeGoal
from hardware.servos.joints import ArmMap, calibrated
from hardware.tolerances import SPEED_EXCESS
from tests.hardware.parts import make_bench

BENCH = make_bench()
ROBOT, ARM = BENCH.robot, BENCH.map
STEP_S = 0.02
MIDDLE = (ROBOT.lower + ROBOT.upper) / 2
COUNT_RAD = np.radians([300 / 1023, 250.92 / 4095, *[300 / 1023] * 4])
SLACK = 2 * COUNT_RAD
JOINTS = range(6)


def moved(joint: int, to: float) -> np.ndarray:
    posture = MIDDLE.copy()
    posture[joint] = to
    return posture


def shifted(joint: int, offset_deg: float) -> ArmMap:
    """The arm whose servo of one joint is mounted off by so much."""
    offsets = "".join(f"joint_{i + 1} = {offset_deg * (i == joint)}\n" for i in JOINTS)
    return calibrated(ARM, f'robot = "tabletop"\n[offset_deg]\n{offsets}'.encode())


def test_slack_is_counts_of_each_joints_servo() -> None:
    assert slack_rad(ARM) == pytest.approx(2 * COUNT_RAD)
    assert slack_rad(ARM, 1) == pytest.approx(COUNT_RAD)
    assert slack_rad(ARM, 5) == pytest.approx(5 * COUNT_RAD)


@pytest.mark.parametrize("joint", [1, 4])
@pytest.mark.parametrize("side", [-1, 1])
def test_goals_may_be_two_counts_outside(joint: int, side: int) -> None:
    """Of joints whose servos turn further than the joint."""
    limit = float((ROBOT.upper if side > 0 else ROBOT.lower)[joint])
    inside = moved(joint, limit + side * 0.99 * SLACK[joint])
    check_goal(ROBOT, ARM, inside, inside, STEP_S)
    outside = moved(joint, limit + side * 1.01 * SLACK[joint])
    with pytest.raises(UnsafeGoal, match=f"goal of {outside[joint]:.4f} rad is outside its limits"):
        check_goal(ROBOT, ARM, outside, outside, STEP_S)


@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("step_s", [0.02, 0.25])
def test_steps_may_be_a_twentieth_faster_than_the_joint_and_two_counts(
    joint: int, side: int, step_s: float
) -> None:
    most = ROBOT.velocity[joint] * step_s * 1.05
    for far, allowed in ((most + 0.99 * SLACK[joint], True), (most + 1.01 * SLACK[joint], False)):
        goal = moved(joint, float(MIDDLE[joint]) + side * far)
        if allowed:
            check_goal(ROBOT, ARM, MIDDLE, goal, step_s)
            continue
        with pytest.raises(UnsafeGoal, match=f"a step of {far:.4f} rad is too fast") as caught:
            check_goal(ROBOT, ARM, MIDDLE, goal, step_s)
        assert caught.value.joint == ROBOT.joint_names[joint]


@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_the_joint_whose_goal_is_no_number_is_named(joint: int, value: float) -> None:
    with pytest.raises(UnsafeGoal, match="not finite") as caught:
        check_goal(ROBOT, ARM, MIDDLE, moved(joint, value), STEP_S)
    assert caught.value.joint == ROBOT.joint_names[joint]


def test_the_first_of_several_joints_is_named() -> None:
    goal = MIDDLE.copy()
    goal[[4, 2]] += 3
    with pytest.raises(UnsafeGoal) as caught:
        check_goal(ROBOT, ARM, goal, goal, STEP_S)
    assert caught.value.joint == "joint_3"


@pytest.mark.parametrize(("offset_deg", "end"), [(1.0, "upper"), (-1.0, "lower")])
@pytest.mark.parametrize("joint", [3, 5])
def test_what_a_servo_does_not_reach_is_refused_at_its_end_alone(
    joint: int, offset_deg: float, end: str
) -> None:
    arm = shifted(joint, offset_deg)
    allowed, refused = ROBOT.lower, ROBOT.upper
    if end == "lower":
        allowed, refused = refused, allowed
    goal = moved(joint, float(allowed[joint]))
    check_goal(ROBOT, arm, goal, goal, STEP_S)
    goal = moved(joint, float(refused[joint]))
    with pytest.raises(UnsafeGoal, match=f"{goal[joint]:.4f} rad is outside its servo's range"):
        check_goal(ROBOT, arm, goal, goal, STEP_S)


def test_just_as_far_and_just_as_fast_as_allowed_is_allowed() -> None:
    joints = tuple(replace(joint, upper=0.0) for joint in ROBOT.joints)
    robot, zero = replace(ROBOT, joints=joints), np.zeros(6)
    check_posture(robot, ARM, slack_rad(ARM))
    inner = np.array([0, 1, 0, 0, 1, 0], bool)  # servos of the others end there
    check_goal(robot, ARM, slack_rad(ARM) * inner, slack_rad(ARM) * inner, STEP_S)
    check_goal(ROBOT, ARM, zero, STEP_S * ROBOT.velocity * SPEED_EXCESS + slack_rad(ARM), STEP_S)


# --- Rows -----------------------------------------------------------------------------------------
def motion(joint: int, *angles: float) -> np.ndarray:
    return np.array([moved(joint, float(MIDDLE[joint]) + angle) for angle in angles])


def test_a_motion_as_fast_as_its_joints_passes() -> None:
    for joint in JOINTS:
        fast = float(ROBOT.velocity[joint])
        times = np.array([0.0, 0.1, 0.15, 0.4])
        rows = motion(joint, 0.0, 0.1 * fast, 0.05 * fast, 0.3 * fast)
        check_rows(ROBOT, ARM, times, rows)
        # Times only count from row to row.
        check_rows(ROBOT, ARM, times + 7.0, rows)


@pytest.mark.parametrize("row", [1, 2, 3])
def test_each_row_is_a_step_from_the_one_before_in_its_own_time(row: int) -> None:
    fast = float(ROBOT.velocity[3])
    times = np.array([0.0, 0.1, 0.3, 0.5])
    angles = np.array([0.0, 0.1, 0.3, 0.5]) * fast
    check_rows(ROBOT, ARM, times, motion(3, *angles))
    angles[row:] += 0.05
    step = angles[row] - angles[row - 1]
    with pytest.raises(UnsafeGoal, match=f"a step of {step:.4f} rad is too fast"):
        check_rows(ROBOT, ARM, times, motion(3, *angles))
    times[row:] += 0.1
    check_rows(ROBOT, ARM, times, motion(3, *angles))


@pytest.mark.parametrize("row", range(4))
def test_one_row_outside_is_enough_and_its_angle_is_told(row: int) -> None:
    rows = motion(4, 0.0, 0.1, 0.0, 0.1)
    rows[row, 4] = ROBOT.upper[4] + 0.02
    with pytest.raises(UnsafeGoal, match=f"joint_5: goal of {rows[row, 4]:.4f} rad"):
        check_rows(ROBOT, ARM, np.arange(4.0), rows)
    rows[row, 4] = math.nan
    with pytest.raises(UnsafeGoal, match="joint_5: a goal is not finite"):
        check_rows(ROBOT, ARM, np.arange(4.0), rows)


@pytest.mark.parametrize(
    "times",
    [
        [0.0, 1.0, 1.0],
        [0.0, 0.0, 1.0],
        [0.0, 2.0, 1.0],
        [0.0, math.nan, 2.0],
        [math.nan, 1.0, 2.0],
        [-math.inf, 1.0, 2.0],
        [0.0, 1.0, math.inf],
    ],
)
def test_times_have_to_rise_from_row_to_row(times: list[float]) -> None:
    rows = np.tile(MIDDLE, (3, 1))
    check_rows(ROBOT, ARM, np.array([0.0, 1.0, 2.0]), rows)
    with pytest.raises(UnsafeGoal, match="the times do not rise") as caught:
        check_rows(ROBOT, ARM, np.array(times), rows)
    # They are of no joint more than of another.
    assert caught.value.joint == "joint_1"


# --- Where the arm stands -------------------------------------------------------------------------
@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("side", [-1, 1])
def test_an_arm_may_stand_two_counts_outside(joint: int, side: int) -> None:
    limit = float((ROBOT.upper if side > 0 else ROBOT.lower)[joint])
    check_posture(ROBOT, ARM, moved(joint, limit + side * 0.99 * SLACK[joint]))
    q = moved(joint, limit + side * (SLACK[joint] + 0.0021))
    said = f"{ROBOT.joint_names[joint]}: stands at {q[joint]:.4f} rad, 0.0021 rad outside"
    with pytest.raises(OutsideLimits, match=said):
        check_posture(ROBOT, ARM, q)


def test_the_joint_furthest_outside_is_named() -> None:
    q = MIDDLE.copy()
    q[1], q[2], q[5] = ROBOT.upper[1] + 0.1, ROBOT.lower[2] - 0.3, ROBOT.upper[5] + 0.2
    with pytest.raises(OutsideLimits) as caught:
        check_posture(ROBOT, ARM, q)
    assert caught.value.joint == "joint_3"
