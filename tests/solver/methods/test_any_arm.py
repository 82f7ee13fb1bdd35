import numpy as np
import pytest

from solver import Options, Problem, solve, verify_plan
from solver.approach.cut_in.cut_in import retreat_rows
from solver.approach.task.candidate import Candidate
from solver.kinematics.families.on_rail import split_rail
from solver.kinematics.forward import forward_kinematics
from solver.methods.rail import at_rail, rail_effort, rail_positions
from solver.methods.registry import METHODS
from solver.problem.options import Weights
from solver.problem.solution import Reason
from tests.solver.methods.on_rail import ROBOT, TARGETS, task_of


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_the_best_over_the_grid_is_the_best_of_every_position(norm: str) -> None:
    """Skipping positions that travel alone makes too dear leaves none out that matters."""
    task = task_of(TARGETS[1], method="floating_z", norm=norm, samples=24)
    rail = split_rail(task.robot)
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
def test_plans_on_the_rail_verify(weights: Weights) -> None:
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
