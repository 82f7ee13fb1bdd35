import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hardware.arm.safety import check_goal, check_posture, check_rows, slack_rad
from hardware.exceptions import OutsideLimits, UnsafeGoal
from hardware.servos.joints import ArmMap, calibrated
from solver import Robot
from tests.hardware.parts import make_bench

BENCH = make_bench()
ROBOT, ARM = BENCH.robot, BENCH.map
STEP_S = 0.02
HOME = np.array(ROBOT.home_joints)

postures = st.tuples(
    *(
        st.floats(float(low), float(high))
        for low, high in zip(ROBOT.lower, ROBOT.upper, strict=True)
    )
).map(np.array)


@given(postures, st.tuples(*[st.floats(-1, 1)] * 6).map(np.array))
def test_steps_inside_the_limits_pass(last: np.ndarray, shares: np.ndarray) -> None:
    goal = np.clip(last + shares * ROBOT.velocity * STEP_S, ROBOT.lower, ROBOT.upper)
    check_goal(ROBOT, ARM, last, goal, STEP_S)


@given(postures, st.integers(0, 5), st.sampled_from([-1, 1]), st.floats(0.012, 3))
def test_goals_outside_the_limits_are_refused(
    posture: np.ndarray, joint: int, side: int, beyond: float
) -> None:
    goal = posture.copy()
    goal[joint] = (ROBOT.upper[joint] + beyond) if side > 0 else (ROBOT.lower[joint] - beyond)
    with pytest.raises(UnsafeGoal) as caught:
        check_goal(ROBOT, ARM, goal, goal, STEP_S)
    assert caught.value.joint == ROBOT.joint_names[joint]


@given(postures, st.integers(0, 5), st.floats(1.5, 100))
def test_steps_that_are_too_fast_are_refused(posture: np.ndarray, joint: int, times: float) -> None:
    last = posture.copy()
    last[joint] = posture[joint] + times * ROBOT.velocity[joint] * STEP_S
    with pytest.raises(UnsafeGoal, match="too fast"):
        check_goal(ROBOT, ARM, last, posture, STEP_S)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_goals_that_are_not_finite_are_refused(value: float) -> None:
    goal = HOME.copy()
    goal[3] = value
    with pytest.raises(UnsafeGoal, match="not finite"):
        check_goal(ROBOT, ARM, HOME, goal, STEP_S)


def test_a_calibration_that_moves_a_limit_out_of_the_servos_range_is_noticed() -> None:
    """Joint 4 uses its servo's whole range; one degree more cannot be reached at one end."""
    offsets = "".join(f"joint_{i} = {1.0 if i == 4 else 0.0}\n" for i in range(1, 7))
    arm = calibrated(ARM, f'robot = "tabletop"\n[offset_deg]\n{offsets}'.encode())
    for value, allowed in ((ROBOT.lower[3], True), (ROBOT.upper[3], False)):
        goal = HOME.copy()
        goal[3] = value
        assert passes(ROBOT, arm, goal) == allowed


def passes(robot: Robot, arm: ArmMap, goal: np.ndarray) -> bool:
    try:
        check_goal(robot, arm, goal, goal, STEP_S)
    except UnsafeGoal:
        return False
    return True


def test_postures_within_rounding_of_a_limit_may_be_left() -> None:
    slack = slack_rad(ARM)
    check_posture(ROBOT, ARM, ROBOT.upper + 0.9 * slack)
    check_posture(ROBOT, ARM, ROBOT.lower - 0.9 * slack)
    for joint in range(6):
        outside = HOME.copy()
        outside[joint] = ROBOT.upper[joint] + 1.5 * slack[joint]
        with pytest.raises(OutsideLimits) as caught:
            check_posture(ROBOT, ARM, outside)
        assert caught.value.joint == ROBOT.joint_names[joint]


@pytest.mark.parametrize("times", [[0.0, 0.0], [0.0, -1.0], [0.0, math.nan]])
def test_rows_whose_times_do_not_rise_are_refused(times: list[float]) -> None:
    with pytest.raises(UnsafeGoal, match="times"):
        check_rows(ROBOT, ARM, np.array(times), np.array([HOME, HOME]))


def test_one_row_is_a_motion_too() -> None:
    check_rows(ROBOT, ARM, np.zeros(1), HOME[None])
    with pytest.raises(UnsafeGoal):
        check_rows(ROBOT, ARM, np.zeros(1), HOME[None] + 3)
