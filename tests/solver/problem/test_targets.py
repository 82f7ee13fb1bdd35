"""Targets brought to the base."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from scipy.spatial.transform import Rotation

from solver import Options, Problem, Robot, Target, solve
from solver.problem.targets import targets_in_base
from solver.robots.model import Array
from tests.solver.frames.poses import faults, places, pose, rotations


@given(places, rotations())
def test_a_plan_in_any_frame_is_the_plan_in_base(
    tabletop: Robot, position: tuple[float, ...], rotation: Array
) -> None:
    there = pose(position, rotation)
    options = Options(method="ssas", include=("path",))
    in_base = [
        Target("1", (0.185, -0.057, 0.42), (-1, -1, 1)),
        Target("2", (0.2, 0.05, 0.38), (0, 3, 1), position_std_m=0.001),
        Target("3", (2.0, 0.0, 0.3), (0, 1, 0)),
    ]
    back = there.inverse
    sent = [
        Target(
            one.id,
            tuple(back.points(np.array([one.position_m]))[0].tolist()),
            tuple(back.directions(np.array([one.branch_direction], dtype=float))[0].tolist()),
            one.position_std_m,
        )
        for one in in_base
    ]
    found = targets_in_base(sent, there)
    assert [one.position_std_m for one in found] == [None, 0.001, None]
    plan = solve(Problem(tabletop, found, options=options))
    expected = solve(Problem(tabletop, in_base, options=options))
    assert [one.status for one in plan.approaches] == ["planned", "planned", "infeasible"]
    assert plan.total_effort == pytest.approx(expected.total_effort, abs=1e-6)
    for one, other in zip(plan.approaches, expected.approaches, strict=True):
        assert one.status == other.status
        if one.thinning_joints is not None:
            assert one.branch == other.branch
            assert one.thinning_joints == pytest.approx(other.thinning_joints, abs=1e-5)
        else:
            assert one.reason is not None
            assert other.reason is not None
            assert one.reason.code == other.reason.code


@pytest.mark.parametrize(
    ("position", "direction", "field"),
    [
        ((0.1, 0.2), (0, 1, 0), "position_m"),
        ((0.1, 0.2, math.nan), (0, 1, 0), "position_m"),
        ((1e308, 1e308, -1e308), (0, 1, 0), "position_m"),
        ((0.2, 0.1, 0.3), (0, 0, 0), "branch_direction"),
        ((0.2, 0.1, 0.3), (1.7e308, 1.7e308, 0), "branch_direction"),
        ((0.2, 0.1, 0.3), (0, 1), "branch_direction"),
    ],
)
def test_what_is_no_target_stays_for_the_problem_to_refuse(
    tabletop: Robot, position: Any, direction: Any, field: str
) -> None:
    there = pose((1, 2, 3), np.asarray(Rotation.from_rotvec([0.3, 0.2, 1]).as_matrix()))
    good = Target("1", (0.2, 0.1, 0.3), (0, 1, 0))
    found = targets_in_base([good, Target("2", position, direction)], there)
    assert found[0] != good
    told = faults(Problem, tabletop, found)
    assert set(told) == {f"#/targets/1/{field}"}
    assert targets_in_base([Target("2", position, direction)], there)[0].id == "2"
