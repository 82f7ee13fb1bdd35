"""Steps towards a family of poses, by damped least squares in NumPy."""

import math

import numpy as np
import pytest

from solver import Options, Problem, Robot
from solver.approach.numerical import sweep
from solver.approach.numerical.multi_start import (
    PoseFamily,
    arrive,
    from_starts,
    nearest_turn,
    step_towards,
)
from solver.approach.numerical.sweep import apart, arrivals_at, from_all_starts, pose_family
from solver.approach.task.task import ApproachTask, approach_task
from solver.kinematics.forward import forward_kinematics, jacobian
from solver.kinematics.numerical import chain_of
from solver.problem.effort import posture_effort
from tests.solver.kinematics.arms import seven_joints, ur5
from tests.solver.problems import reachable_targets

ROBOTS = [ur5(), seven_joints()]
DAMPING = 1e-10


def task_of(robot: Robot, symmetric: bool = False) -> ApproachTask:
    targets = reachable_targets(robot, seed=5, count=1)
    problem = Problem(robot, targets, options=Options(symmetric_tool=symmetric, include=("path",)))
    return approach_task(problem, targets[0], problem.start)


def known(robot: Robot, k: int) -> tuple[ApproachTask, np.ndarray, float]:
    """The task of a target that a posture of its own is known for, and that one's angle."""
    targets = reachable_targets(robot, seed=5, count=k + 1)
    problem = Problem(robot, targets, options=Options(include=("path",)))
    task = approach_task(problem, targets[k], problem.start)
    drawn = np.random.default_rng(5).uniform(
        0.9 * robot.lower, 0.9 * robot.upper, (k + 1, len(robot.joints))
    )
    z = forward_kinematics(robot, task.tool, drawn[k])[:3, 2]
    return task, drawn[k], math.atan2(z @ task.frame.sideways, z @ task.frame.outward)


def family_of(task: ApproachTask, side: int = 1) -> PoseFamily:
    return pose_family(task, side, task.lower.copy(), task.upper.copy())


