import math

import numpy as np
import pytest

from solver import BlossomBranch, select_blossoms
from solver.comparison.scenarios.kac_v import kac_v_branches, kac_v_problem


def from_vertical_deg(branch: BlossomBranch) -> float:
    step = np.subtract(branch.points_m[1], branch.points_m[0])
    return math.degrees(math.acos(step[2] / np.linalg.norm(step)))


def test_tree_is_that_of_the_thesis() -> None:
    """T 3.1.1, 3.1.3: 1 m, scaffolds at 30 and 40 degrees, 30 branches each, 90 to 10 degrees."""
    branches = kac_v_branches()
    for scaffold, lean_deg in (("1", -30.0), ("2", 40.0)):
        own = [branch for branch in branches if branch.id.startswith(f"{scaffold}-")]
        assert len(own) == 30
        steepness = [from_vertical_deg(branch) for branch in own]
        assert steepness[0] == pytest.approx(90.0)
        assert steepness[-1] == pytest.approx(10.0)
        assert steepness == sorted(steepness, reverse=True)
        origins = np.array([branch.points_m[0] for branch in own])
        rise = origins[-1] - origins[0]
        assert math.degrees(math.atan2(rise[0], rise[2])) == pytest.approx(lean_deg)
        assert origins[:, 2].max() < 1.0
        # The scaffold, continued downwards, meets the trunk 0.25 m in front of the base.
        fork = origins[0] - rise * (origins[0][2] - 0.2) / rise[2]
        assert fork == pytest.approx((0.25, 0.0, 0.2))


def test_targets_are_what_the_pattern_removes_within_twice_the_reach() -> None:
    problem = kac_v_problem()
    within = 2 * problem.robot.reach_m(problem.mounted_tool)
    removed = {one.id: one for one in select_blossoms(kac_v_branches()).targets}
    near = {one.id for one in removed.values() if math.hypot(*one.position_m) <= within}
    assert {target.id for target in problem.targets} == near
    assert 100 <= len(near) <= 400
    assert len(near) < len(removed)
