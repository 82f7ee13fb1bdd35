"""From postures to candidates, and what a candidate costs its batch."""

import numpy as np
import pytest

from solver.methods.candidates import at_angle, from_thinning
from tests.solver.methods.synthetic import small_task


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_a_posture_tells_its_angle_and_effort(side: int, norm: str) -> None:
    task = small_task(symmetric_tool=True, norm=norm, joint_weights=(1, 2, 3, 4, 5, 6))
    angle, branch = 0.2, 2 if side == 1 else 3
    joints = np.asarray(task.postures(angle, side, branch, np.zeros(1))[0])
    candidate = from_thinning(task, side, branch, joints)
    assert candidate.approach_angle_rad == pytest.approx(angle)
    assert candidate.thinning_joints == tuple(joints)
    change = np.abs(joints - task.reference)
    cost = np.arange(1, 7) @ (change if norm == "l1" else change**2)
    assert candidate.effort == pytest.approx(cost)
    assert (candidate.tool_side, candidate.branch) == (side, branch)
    assert (candidate.iterations, candidate.status, candidate.others) == (0, "", ())


def test_an_angle_is_told_within_half_a_turn() -> None:
    task = small_task()
    joints = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    candidate = at_angle(task, 4.0, 1, 2, joints)
    assert candidate.approach_angle_rad == pytest.approx(4.0 - 2 * np.pi)
    assert candidate.thinning_joints == joints
