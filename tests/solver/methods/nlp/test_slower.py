import numpy as np
import pytest

from solver import Options, Problem, Robot, Target
from solver.approach.task.task import approach_task
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.kinematics.straight_rates import posture_rates
from solver.methods.nlp.slower import ELBOW, WRIST, slower_limits
from solver.tolerances import JOINT_RATE_RAD_M

TARGET = Target("t", (0.2, 0.0, 0.4), (0, 1, 0))


@pytest.mark.parametrize("joint", [ELBOW, WRIST])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("beside", [1e-4, 0.005])
def test_at_the_new_limit_no_joint_is_too_fast(
    tabletop: Robot, joint: int, side: int, beside: float
) -> None:
    task = approach_task(Problem(tabletop, [TARGET], options=Options()), TARGET, (0.0,) * 6)
    geometry = wrist_geometry(tabletop, task.tool)
    straight = -geometry.offsets[joint] - (geometry.beta if joint == ELBOW else 0.0)
    posture = np.array([0.3, 0.7, -1.1, 0.4, 0.9, 0.2])
    posture[joint] = straight + side * beside
    limits, rates = np.array([[-3.0] * 6, [3.0] * 6]), np.empty(6)
    posture_rates(geometry, posture, rates)
    assert rates.max() > JOINT_RATE_RAD_M
    drawn = slower_limits(task, posture, limits)
    assert drawn is not None
    changed = np.argwhere(drawn != limits)
    assert changed.tolist() == [[0 if side == 1 else 1, joint]]
    bound = drawn[tuple(changed[0])]
    assert (bound - straight) * side > beside
    posture[joint] = bound
    posture_rates(geometry, posture, rates)
    assert 0.9 * JOINT_RATE_RAD_M < rates.max() <= JOINT_RATE_RAD_M


def test_a_posture_that_is_slow_enough_keeps_its_limits(tabletop: Robot) -> None:
    task = approach_task(Problem(tabletop, [TARGET], options=Options()), TARGET, (0.0,) * 6)
    posture = np.array([0.3, 0.7, -1.1, 0.4, 0.9, 0.2])
    assert slower_limits(task, posture, np.array([[-3.0] * 6, [3.0] * 6])) is None
