"""How far targets may move, as the verifier finds it: by postures there, without the kernels."""

from dataclasses import replace

import numpy as np
import pytest

from solver import Options, Problem, Robot, load_robot, solve
from solver.approach.cut_in.cut_in import many_retreat_rows
from solver.approach.uncertainty.robustness import displacement_margins
from solver.kinematics.forward import many_poses
from solver.kinematics.spherical_wrist import inverse_kinematics
from solver.problem.retreats import looked_at_retreats
from solver.solving import many_targets
from solver.solving.many_targets import plan_many
from solver.verification.displacement import displacement_overshoots
from solver.verification.tolerances import DISPLACED_ERROR_M
from solver.verification.verify import verify
from tests.solver.kinematics.arms import arms
from tests.solver.problems import in_front_of, random_targets

TRIED_M = 1e-3
"""Claims of less are not looked at here: a tenth of them is too little to be told."""


def planned(robot: Robot, seed: int, count: int, **options: object) -> Problem:
    targets = in_front_of(robot, random_targets(seed, count))
    chosen = Options(method="ssas", order="independent", include=("path",), **options)  # type: ignore[arg-type]
    return Problem(robot, targets, options=chosen)


@pytest.mark.parametrize("robot", [arms()[0], arms()[1], arms()[12]], ids=lambda arm: arm.name)
@pytest.mark.parametrize("rows", [2, 20])
def test_true_claims_are_believed_and_larger_ones_are_not(robot: Robot, rows: int) -> None:
    problem = planned(robot, seed=95, count=60, limit_margin_rad=0.02, path_points=rows)
    done = list(plan_many(problem, problem.targets).values())
    paths = np.stack([np.asarray(one.path_joints) for one in done])
    branches = np.array([one.branch for one in done])
    claims = np.array([one.displacement_margin_m for one in done])
    beyond = displacement_overshoots(problem, branches, paths, claims)
    assert beyond.max() <= DISPLACED_ERROR_M
    tried = claims > TRIED_M
    assert tried.sum() >= 5
    for factor in (1.1, 3.0):
        beyond = displacement_overshoots(problem, branches, paths, factor * claims)
        # Where limits bend around a straight wrist a claim may be too small by as much.
        assert np.mean(beyond[tried] > DISPLACED_ERROR_M) > 0.9
    assert not (displacement_overshoots(problem, branches, paths, claims * np.nan) <= 0).any()


@pytest.mark.parametrize("factor", [1.1, 3.0])
def test_an_answer_that_claims_more_is_refused(tabletop: Robot, factor: float) -> None:
    problem = planned(tabletop, seed=96, count=30)
    refused = 0
    for approach in solve(problem).approaches:
        claim = approach.displacement_margin_m
        if claim is None or claim < TRIED_M:
            continue
        assert verify(problem, approach, problem.start).accepted
        more = replace(approach, displacement_margin_m=factor * claim)
        names = [residual.name for residual in verify(problem, more, problem.start).failures]
        assert names == ["displacement_margin_claim_m"]
        refused += 1
    assert refused >= 5


def test_a_negative_claim_is_refused(tabletop: Robot) -> None:
    problem = planned(tabletop, seed=96, count=10)
    approach = next(one for one in solve(problem).approaches if one.status == "planned")
    less = replace(approach, displacement_margin_m=-1e-9)
    assert not verify(problem, less, problem.start).accepted


def test_a_batch_that_claims_more_is_refused(
    tabletop: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever the function that makes the claims returns: the verifier does not share it."""
    problem = planned(tabletop, seed=97, count=40, position_margin_m=0.0)
    honest, margins = plan_many(problem, problem.targets), displacement_margins
    free = {k for k, one in honest.items() if (one.displacement_margin_m or 0.0) > TRIED_M}
    assert len(free) >= 5
    monkeypatch.setattr(many_targets, "displacement_margins", lambda *given: 3.0 * margins(*given))
    assert plan_many(problem, problem.targets).keys().isdisjoint(free)


def test_an_arm_on_a_rail_is_judged_where_the_rail_stands() -> None:
    robot = load_robot("puma560_rail")
    targets = [replace(one, position_m=(*one.position_m[:2], 0.6)) for one in random_targets(98, 3)]
    options = Options(method="as", order="independent", include=("path",))
    problem = Problem(robot, targets, options=options)
    done = [one for one in solve(problem).approaches if one.status == "planned"]
    assert done
    for approach in done:
        assert approach.displacement_margin_m is not None
        more = replace(approach, displacement_margin_m=3.0 * approach.displacement_margin_m + 0.01)
        assert verify(problem, approach, problem.start).accepted
        assert not verify(problem, more, problem.start).accepted


@pytest.mark.parametrize("lean", [0.03, 0.1, 0.2])
def test_nearly_straight_wrists_bear_as_much_as_straightens_them(
    tabletop: Robot, lean: float
) -> None:
    """Postures with joint 5 almost at zero, in the middle of all other limits."""
    tool = tabletop.tools[0]
    problem = planned(tabletop, 1, 1)
    rng = np.random.default_rng(8)
    drawn = rng.uniform(0.4 * tabletop.lower, 0.4 * tabletop.upper, (200, 6))
    drawn[:, 4] = lean
    found = inverse_kinematics(tabletop, tool, many_poses(tabletop, tool, drawn))
    own, branches = np.nonzero(np.abs(found.joints - drawn[:, None]).max(axis=-1) < 1e-9)
    thinning = drawn[own]
    margins = displacement_margins(tabletop, tool, problem.options, branches, thinning)
    retreats = looked_at_retreats(problem.options)
    paths = many_retreat_rows(tabletop, tool, thinning, branches, retreats)
    problem = replace(problem, options=replace(problem.options, path_points=len(retreats)))
    # What straightens the wrist is nearer than any limit where it hardly leans.
    straightens = (margins > 1e-3) & (margins < 0.3 * abs(lean))
    assert straightens.sum() >= 20
    paths, branches, margins = paths[straightens], branches[straightens], margins[straightens]
    assert displacement_overshoots(problem, branches, paths, margins).max() <= DISPLACED_ERROR_M
    beyond = displacement_overshoots(problem, branches, paths, 1.15 * margins)
    assert np.mean(beyond > DISPLACED_ERROR_M) > 0.95
