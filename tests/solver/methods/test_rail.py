import numpy as np
import pytest

from solver import Options, Problem, Target, load_robot, solve, verify_plan
from solver.approach.cut_in.cut_in import retreat_rows
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask, approach_task
from solver.kinematics.families import rail_of, split_rail
from solver.kinematics.forward import forward_kinematics
from solver.methods.rail import at_rail, rail_effort, rail_positions
from solver.methods.registry import METHODS
from solver.methods.semi_analytic import solve_ssas
from solver.problem.solution import Reason
from tests.solver.kinematics.arms import ur5

ROBOT = load_robot("puma560_rail")
TARGETS = (
    Target("in front", (0.6, 0.1, 1.0), (0.0, 1.0, 0.2)),
    Target("only from the slide's end", (0.55, 1.25, 0.9), (1.0, 0.3, 0.0)),
    Target("nowhere", (3.0, 0.0, 0.9), (0.0, 0.0, 1.0)),
)


def task_of(target: Target, **options: object) -> ApproachTask:
    problem = Problem(ROBOT, TARGETS, options=Options(**options))  # type: ignore[arg-type]
    return approach_task(problem, target, (0.1, *ROBOT.home_joints[1:]))


def test_the_arm_at_a_position_is_the_robot_there() -> None:
    rail = split_rail(ROBOT)
    assert rail is not None
    assert rail.axis == pytest.approx((0.0, 1.0, 0.0), abs=1e-15)
    q = np.random.default_rng(31).uniform(ROBOT.lower, ROBOT.upper, (20, 7))
    for row in q:
        arm = rail.arm_at(float(row[0]))
        np.testing.assert_allclose(
            forward_kinematics(arm, arm.tools[0], row[1:]),
            forward_kinematics(ROBOT, ROBOT.tools[0], row),
            atol=1e-12,
        )
    assert split_rail(load_robot("puma560")) is None
    assert rail_of(ur5(), ur5().tools[0]) is None


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


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_the_best_over_the_grid_is_the_best_of_every_position(norm: str) -> None:
    """Skipping positions that travel alone makes too dear leaves none out that matters."""
    task = task_of(TARGETS[1], method="floating_z", norm=norm, samples=24)
    rail = rail_of(task.robot, task.tool)
    assert rail is not None
    outcome = METHODS["floating_z"].solve(task)
    assert isinstance(outcome, Candidate)
    positions = rail_positions(task)
    assert task.reference[0] in positions
    assert positions.min() == ROBOT.lower[0]
    assert positions.max() == ROBOT.upper[0]
    efforts = []
    for position in positions:
        alone = METHODS["floating_z"].solve(at_rail(task, rail, float(position)))
        if isinstance(alone, Candidate):
            efforts.append(alone.effort + rail_effort(task, float(position)))
    assert outcome.effort == pytest.approx(min(efforts), rel=1e-12)
    assert 3 <= len(efforts) < len(positions)


@pytest.mark.parametrize("weights", ["uniform", "torque"])
def test_plans_on_the_rail_verify(weights: str) -> None:
    options = Options(method="floating_z", weights=weights, samples=24)
    plan = solve(Problem(ROBOT, TARGETS, options=options))
    assert [approach.status for approach in plan.approaches] == ["planned", "planned", "infeasible"]
    assert all(result.accepted for result in verify_plan(plan).values())
    rows = plan.approaches[1].path_joints
    assert rows is not None
    assert np.ptp(rows[:, 0]) == 0.0
    assert rows[0, 0] > 0.3
    reason = plan.approaches[2].reason
    assert reason is not None
    assert reason.code == "out_of_reach"
    assert "every position of the rail" in reason.detail


def test_a_branch_on_the_rail_is_the_arms() -> None:
    task = task_of(TARGETS[0], method="floating_z", samples=24)
    outcome = METHODS["floating_z"].solve(task)
    assert not isinstance(outcome, Reason)
    retreats = np.linspace(0.04, 0.0, 5)
    rows = retreat_rows(ROBOT, task.tool, outcome.thinning_joints, outcome.branch, retreats)
    poses = forward_kinematics(ROBOT, task.tool, rows)
    line = poses[-1, :3, 3] - np.outer(retreats, poses[-1, :3, 2])
    np.testing.assert_allclose(poses[:, :3, 3], line, atol=1e-9)
