import numpy as np
import pytest

from solver.approach.task.candidate import Candidate
from solver.kinematics.families.on_rail import split_rail
from solver.kinematics.forward import forward_kinematics
from solver.methods.rail import at_rail, rail_effort, rail_positions
from solver.methods.semi_analytic import solve_ssas
from tests.solver.methods.on_rail import ROBOT, TARGETS, task_of


def test_a_fixed_rail_keeps_target_and_frame() -> None:
    task = task_of(TARGETS[0])
    rail = split_rail(task.robot)
    assert rail is not None
    there = at_rail(task, rail, 0.5)
    assert there.target == task.target
    np.testing.assert_array_equal(there.frame.outward, task.frame.outward)
    assert (len(there.reference), len(there.joint_weights), len(there.lower)) == (6, 6, 6)
    outcome = solve_ssas(there)
    assert isinstance(outcome, Candidate)
    posture = np.array([0.5, *outcome.thinning_joints])
    pose = forward_kinematics(ROBOT, ROBOT.tools[0], posture)
    np.testing.assert_allclose(pose[:3, 3], task.target.position_m, atol=1e-9)
    axes = task.frame.axes(outcome.approach_angle_rad, outcome.tool_side)
    np.testing.assert_allclose(pose[:3, :3], axes, atol=1e-9)


@pytest.mark.parametrize(("norm", "effort"), [("l1", 1.5), ("l2", 0.75)])
def test_the_slide_s_travel_costs_as_every_joint_s(norm: str, effort: float) -> None:
    """From 0.1 m where the reference stands, with a weight of three."""
    weights = (3.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    task = task_of(TARGETS[0], norm=norm, joint_weights=weights)
    assert rail_effort(task, 0.6) == pytest.approx(effort)
    assert rail_effort(task, -0.4) == pytest.approx(effort)
    assert rail_effort(task, 0.1) == 0.0


def test_positions_are_the_whole_slide_and_where_it_stands_the_nearest_first() -> None:
    task = task_of(TARGETS[0])
    positions = rail_positions(task)
    assert positions[0] == 0.1
    assert {task.lower[0], task.upper[0]} <= set(positions.tolist())
    assert np.all(np.diff(np.abs(positions - 0.1)) >= 0)
    apart = np.diff(np.sort(positions))
    assert apart.max() < 1.01 * (task.upper[0] - task.lower[0]) / (len(positions) - 2)


def test_no_position_is_tried_twice_for_rounding() -> None:
    """0.1 m is a place of the grid but for its last bit."""
    positions = np.sort(rail_positions(task_of(TARGETS[0])))
    assert np.diff(positions).min() > 1e-9
    assert 0.1 in positions
