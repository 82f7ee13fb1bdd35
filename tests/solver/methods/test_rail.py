import numpy as np

from solver.approach.task.candidate import Candidate
from solver.kinematics.families import rail_of
from solver.kinematics.forward import forward_kinematics
from solver.methods.rail import at_rail
from solver.methods.semi_analytic import solve_ssas
from tests.solver.methods.on_rail import ROBOT, TARGETS, task_of


def test_a_fixed_rail_keeps_target_and_frame() -> None:
    task = task_of(TARGETS[0])
    rail = rail_of(task.robot, task.tool)
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