def rotation_left(turn: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """The rotation vector from one frame to another."""
    between = wanted @ turn.T
    axis = np.array([between[2, 1] - between[1, 2], between[0, 2] - between[2, 0],
                     between[1, 0] - between[0, 1]]) / 2  # fmt: skip
    sine = float(np.linalg.norm(axis))
    return axis * math.atan2(sine, (np.trace(between) - 1) / 2) / max(sine, 1e-300)


def plain_step(task: ApproachTask, q: np.ndarray, angle: float, share: float) -> np.ndarray:
    """The step of all joints and of the angle, none of which is at a limit."""
    pose = forward_kinematics(task.robot, task.tool, q)
    error = np.concatenate(
        (np.asarray(task.target.position_m) - pose[:3, 3],
         rotation_left(pose[:3, :3], task.frame.axes(angle, 1)))
    )  # fmt: skip
    columns = np.column_stack(
        (jacobian(task.robot, task.tool, q[None])[0], [0, 0, 0, *-task.frame.branch])
    )
    lean = share * np.append(np.asarray(task.reference) - q, 0.0)
    gram = columns @ columns.T + (0.5 * float(error @ error) + DAMPING) * np.eye(6)
    step = lean + columns.T @ np.linalg.solve(gram, error - columns @ lean)
    return np.asarray(step * 0.5 / max(0.5, np.abs(step).max()))


def stepped(
    task: ApproachTask, family: PoseFamily, q: np.ndarray, angle: float, share: float
) -> tuple[np.ndarray, float]:
    n, moved = len(q), q.copy()
    axes = np.ascontiguousarray(task.frame.axes(angle, 1))
    turned = step_towards(
        chain_of(task.robot, task.tool), family, axes, share, moved, np.empty((6, n + 1)),
        np.empty((n + 1, 4, 4)),
    )  # fmt: skip
    return moved, float(turned)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
@pytest.mark.parametrize("share", [0.0, 0.3])
@pytest.mark.parametrize("seed", range(3))
def test_a_step_is_damped_least_squares_with_the_angle_free(
    robot: Robot, share: float, seed: int
) -> None:
    """And no joint or angle turns further than half a radian."""
    task = task_of(robot)
    n = len(robot.joints)
    wide = family_of(task)._replace(lower=np.full(n, -50.0), upper=np.full(n, 50.0))
    rng = np.random.default_rng(seed)
    q = rng.uniform(-1.5, 1.5, n) * (0.3 if seed == 2 else 1.0)
    angle = float(rng.uniform(-3, 3))
    moved, turned = stepped(task, wide, q, angle, share)
    expected = plain_step(task, q, angle, share)
    assert moved - q == pytest.approx(expected[:n], abs=1e-7)
    assert turned == pytest.approx(expected[n], abs=1e-7)
    assert max(np.abs(moved - q).max(), abs(turned)) <= 0.5 + 1e-12


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_joints_at_their_limits_stay_and_the_others_do_their_part(robot: Robot) -> None:
    task = task_of(robot)
    n, rng = len(robot.joints), np.random.default_rng(4)
    q = rng.uniform(-1.0, 1.0, n)
    free, _ = stepped(task, family_of(task), q, 0.3, 0.0)
    for i in range(n):
        ahead = free[i] - q[i]
        lower, upper = np.full(n, -50.0), np.full(n, 50.0)
        (upper if ahead > 0 else lower)[i] = q[i]
        family = family_of(task)._replace(lower=lower, upper=upper)
        moved, _ = stepped(task, family, q, 0.3, 0.2)
        assert lower[i] <= moved[i] <= upper[i]
        assert np.abs(moved - q).max() > 0.0
        # Just before its limit it goes as far as that.
        (upper if ahead > 0 else lower)[i] = q[i] + 0.01 * ahead
        moved, _ = stepped(task, family, q, 0.3, 0.0)
        assert moved[i] == pytest.approx(q[i] + 0.01 * ahead)


def test_turns_next_to_the_reference() -> None:
    robot = ROBOTS[0]
    task, turn = task_of(robot), 2 * math.pi
    chain = chain_of(robot, task.tool)
    family = family_of(task)._replace(
        lower=np.full(6, -8.0), upper=np.full(6, 8.0), reference=np.array([4, -4, 0, 7, 7, 30.0])
    )
    q = np.array([-1.0, 1.0, 6.0, 1.0, 2.5, 3.0])
    nearest_turn(chain, family, q)
    assert q == pytest.approx([turn - 1, 1 - turn, 6 - turn, 1 + turn, 2.5, 3.0])
    sliding = chain._replace(turning=np.array([0.0, 1, 1, 1, 1, 1]))
    other = np.array([-1.0, 1.0, 6.0, 1.0, 2.5, 3.0])
    nearest_turn(sliding, family, other)
    assert other[0] == -1.0


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_a_posture_that_is_nearly_there_arrives_and_another_stays(robot: Robot) -> None:
    task, posture, angle = known(robot, 0)
    chain, family = chain_of(robot, task.tool), family_of(task)
    q = posture + 1e-5
    assert arrive(chain, family, angle, q) < 1e-9
    pose = forward_kinematics(robot, task.tool, q)
    assert pose[:3, 3] == pytest.approx(task.target.position_m, abs=1e-9)
    far = posture + 0.1
    q = far.copy()
    left = arrive(chain, family, angle, q)
    assert left >= 1e-3
    assert np.array_equal(q, far)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_starts_arrive_and_lean_towards_the_reference(robot: Robot) -> None:
    task = task_of(robot)
    chain, family = chain_of(robot, task.tool), family_of(task)
    rng, count, n = np.random.default_rng(6), 4, len(robot.joints)
    starts = rng.uniform(task.lower, task.upper, (count, n)) * 0.5
    angles, postures = np.tile(rng.uniform(-1, 1, count), 2), np.full((8, n), np.nan)
    errors = np.full(8, np.nan)
    from_starts(chain, family, starts, angles, postures, errors)
    reached = np.flatnonzero(errors < 1e-9)
    assert len(reached) >= 3
    for k in reached:
        pose = forward_kinematics(robot, task.tool, postures[k])
        axes = task.frame.axes(float(angles[k]), 1)
        assert pose[:3, :3] == pytest.approx(axes, abs=1e-8)
    travel = [np.abs(postures[k] - task.reference).sum() for k in range(8)]
    both = [k for k in range(4) if errors[k] < 1e-9 and errors[k + 4] < 1e-9]
    assert both
    assert np.mean([travel[k + 4] for k in both]) < np.mean([travel[k] for k in both]) + 1e-9


def test_arrivals_are_inside_and_sorted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweep, "NUMERICAL_STARTS", 4)
    task = task_of(ROBOTS[0], symmetric=True)
    found = from_all_starts(task, task.lower, task.upper)
    assert [one.side for one in found] == [1, -1]
    assert all(one.postures.shape == (8, 6) for one in found)
    arrivals = arrivals_at(task)
    efforts = [
        posture_effort(one.posture, task.reference, task.joint_weights, task.options.norm)
        for one in arrivals
    ]
    assert efforts == sorted(efforts)
    for one in arrivals:
        assert task.inside(one.posture).min() >= -1e-6
        pose = forward_kinematics(task.robot, task.tool, one.posture)
        axes = task.frame.axes(one.angle_rad, one.tool_side)
        assert pose[:3, :3] == pytest.approx(axes, abs=1e-6)


def test_postures_are_apart_where_some_joint_is() -> None:
    q = np.zeros(3)
    assert apart(q, [], 0.1)
    assert apart(q, [np.array([0.0, 0.2, 0.0])], 0.1)
    assert not apart(q, [np.array([0.1, -0.1, 0.0])], 0.1)
    assert not apart(q, [np.array([0.0, 0.2, 0.0]), np.array([0.05, 0.0, 0.0])], 0.1)
