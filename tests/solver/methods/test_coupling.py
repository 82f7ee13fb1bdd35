"""What an approach costs a batch: itself, and the way from its standby to the next."""

import numpy as np
import pytest

from solver.methods.candidates import at_angle
from solver.methods.coupling import Coupling
from tests.solver.methods.synthetic import small_task

FOLLOWING = (0.4, 0.9, -1.0, 0.3, 1.2, -0.2)
WEIGHTS = (1, 2, 3, 4, 5, 6)


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_the_way_onwards_begins_at_standby(norm: str) -> None:
    task = small_task(norm=norm, joint_weights=WEIGHTS)
    joints = task.thinning_joints(0.1, 1, 2)
    candidate = at_angle(task, 0.1, 1, 2, joints)
    standby = task.postures(0.1, 1, 2, np.array([task.options.standoff_m, 0.0]))[0]
    change = np.abs(standby - FOLLOWING)
    onwards = float(np.array(WEIGHTS) @ (change if norm == "l1" else change**2))
    coupling = Coupling(task, FOLLOWING)
    assert coupling.onwards(standby) == pytest.approx(onwards)
    assert coupling.cost(candidate) == pytest.approx(candidate.effort + onwards)


def test_without_a_next_target_the_effort_is_all() -> None:
    task = small_task()
    candidate = at_angle(task, 0.1, 1, 2, task.thinning_joints(0.1, 1, 2))
    alone = Coupling(task, None)
    assert alone.onwards(np.ones(6)) == 0.0
    assert alone.cost(candidate) == candidate.effort
