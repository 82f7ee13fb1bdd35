from dataclasses import replace

import numpy as np
import pytest

from solver import Options, Problem, Robot, load_robot, solve
from solver.approach.task.task import approach_task
from solver.tolerances import JOINT_RATE_RAD_M
from solver.verification.joint_rates import fastest_rates
from solver.verification.verify import verify
from tests.solver.solving.test_solve_rows import SWINGS, at_edges, fastest


@pytest.mark.parametrize("rows", [2, 20, 200])
def test_the_fastest_rate_is_found_whatever_rows_are_sent(tabletop: Robot, rows: int) -> None:
    options = Options(method="ssas", order="independent", include=("path",), path_points=rows)
    plan = solve(Problem(tabletop, [*at_edges(tabletop, 20, 40), SWINGS], options=options))
    done = [one for one in plan.approaches if one.status == "planned"]
    paths = np.stack([np.asarray(one.path_joints) for one in done])
    found = fastest_rates(plan.problem, paths)
    for one, rate in zip(done, found, strict=True):
        truth = fastest(tabletop, one)
        # Below a quarter of the limit it is told roughly.
        assert rate == pytest.approx(truth, rel=1e-3) or max(rate, truth) < JOINT_RATE_RAD_M / 2


def test_a_cut_in_that_is_too_fast_between_its_rows_is_refused(tabletop: Robot) -> None:
    """Nearer to the straight wrist than the answer: its two rows are what they have to be."""
    options = Options(method="ssas", order="independent", include=("path",), path_points=2)
    problem = Problem(tabletop, [SWINGS], options=options)
    (approach,) = solve(problem).approaches
    assert verify(problem, approach, problem.start).accepted
    refused, task = 0, approach_task(problem, SWINGS, problem.start)
    for turn in np.linspace(-0.01, 0.01, 41):
        angle = (approach.approach_angle_rad or 0.0) + turn
        rows = task.postures(
            angle, approach.tool_side or 1, approach.branch or 0, np.array([0.04, 0])
        )
        claim = replace(
            approach, approach_angle_rad=angle, path_joints=rows, standby_joints=rows[0],
            thinning_joints=rows[-1],
        )  # fmt: skip
        names = {residual.name for residual in verify(problem, claim, problem.start).failures}
        refused += "wrist_jump_rad_m" in names
    assert 0 < refused < 41


def test_what_slides_has_no_rate() -> None:
    robot = load_robot("puma560_rail")
    problem = Problem(robot, [SWINGS], options=Options(include=("path",)))
    rows = np.tile(np.asarray(robot.home_joints), (1, 20, 1))
    rows[..., 0] = np.linspace(-10.0, 10.0, 20)
    assert fastest_rates(problem, rows)[0] < JOINT_RATE_RAD_M
