"""Residuals of cut-ins, each against a loop over joints and rows."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solver import Problem, Robot, solve
from solver.kinematics.forward import forward_kinematics
from solver.problem.options import Norm
from solver.tolerances import (
    AXIS_ERROR_RAD,
    EFFORT_ERROR_RELATIVE,
    JOINT_RATE_RAD_M,
    LIMIT_EXCESS_RAD,
    POSITION_ERROR_M,
    SAME_BRANCH_RAD,
    SAME_POSTURE_RAD,
)
from solver.verification.displacement import displacement_overshoots
from solver.verification.path_residuals import (
    ClaimedPaths,
    Residuals,
    branch_residuals,
    deviation_residuals,
    displacement_residuals,
    effort_residuals,
    efforts_between,
    margin_residuals,
    path_residuals,
    retreats_of,
)
from solver.verification.tolerances import DISPLACED_ERROR_M
from tests.solver.problems import data_set_3

Case = tuple[Problem, ClaimedPaths, np.ndarray]


@pytest.fixture(scope="module")
def case(tabletop: Robot) -> Case:
    """Data set 3 as planned, where it is wanted, with its branches."""
    problem = data_set_3(tabletop, method="ssas", include=("path",))
    approaches = solve(problem).approaches
    paths = np.stack([np.asarray(one.path_joints) for one in approaches])
    poses = np.stack(
        [forward_kinematics(tabletop, problem.mounted_tool, path[-1]) for path in paths]
    )
    branches = np.array([one.branch for one in approaches])
    return problem, ClaimedPaths(paths, poses[:, :3, 3], poses[:, :3, :3]), branches


def by_name(residuals: object) -> dict[str, Residuals]:
    return {one.name: one for one in residuals}  # type: ignore[attr-defined]


def test_rows_are_looked_at_one_by_one(case: Case) -> None:
    problem, claimed, _ = case
    robot, tool = problem.robot, problem.mounted_tool
    rng = np.random.default_rng(2)
    paths = claimed.paths + rng.normal(0.0, 1e-4, claimed.paths.shape)
    standby, thinning = (rng.normal(0.0, 1e-4, (5, 6)) + paths[:, row] for row in (0, -1))
    spoilt = replace(claimed, paths=paths)
    found = by_name(path_residuals(problem, spoilt, standby, thinning))
    for k in range(5):
        off = turned = 0.0
        for row, path in enumerate(paths[k]):
            pose = forward_kinematics(robot, tool, path)
            behind = 0.04 * (19 - row) / 19
            wanted = claimed.places[k] - behind * claimed.axes[k, :, 2]
            off = max(off, math.dist(pose[:3, 3], wanted))
            for axis in range(3):
                turned = max(turned, math.dist(pose[:3, axis], claimed.axes[k, :, axis]))
        assert found["path_position_m"].values[k] == pytest.approx(off, rel=1e-9)
        assert found["path_axes_rad"].values[k] == pytest.approx(turned, rel=1e-9)
        for name, ends, row in (("standby", standby, 0), ("thinning", thinning, -1)):
            apart = max(abs(ends[k][i] - paths[k][row][i]) for i in range(6))
            assert found[f"{name}_is_path_end_rad"].values[k] == pytest.approx(apart, rel=1e-12)
    allowed = {name: one.allowed for name, one in found.items()}
    assert allowed == {
        "path_position_m": POSITION_ERROR_M,
        "path_axes_rad": AXIS_ERROR_RAD,
        "standby_is_path_end_rad": SAME_POSTURE_RAD,
        "thinning_is_path_end_rad": SAME_POSTURE_RAD,
        "wrist_jump_rad_m": pytest.approx(JOINT_RATE_RAD_M, rel=1e-5),
    }


def test_rows_are_evenly_behind_the_target(case: Case) -> None:
    options = case[0].options
    assert retreats_of(options, 5) == pytest.approx([0.04, 0.03, 0.02, 0.01, 0.0])
    assert len(retreats_of(options, 20)) == 20


def test_branches_are_those_of_both_ends(case: Case) -> None:
    problem, claimed, branches = case
    names = {"standby_branch_rad", "thinning_branch_rad"}
    found = by_name(branch_residuals(problem, claimed, branches))
    assert set(found) == names
    for one in found.values():
        assert np.abs(one.values).max() < 1e-9
        assert one.allowed == SAME_BRANCH_RAD
    for flipped in (1, 2, 4):
        others = by_name(branch_residuals(problem, claimed, branches ^ flipped))
        assert all(one.values.min() > 0.01 for one in others.values())
    # A whole turn of a joint is no other branch.
    turned = replace(claimed, paths=claimed.paths + 2 * np.pi * np.eye(6)[5])
    for one in branch_residuals(problem, turned, branches):
        assert np.abs(one.values).max() < 1e-9


@pytest.mark.parametrize("norm", ["l1", "l2"])
def test_efforts_are_sums_over_joints(tabletop: Robot, norm: Norm) -> None:
    weights = (1.0, 2.0, 0.5, 0.0, 3.0, 1.5)
    problem = data_set_3(tabletop, norm=norm, joint_weights=weights)
    rng = np.random.default_rng(4)
    thinning, references = rng.uniform(-1.5, 1.5, (2, 20, 6))
    found = efforts_between(problem, thinning, references)
    power = {"l1": 1, "l2": 2}[norm]
    for k in range(20):
        plain = sum(weights[i] * abs(thinning[k, i] - references[k, i]) ** power for i in range(6))
        assert found[k] == pytest.approx(plain, rel=1e-14)
    # Relative where they are above one, else as they are.
    claims = found + 1e-9
    (residual,) = effort_residuals(problem, thinning, references, claims)
    for k in range(20):
        assert residual.values[k] == pytest.approx(1e-9 / max(1.0, found[k]), rel=1e-5)
    assert residual.allowed == EFFORT_ERROR_RELATIVE
    assert found.max() > 2.0


def test_margins_and_limits_are_those_of_all_rows(case: Case) -> None:
    problem, claimed, _ = case
    robot = problem.robot
    paths = claimed.paths.copy()
    paths[1, 7, 3] = robot.upper[3] + 0.25
    paths[2, 4, 2] = robot.lower[2] - 0.125
    margins, claims = np.array([0.1, -0.2, 0.3, 0.004, 0.005]), np.array([0.1, 0.1, 0.1, 0.1, 0.1])
    found = by_name(margin_residuals(problem, replace(claimed, paths=paths), margins, claims))
    assert found["margin_claim_rad"].values == pytest.approx([0.0, 0.3, 0.2, 0.096, 0.095])
    assert found["margin_claim_rad"].allowed == SAME_POSTURE_RAD
    outside = found["path_limit_excess_rad"]
    assert outside.values[[1, 2]] == pytest.approx([0.25, 0.125])
    assert outside.values[[0, 3, 4]].max() < 0.0
    assert outside.allowed == LIMIT_EXCESS_RAD
    excess = found["limit_excess_rad"]
    assert excess.values == pytest.approx([-0.095, 0.205, -0.295, 0.001, 0.0])
    assert excess.allowed == LIMIT_EXCESS_RAD


def test_deviations_and_their_claims(case: Case) -> None:
    problem, *_ = case
    deviations, claims = np.array([1e-5, 3e-5]), np.array([2e-5, 1e-5])
    found = by_name(deviation_residuals(problem, deviations, claims))
    assert found["path_deviation_m"].values == pytest.approx(deviations)
    assert found["path_deviation_m"].allowed == problem.options.straightness_m
    assert found["path_deviation_claim_m"].values == pytest.approx([-1e-5, 2e-5])
    assert found["path_deviation_claim_m"].allowed == POSITION_ERROR_M


def test_displacement_claims_and_needs(case: Case) -> None:
    problem, claimed, branches = case
    claims, needed = np.array([0.0, 1e-4, 0.05, -1e-3, 2e-4]), np.full(5, 3e-4)
    found = by_name(displacement_residuals(problem, claimed, branches, claims, needed))
    beyond = displacement_overshoots(problem, branches, claimed.paths, claims)
    assert found["displacement_margin_claim_m"].values == pytest.approx(beyond)
    assert found["displacement_margin_claim_m"].allowed == DISPLACED_ERROR_M
    assert found["displacement_margin_negative_m"].values == pytest.approx(-claims)
    assert found["displacement_margin_negative_m"].allowed == 0.0
    assert found["uncertainty_excess_m"].values == pytest.approx(needed - claims)
    assert found["uncertainty_excess_m"].allowed == POSITION_ERROR_M


def test_what_is_no_number_is_not_accepted() -> None:
    residuals = Residuals("it", np.array([0.5, 1.0, 1.5, np.nan]), 1.0)
    assert residuals.accepted.tolist() == [True, True, False, False]
    assert residuals.of(2).value == 1.5
    assert (residuals.of(2).name, residuals.of(2).allowed) == ("it", 1.0)
    assert not residuals.of(3).accepted
