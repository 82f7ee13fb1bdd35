"""How straight cut-ins are and how near to limits: the verifier against the methods."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from solver import Options, Plan, Problem, Robot, load_robot, solve
from solver.approach.cut_in.cut_in import line_deviations, refined_rows, retreat_rows
from solver.kinematics.forward import many_poses
from solver.problem.retreats import even_retreats
from solver.problem.solution import PLANNED
from solver.verification.path_residuals import ClaimedPaths
from solver.verification.straightness import (
    as_executed,
    finer_rows,
    limit_margins,
    line_distances,
)
from tests.solver.kinematics.arms import arms, seven_joints, ur5
from tests.solver.problems import reachable_targets

ROBOTS = [*arms()[:4], load_robot("puma560_rail"), ur5(), seven_joints()]


@cache
def untimed(robot: Robot, rows: int, **options: object) -> Plan:
    closed_form = len(robot.joints) == 6 and robot.name != "ur5"
    chosen = Options(
        method="ssas" if closed_form else "ncos",
        order="independent",
        include=("path",),
        path_points=rows,
        **options,  # type: ignore[arg-type]
    )
    targets = reachable_targets(robot, 5, 24 if closed_form else 5)
    return solve(Problem(robot, targets, chosen))


def cut_ins(plan: Plan) -> tuple[ClaimedPaths, np.ndarray | None]:
    """The cut-ins of a plan as they are, and their branches."""
    done = [one for one in plan.approaches if one.status == PLANNED]
    assert len(done) >= 2
    paths = np.stack([np.asarray(one.path_joints) for one in done])
    poses = many_poses(plan.problem.robot, plan.problem.mounted_tool, paths[:, -1])
    branches = [one.branch for one in done]
    known = None if branches[0] is None else np.array(branches)
    return ClaimedPaths(paths, poses[:, :3, 3], poses[:, :3, :3]), known


@pytest.mark.parametrize(
    ("rows", "options"),
    [
        (2, {}),
        # Halved several times until it is straight, and from ends that are far apart.
        (20, {"straightness_m": 1e-6}),
        (2, {"standoff_m": 0.15}),
    ],
)
@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_rows_deviations_and_margins_are_those_of_the_methods(
    robot: Robot, rows: int, options: dict[str, float]
) -> None:
    plan = untimed(robot, rows, **options)
    claimed, branches = cut_ins(plan)
    problem = plan.problem
    tool, asked = problem.mounted_tool, problem.options
    count = 39
    finer = finer_rows(problem, claimed.paths, branches, count)
    deviations, margins = as_executed(problem, claimed, branches)
    for k, path in enumerate(claimed.paths):
        branch = None if branches is None else int(branches[k])
        known = retreat_rows(robot, tool, path[-1], branch, even_retreats(asked, count))
        assert finer[k] == pytest.approx(known, abs=1e-9)
        line = (claimed.places[k], claimed.axes[k, :, 2])
        known, deviation = refined_rows(robot, tool, asked, path, branch, line)
        assert deviations[k] == pytest.approx(deviation, abs=1e-10)
        margin = robot.limit_margin(np.concatenate((path, known))).min()
        assert margins[k] == pytest.approx(margin, abs=1e-9)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_any_motion_leaves_a_line_as_the_methods_say(robot: Robot) -> None:
    rng = np.random.default_rng(3)
    paths = rng.uniform(robot.lower, robot.upper, (20, 5, len(robot.joints)))
    points, directions = rng.normal(size=(2, 20, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    problem = untimed(robot, 2).problem
    found = line_distances(problem, paths, points, directions)
    known = line_deviations(robot, problem.mounted_tool, paths, points, directions)
    assert found == pytest.approx(known, rel=1e-12)


def test_the_nearest_limit_is_that_of_a_joint_that_turns() -> None:
    robot = load_robot("puma560_rail")
    middle = (robot.lower + robot.upper) / 2
    path = np.tile(middle, (1, 3, 1))
    path[0, 1, 0] = robot.upper[0] + 1.0  # the slide
    path[0, 2, 4] = robot.upper[4] - 0.125
    assert limit_margins(robot, path) == pytest.approx([0.125])
    path[0, 0, 2] = robot.lower[2] - 0.25
    assert limit_margins(robot, path) == pytest.approx([-0.25])


def test_what_cannot_be_followed_is_not_straight() -> None:
    """Cut-ins sent as straight from a metre behind: finer rows tell that they are not."""
    robot = ur5()
    plan = untimed(robot, 2)
    claimed, branches = cut_ins(plan)
    assert branches is None
    # The first would be straight from that far as well.
    claimed = ClaimedPaths(claimed.paths[1:3], claimed.places[1:3], claimed.axes[1:3])
    problem = replace(plan.problem, options=replace(plan.problem.options, standoff_m=1.0))
    deviations, _ = as_executed(problem, claimed, None)
    assert np.all(deviations > problem.options.straightness_m)
