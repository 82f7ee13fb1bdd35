"""What is planned does not depend on the rows of the cut-in that are sent."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from solver import Approach, Options, Problem, Robot, Target, load_robot, solve
from solver.comparison.targets import as_targets, drawn_at_edges
from solver.kinematics.forward import forward_kinematics, jacobian
from solver.kinematics.numerical import postures_behind
from solver.problem.options import MethodName
from solver.tolerances import JOINT_RATE_RAD_M
from tests.solver.problems import random_targets

COUNTS = (2, 5, 20, 50, 200)
SWINGS = Target(
    "swings",
    (0.17489189684745035, -0.14243073192940853, 0.42163966855962365),
    (0.0007328471082526046, 0.18834275492242214, 0.12660024674912648),
)
"""Beside a straight wrist: with two rows its cut-in took 70 s, with five 179, with twenty 0.96."""


def at_edges(robot: Robot, seed: int, count: int) -> list[Target]:
    drawn = drawn_at_edges(robot, robot.tools[0], 0.005, seed, count)
    return list(as_targets(*drawn, range(count)))


def planned_with(problem: Problem, rows: int) -> Sequence[Approach]:
    options = {**vars(problem.options), "path_points": rows}
    return solve(Problem(problem.robot, problem.targets, options=Options(**options))).approaches


def fastest(robot: Robot, approach: Approach) -> float:
    """The fastest joint on a cut-in of 2,001 postures that Newton's method follows [rad/m]."""
    tool = robot.tools[0]
    thinning = np.asarray(approach.thinning_joints)
    rows = postures_behind(robot, tool, thinning, np.linspace(0.04, 0.0, 2001))
    along = np.concatenate((forward_kinematics(robot, tool, thinning)[:3, 2], np.zeros(3)))
    return float(np.abs(np.linalg.solve(jacobian(robot, tool, rows), along[:, None])).max())


@pytest.mark.parametrize("made", [lambda robot, seed, n: random_targets(seed, n), at_edges])
@pytest.mark.parametrize("name", ["tabletop", "puma560"])
def test_answers_are_the_same_whatever_rows_are_sent(
    name: MethodName, made: Callable[[Robot, int, int], list[Target]]
) -> None:
    robot = load_robot(name)
    options = Options(method="ssas", order="independent", include=("path",))
    problem = Problem(robot, [*made(robot, 17, 120), SWINGS], options=options)
    first, *others = (planned_with(problem, rows) for rows in COUNTS)
    assert sum(approach.status == "planned" for approach in first) > 30
    for other in others:
        for one, two in zip(first, other, strict=True):
            assert one.status == two.status
            assert (one.reason and one.reason.code) == (two.reason and two.reason.code)
            assert one.effort == two.effort
            assert one.displacement_margin_m == two.displacement_margin_m


def test_durations_and_bounds_are_the_same_whatever_rows_are_sent(tabletop: Robot) -> None:
    options = Options(method="ssas", order="independent", certify=True)
    problem = Problem(tabletop, [*random_targets(18, 25), SWINGS], options=options)
    first, *others = (planned_with(problem, rows) for rows in COUNTS)
    for other in others:
        for one, two in zip(first, other, strict=True):
            assert one.lower_bound == two.lower_bound
            if one.trajectory is None or two.trajectory is None:
                assert one.trajectory is two.trajectory is None
                continue
            ends = [approach.trajectory.segments[-1].end_s for approach in (one, two)]  # type: ignore[union-attr]
            assert ends[0] == pytest.approx(ends[1], rel=1e-9)


@pytest.mark.parametrize("method", ["ssas", "as", "floating_z", "ncos"])
@pytest.mark.parametrize("name", ["tabletop", "puma560"])
def test_no_joint_is_too_fast_anywhere(name: str, method: MethodName) -> None:
    robot = load_robot(name)
    options = Options(method=method, order="independent", include=("path",), path_points=2)
    plan = solve(Problem(robot, [*at_edges(robot, 19, 60), SWINGS], options=options))
    done = [approach for approach in plan.approaches if approach.status == "planned"]
    assert len(done) > 15
    codes = {approach.reason.code for approach in plan.approaches if approach.reason}
    assert "solver_failed" not in codes
    rates = [fastest(robot, approach) for approach in done]
    assert max(rates) <= JOINT_RATE_RAD_M * (1 + 1e-6)
    if method in ("ssas", "ncos") and name == "tabletop":
        # The least effort stands at the edge: some go as fast as they may.
        assert max(rates) > 0.99 * JOINT_RATE_RAD_M


def test_a_cut_in_beside_a_straight_wrist_takes_a_second(tabletop: Robot) -> None:
    options = Options(method="ssas", order="independent", position_margin_m=0.0)
    for rows in COUNTS:
        (approach,) = planned_with(Problem(tabletop, [SWINGS], options=options), rows)
        assert approach.trajectory is not None
        (cut_in,) = (part for part in approach.trajectory.segments if part.name == "cut_in")
        assert cut_in.end_s - cut_in.start_s < 1.5
