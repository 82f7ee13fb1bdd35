import math

import numpy as np
import pytest

from solver import Approach, Options, Problem, Robot, Target, solve
from solver.kinematics.forward import forward_kinematics
from tests.solver.problems import random_targets

# F. Ouyang, thesis, 2012, 4.2: the only target of data set 1 whose coordinates are printed. Its
# program and its text have different lengths of the last link; only the text's reaches it.
SEVENTH = Target("7", (0.23, 0.17, 0.315), (0, 1, 0))


def plan_one(robot: Robot, target: Target, tool: str = "scaffold", **options: object) -> Approach:
    chosen = Options(method="fixed_z", **options)  # type: ignore[arg-type]
    return solve(Problem(robot, [target], tool=tool, options=chosen)).approaches[0]


def test_seventh_target_of_data_set_1_needs_the_scaffold(tabletop: Robot) -> None:
    assert plan_one(tabletop, SEVENTH, "scaffold").status == "planned"
    assert plan_one(tabletop, SEVENTH, "laser").status == "infeasible"


def test_forks_point_along_world_x(tabletop: Robot) -> None:
    planned = 0
    for target in random_targets(seed=21, count=120):
        flat = Target(target.id, target.position_m, (0.0, *target.branch_direction[1:]))
        approach = plan_one(tabletop, flat, symmetric_tool=bool(int(target.id) % 2))
        if approach.status != "planned":
            assert approach.reason is not None
            assert approach.reason.code != "method_not_applicable"
            continue
        planned += 1
        tool = tabletop.tool("scaffold")
        assert tool is not None
        assert approach.thinning_joints is not None
        pose = forward_kinematics(tabletop, tool, approach.thinning_joints)
        assert pose[:3, 2] == pytest.approx([1, 0, 0], abs=1e-9)
    assert planned > 10


@pytest.mark.parametrize("lean_deg", [0.01, 5.0, 90.0])
def test_a_leaning_branch_is_not_for_this_method(tabletop: Robot, lean_deg: float) -> None:
    lean = math.radians(lean_deg)
    leaning = Target("7", SEVENTH.position_m, (math.sin(lean), math.cos(lean), 0.0))
    reason = plan_one(tabletop, leaning).reason
    assert reason is not None
    assert reason.code == "method_not_applicable"
    assert f"{lean_deg:.2f} degrees" in reason.detail


def test_the_cheapest_feasible_branch_wins(tabletop: Robot) -> None:
    approach = plan_one(tabletop, SEVENTH)
    same_angle = solve(
        Problem(
            tabletop,
            [SEVENTH],
            tool="scaffold",
            options=Options(method="floating_z", samples=720),
        )
    ).approaches[0]
    assert approach.effort is not None
    assert same_angle.effort is not None
    # floating_z may turn about the branch, so it is never dearer where it has this very angle.
    angle = approach.approach_angle_rad
    assert angle is not None
    assert same_angle.effort <= approach.effort + np.abs(angle)
