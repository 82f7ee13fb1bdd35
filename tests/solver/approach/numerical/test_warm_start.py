"""Arms without a closed form: a numerical warm start, plans that verify, reasons that are true."""

from dataclasses import replace

import numpy as np
import pytest

from solver import (
    Approach,
    Options,
    Problem,
    Robot,
    Target,
    Tool,
    load_robot,
    solve,
    verify,
    verify_plan,
)
from solver.approach.numerical.warm_start import numerical_warm_starts, same_side
from solver.approach.optimum.on_arcs import best_on_arcs
from solver.approach.task.task import approach_task
from solver.kinematics.forward import forward_kinematics
from solver.kinematics.numerical import chain_of, polish, postures_behind
from solver.methods.registry import METHODS
from solver.problem.options import MethodName, Norm
from solver.problem.solution import Reason
from solver.robots.model import Array
from solver.solving.retiming import ChosenApproach, retime
from tests.solver.kinematics.arms import seven_joints, ur5
from tests.solver.problems import reachable_targets


@pytest.mark.parametrize("robot", [ur5(), seven_joints()], ids=lambda robot: robot.name)
@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_ncos_plans_what_is_known_to_be_reachable(robot: Robot, norm: Norm) -> None:
    targets = reachable_targets(robot, seed=71, count=12)
    plan = solve(Problem(robot, targets, options=Options(norm=norm, symmetric_tool=True)))
    assert plan.planned == len(targets)
    assert all(result.accepted for result in verify_plan(plan).values())
    assert all(approach.branch is None for approach in plan.approaches)
    # Where the warm start is the programme's optimum already, or its cut-in breaks, that is said.
    assert sum(approach.solver.status == "solved" for approach in plan.approaches) >= 4


def test_never_dearer_than_its_warm_start_and_the_same_again() -> None:
    robot = ur5()
    problem = Problem(robot, reachable_targets(robot, 72, 8), options=Options(order="independent"))
    first, second = solve(problem), solve(problem)
    for target, one, two in zip(problem.targets, first.approaches, second.approaches, strict=True):
        starts = numerical_warm_starts(approach_task(problem, target, problem.start), most=3)
        assert not isinstance(starts, Reason)
        assert list(starts) == sorted(starts, key=lambda start: start.effort)
        assert one.effort is not None
        assert one.effort <= starts[0].effort + 1e-9
        np.testing.assert_array_equal(one.thinning_joints, two.thinning_joints)


def test_never_cheaper_than_the_closed_form_and_seldom_much_dearer() -> None:
    """On an arm that has both, the global optimum is known."""
    robot = load_robot("puma560")
    targets = reachable_targets(robot, 73, 20)
    problem = Problem(robot, targets, options=Options(norm="l2", position_margin_m=0.0))
    ratios = []
    for target in targets:
        task = approach_task(problem, target, problem.start)
        starts, best = numerical_warm_starts(task, most=1), best_on_arcs(task)
        if best is None:
            assert isinstance(starts, Reason)
            continue
        assert not isinstance(starts, Reason)
        assert starts[0].effort >= best.effort * (1 - 1e-6)
        ratios.append(starts[0].effort / best.effort)
    assert len(ratios) >= 15
    assert np.median(ratios) < 1 + 1e-6


@pytest.mark.parametrize("name", [name for name in METHODS if name != "ncos"])
def test_closed_form_methods_say_that_they_do_not_apply(name: MethodName) -> None:
    robot = ur5()
    problem = Problem(robot, reachable_targets(robot, 74, 2), options=Options(method=name))
    for approach in solve(problem).approaches:
        assert approach.reason is not None
        assert approach.reason.code == "method_not_applicable"
        assert "ur5" in approach.reason.detail


def narrowed(robot: Robot, joint: int, lower: float, upper: float) -> Robot:
    joints = list(robot.joints)
    joints[joint] = replace(joints[joint], lower=lower, upper=upper)
    home = list(robot.home_joints)
    home[joint] = (lower + upper) / 2
    return replace(robot, joints=tuple(joints), home_joints=tuple(home))


