"""Each residual of many approaches fails where it should, and no other that is claimed."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from solver import Options, Problem, Robot
from solver.problem.solution import SolverReport
from solver.solving.many_targets import plan_many
from solver.solving.one_target import plan_target
from solver.verification.many import ProposedPaths, judge_many, verify_many
from tests.solver.problems import random_targets
from tests.solver.verification.spoiling import too_fast, untimed
from tests.solver.verification.test_verify_residuals import along_branch

Case = tuple[Problem, ProposedPaths]
MEASURED = {
    "standby_is_path_end_rad",
    "thinning_is_path_end_rad",
    "path_deviation_claim_m",
    "margin_claim_rad",
}
"""Nobody claims these of many: they are what is measured, and are not right where that fails."""


def honest() -> Case:
    """A few approaches, of which every other one is spoilt."""
    answer = untimed()
    one, place = answer.approach, answer.problem.targets_by_id[answer.approach.target_id]
    targets = [replace(place, id=str(k)) for k in range(4)]
    path = np.array(one.path_joints)
    proposed = ProposedPaths(
        target_ids=[target.id for target in targets],
        positions=np.array([target.position_m for target in targets], dtype=float),
        directions=np.array([target.branch_direction for target in targets], dtype=float),
        angles_rad=np.full(4, one.approach_angle_rad),
        tool_sides=np.ones(4, dtype=np.int64),
        branches=np.full(4, one.branch),
        paths=np.stack([path] * 4),
        references=np.stack([np.asarray(answer.reference)] * 4),
        displacement_margins_m=np.full(4, one.displacement_margin_m),
    )
    return replace(answer.problem, targets=tuple(targets)), proposed


def odd(values: Any, change: Callable[[Any], Any]) -> Any:
    """With those at odd places changed."""
    found = np.array(values)
    found[1::2] = change(found[1::2])
    return found


def spoilt(field: str, change: Callable[[Any], Any]) -> Callable[[Case], Case]:
    return lambda case: (
        case[0],
        replace(case[1], **{field: odd(getattr(case[1], field), change)}),
    )


def elsewhere(case: Case) -> Case:
    place = along_branch(case[0].targets[1]).position_m
    return spoilt("positions", lambda _: np.asarray(place))(case)


def nudged(row: int, joint: int, amount: float) -> Callable[[Case], Case]:
    def change(paths: Any) -> Any:
        paths[:, row, joint] += amount
        return paths

    return spoilt("paths", change)


def uncertain(case: Case) -> Case:
    problem, proposed = case
    targets = [
        replace(target, position_std_m=0.02) if k % 2 else target
        for k, target in enumerate(problem.targets)
    ]
    return replace(problem, targets=tuple(targets)), proposed


def fast(_: Case) -> Case:
    answer = too_fast()
    one, target = answer.approach, answer.problem.targets_by_id[answer.approach.target_id]
    case = answer.problem, honest()[1]
    for field, value in {
        "positions": target.position_m,
        "directions": target.branch_direction,
        "angles_rad": one.approach_angle_rad,
        "branches": one.branch,
        "paths": one.path_joints,
        "displacement_margins_m": 0.0,
    }.items():
        case = spoilt(field, lambda _, value=value: np.asarray(value))(case)  # type: ignore[misc]
    return replace(answer.problem, targets=honest()[0].targets), case[1]


def limited(case: Case, beyond_rad: float) -> Case:
    """Those of an arm whose second joint ends so far before where they have it at the furthest."""
    upper = float(case[1].paths[..., 1].max()) - beyond_rad
    joints = list(case[0].robot.joints)
    joints[1] = replace(joints[1], upper=upper)
    margins = np.zeros(4)
    robot, start = replace(case[0].robot, joints=tuple(joints)), case[1].paths[0, -1] - 0.01
    problem = replace(case[0], robot=robot, start_joints=start)
    return problem, replace(case[1], displacement_margins_m=margins)


ROWS: dict[str, tuple[Callable[[Case], Case], set[str]]] = {
    "tool_side": (spoilt("tool_sides", lambda side: -side), {"path_axes_rad"}),
    "path_position_m": (elsewhere, set()),
    "path_axes_rad": (spoilt("angles_rad", lambda angle: angle + 3e-6), set()),
    "wrist_jump_rad_m": (fast, set()),
    "standby_branch_rad": (
        spoilt("branches", lambda branch: branch ^ 1),
        {"thinning_branch_rad", "displacement_margin_claim_m"},
    ),
    "displacement_margin_claim_m": (
        spoilt("displacement_margins_m", lambda margin: 1.1 * margin),
        set(),
    ),
    "displacement_margin_negative_m": (
        spoilt("displacement_margins_m", lambda margin: 0 * margin - 1e-7),
        set(),
    ),
    "uncertainty_excess_m": (uncertain, set()),
}


# Limits are those of all; no target may move where a joint has no room.
NO_ROOM = {"limit_excess_rad", "displacement_margin_claim_m"}
LIMITS = {0.0: NO_ROOM, 1e-6: {"path_limit_excess_rad", *NO_ROOM}}
# Rows are refined until motion is straight, see test_verify_residuals.
STRAIGHT = "path_deviation_m"


def failing(case: Case) -> list[set[str]]:
    """What fails of each approach."""
    found = verify_many(*case).residuals
    return [
        {residual.name for residual in found if not residual.accepted[k]}
        for k in range(len(case[1].target_ids))
    ]


@pytest.mark.parametrize("name", ROWS)
def test_what_is_spoilt_is_what_fails_and_of_no_other(name: str) -> None:
    assert failing(honest()) == [set()] * 4
    spoil, too = ROWS[name]
    case = spoil(honest())
    assert failing(case) == [set(), {name, *too}] * 2
    reports = [SolverReport("ssas", 0.0, 0, "")] * 4
    assert list(judge_many(*case, reports)) == ["0", "2"]


@pytest.mark.parametrize("beyond_rad", LIMITS)
def test_limits_count_less_the_margin_asked_for(beyond_rad: float) -> None:
    assert failing(limited(honest(), beyond_rad)) == [LIMITS[beyond_rad]] * 4


@pytest.mark.parametrize("field", ["positions", "angles_rad", "paths", "displacement_margins_m"])
def test_what_is_not_a_number_is_not_planned(field: str) -> None:
    assert all(failing(spoilt(field, lambda value: value + np.nan)(honest()))[1::2])


def test_the_rows_are_the_residuals() -> None:
    found = {residual.name for residual in verify_many(*honest()).residuals}
    broken = set(ROWS).union(*(too for _, too in ROWS.values()), *LIMITS.values())
    assert found == broken | MEASURED | {STRAIGHT}


@pytest.mark.parametrize("wished_m", [0.001, 0.05])
def test_what_is_told_of_many_is_what_is_told_of_one(tabletop: Robot, wished_m: float) -> None:
    options = Options(
        method="ssas", order="independent", include=("path",), position_margin_m=wished_m
    )
    problem = Problem(tabletop, random_targets(93, 40), options)
    many = plan_many(problem, problem.targets)
    assert len(many) >= 8
    short = 0
    for target_id, approach in many.items():
        alone = plan_target(problem, problem.targets_by_id[target_id], problem.start)
        for field in ("position_margin_m", "margin_short", "branch", "tool_side"):
            assert getattr(approach, field) == getattr(alone, field), field
        for field in ("effort", "margin_rad", "displacement_margin_m", "approach_angle_rad"):
            assert getattr(approach, field) == pytest.approx(getattr(alone, field), abs=1e-6)
        assert approach.path_deviation_m == pytest.approx(alone.path_deviation_m, abs=1e-9)
        short += approach.margin_short is True
    assert (short > 0) == (wished_m > 0.01)
