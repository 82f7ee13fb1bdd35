"""What is packed comes out again, field by field."""

import numpy as np
import pytest

from solver import Options, Problem, Robot, load_robot
from solver.approach.task.packed import (
    COLUMNS,
    LAYOUT,
    LOWER,
    NUMBERS,
    REFERENCE,
    SQUARED,
    UPPER,
    WEIGHTS,
    unpack_circle,
    unpack_geometry,
)
from solver.approach.task.packing import packed_targets
from solver.approach.task.task import ApproachTask, approach_task
from solver.kinematics.spherical_wrist import wrist_geometry
from solver.problem.options import NORMS, Norm
from tests.solver.problems import random_targets


def test_columns_lie_side_by_side() -> None:
    first = 0
    for name, width in LAYOUT:
        assert COLUMNS[name] == first
        first += width
    assert first == NUMBERS
    assert len(COLUMNS) == len(LAYOUT), "two fields have one name"


@pytest.mark.parametrize("robot", [load_robot("tabletop"), load_robot("puma560")], ids=str)
@pytest.mark.parametrize("norm", NORMS)
def test_every_field_comes_out_again(robot: Robot, norm: Norm) -> None:
    rng = np.random.default_rng(3)
    options = Options(norm=norm, symmetric_tool=True, joint_weights=rng.uniform(0, 9, 6).tolist())
    targets, start = random_targets(4, 12), rng.uniform(robot.lower, robot.upper)
    problem = Problem(robot, targets, start_joints=start.tolist(), options=options)
    for target in problem.targets:
        task = approach_task(problem, target, problem.start)
        for side in task.tool_sides:
            _check(task, side, problem)


def _check(task: ApproachTask, side: int, problem: Problem) -> None:
    numbers, kernels = task.packed(side).numbers, task.for_kernels(side)
    assert unpack_geometry(numbers) == wrist_geometry(problem.robot, problem.mounted_tool)
    circle = unpack_circle(numbers)
    np.testing.assert_array_equal(circle.position, kernels.position)
    np.testing.assert_array_equal(circle.y, kernels.y_axis)
    np.testing.assert_array_equal(circle.outward, kernels.outward)
    np.testing.assert_array_equal(circle.sideways, kernels.sideways)
    np.testing.assert_allclose(
        circle.x_outward, np.cross(kernels.y_axis, kernels.outward), atol=1e-15
    )
    np.testing.assert_allclose(
        circle.x_sideways, np.cross(kernels.y_axis, kernels.sideways), atol=1e-15
    )
    fields = {LOWER: task.lower, UPPER: task.upper, REFERENCE: task.reference}
    for first, expected in {**fields, WEIGHTS: task.joint_weights}.items():
        np.testing.assert_array_equal(numbers[first : first + 6], expected)
    assert numbers[SQUARED] == task.options.squared


def test_one_target_is_packed_as_many_are(tabletop: Robot) -> None:
    problem = Problem(tabletop, random_targets(5, 6), options=Options(symmetric_tool=True))
    positions = np.array([target.position_m for target in problem.targets])
    directions = np.array([target.branch_direction for target in problem.targets])
    packed = packed_targets(problem, positions, directions, np.asarray(problem.start))
    for k, target in enumerate(problem.targets):
        task = approach_task(problem, target, problem.start)
        for place, side in enumerate(task.tool_sides):
            np.testing.assert_allclose(packed[place, k], task.packed(side).numbers, atol=1e-14)