def test_reasons_tell_reach_from_limits() -> None:
    robot = ur5()
    far = Problem(robot, [Target("far", (2.0, 0.0, 0.3), (0.0, 1.0, 0.0))])
    (unreachable,) = solve(far).approaches
    assert unreachable.reason is not None
    assert unreachable.reason.code == "out_of_reach"
    assert unreachable.reason.margin_m is not None
    assert unreachable.reason.margin_m < -0.9
    # Beside the arm, with a waist that turns a tenth of a radian only and a lift that hardly does.
    stiff = narrowed(narrowed(robot, 0, -0.05, 0.05), 1, -1.6, -1.4)
    beside = Problem(stiff, [Target("beside", (0.0, 0.5, 0.3), (1.0, 0.0, 0.0))])
    (limited,) = solve(beside).approaches
    assert limited.reason is not None
    assert limited.reason.code == "joint_limit"
    assert limited.reason.joint in stiff.joint_names
    assert limited.reason.margin_rad is not None
    assert limited.reason.margin_rad < 0


@pytest.fixture(scope="module")
def planned() -> tuple[Problem, Approach]:
    robot = ur5()
    problem = Problem(robot, reachable_targets(robot, 75, 1))
    (approach,) = solve(problem).approaches
    assert approach.status == "planned"
    return problem, approach


def test_a_claimed_branch_is_refused(planned: tuple[Problem, Approach]) -> None:
    problem, approach = planned
    found = verify(problem, replace(approach, branch=0), problem.start)
    assert [residual.name for residual in found.failures] == ["branch_exists"]


def test_rows_on_another_solution_are_refused(planned: tuple[Problem, Approach]) -> None:
    """The same poses, half of them with other joints: each row right, the whole not."""
    problem, approach = planned
    assert approach.path_joints is not None
    robot, tool = problem.robot, problem.mounted_tool
    rows = approach.path_joints.copy()
    other = next(
        posture
        for seed in range(20)
        if (posture := other_posture(robot, tool, rows[-1], seed)) is not None
    )
    assert same_side(robot, tool, rows)
    rows[10:] = postures_behind(robot, tool, other, np.linspace(0.04, 0.0, 20))[10:]
    broken = replace(approach, path_joints=rows, thinning_joints=rows[-1])
    names = {residual.name for residual in verify(problem, broken, problem.start).failures}
    assert "wrist_jump_rad_m" in names
    assert not names & {"path_position_m", "path_axes_rad"}


def other_posture(robot: Robot, tool: Tool, posture: Array, seed: int) -> Array | None:
    """Another posture of the same pose, if Newton's method comes to one from the seed's start."""
    pose = forward_kinematics(robot, tool, posture)
    q = np.random.default_rng(seed).uniform(robot.lower, robot.upper)
    place, axes = pose[:3, 3].copy(), np.ascontiguousarray(pose[:3, :3])
    left = polish(chain_of(robot, tool), place, axes, np.ones(len(q)), q)
    return q if left < 1e-9 and np.abs(q - posture).max() > 0.5 else None


def test_a_row_across_a_singularity_is_seen() -> None:
    """The UR5's wrist is singular with its fifth joint at zero: det J changes its sign there."""
    robot = ur5()
    rows = np.tile(robot.home_joints, (3, 1))
    rows[:, 4] = 0.02, 0.01, 0.005
    assert same_side(robot, robot.tools[0], rows)
    rows[:, 4] = 0.02, -0.01, 0.005
    assert not same_side(robot, robot.tools[0], rows)


def test_a_chosen_approach_is_retimed_without_a_branch(planned: tuple[Problem, Approach]) -> None:
    problem, approach = planned
    choice = ChosenApproach(
        **{name: getattr(approach, name) for name in ChosenApproach.__dataclass_fields__}
    )
    (again,) = retime(problem, [choice])
    assert again.status == "planned"
    np.testing.assert_allclose(again.thinning_joints, approach.thinning_joints, atol=1e-12)  # type: ignore[arg-type]
