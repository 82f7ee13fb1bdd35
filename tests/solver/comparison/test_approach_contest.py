import math
from dataclasses import replace
from typing import Final

import numpy as np
import pytest

from solver import Options, Problem, Robot, solve
from solver.approach.task.candidate import Candidate
from solver.approach.task.task import ApproachTask
from solver.comparison.approach_contest import (
    BETWEEN_ROWS,
    Variant,
    approach_contest,
    chosen,
    comparable,
    method_variants,
)
from solver.comparison.contest import Account, Contest
from solver.exceptions import UnknownEntrant
from solver.methods.registry import METHODS
from solver.methods.semi_analytic import solve_ssas
from solver.problem.solution import REASON_CODES, Reason
from solver.tolerances import AXIS_ERROR_RAD, POSITION_ERROR_M
from tests.solver.problems import data_set_3, random_targets

AS_CHEAP_RELATIVE: Final = 1e-7
"""How much dearer than another method's an effort may be and still count as the same, as a share:
an optimum is found to about 1e-9, and efforts of a few radians are recomputed to 1e-12."""


def contest_of(problem: Problem, *variants: Variant) -> Contest:
    return approach_contest(
        problem, variants or method_variants(problem), scenario="test", title="test", origin="test"
    )


def accounts(contest: Contest) -> dict[tuple[str, str], Account]:
    return {
        (target, entrant.name): contest.account(entrant.name, k, entrant.solve(k))
        for entrant in contest.entrants
        for k, target in enumerate(contest.target_ids)
    }


@pytest.mark.parametrize("options", [Options(), Options(norm="l2"), Options(weights="torque")])
def test_better_methods_are_never_dearer(tabletop: Robot, options: Options) -> None:
    problem = Problem(tabletop, random_targets(41, 40), options=options)
    found = accounts(contest_of(problem))
    solved = 0
    for target in problem.targets:
        ncos, ssas = found[target.id, "ncos"], found[target.id, "ssas"]
        assert ncos.solved == ssas.solved
        if ncos.index is None or ssas.index is None:
            continue
        solved += 1
        assert ncos.index <= ssas.index * (1 + AS_CHEAP_RELATIVE)
        for name in ("fixed_z", "floating_z", "as"):
            other = found[target.id, name].index
            assert other is None or ssas.index <= other * (1 + AS_CHEAP_RELATIVE)
    assert solved >= 10


def test_accounts_are_those_of_the_plan(tabletop: Robot) -> None:
    """Contest and planner: the same verdicts, efforts and margins."""
    problem = comparable(Problem(tabletop, random_targets(42, 12)))
    found = accounts(contest_of(problem))
    codes = set()
    for name in METHODS:
        plan = solve(comparable(problem, method=name))
        for approach in plan.approaches:
            account = found[approach.target_id, name]
            assert account.solved == (approach.status == "planned")
            if approach.reason is not None:
                codes.add(account.status)
                assert (account.status, account.detail) == (
                    approach.reason.code, approach.reason.detail
                )  # fmt: skip
                continue
            assert account.index == pytest.approx(approach.effort, abs=1e-12)
            # The search for one target and that for many end at angles a rounding apart.
            assert account.margin == pytest.approx(approach.margin_rad, abs=1e-7)
    assert len(codes) >= 2
    assert codes <= set(REASON_CODES)


def test_what_a_solved_account_tells(tabletop: Robot) -> None:
    problem = data_set_3(tabletop)
    for (_, name), account in accounts(contest_of(problem)).items():
        if name == "fixed_z":
            assert account.status == "method_not_applicable"
            assert account.index is None
            continue
        assert account.solved, account
        assert account.residuals["path_position_m"] <= POSITION_ERROR_M
        assert account.residuals["path_axes_rad"] <= AXIS_ERROR_RAD
        assert 0 < account.residuals[BETWEEN_ROWS] < 1e-3
        assert account.joints is not None
        assert len(account.joints) == 6


def _half_a_degree_off(task: ApproachTask) -> Candidate | Reason:
    outcome = solve_ssas(task)
    if isinstance(outcome, Reason):
        return outcome
    thinning = np.array(outcome.thinning_joints)
    thinning[4] += math.radians(0.5)
    return replace(outcome, thinning_joints=tuple(thinning))


def _not_a_number(task: ApproachTask) -> Candidate | Reason:
    outcome = solve_ssas(task)
    assert isinstance(outcome, Candidate)
    return replace(outcome, thinning_joints=(math.nan,) * 6)


def _wrong_angle(task: ApproachTask) -> Candidate | Reason:
    outcome = solve_ssas(task)
    assert isinstance(outcome, Candidate)
    return replace(outcome, approach_angle_rad=outcome.approach_angle_rad + 0.01)


def _other_branch(task: ApproachTask) -> Candidate | Reason:
    outcome = solve_ssas(task)
    if isinstance(outcome, Reason) or outcome.branch is None:
        return outcome
    return replace(outcome, branch=outcome.branch ^ 1)


@pytest.mark.parametrize("broken", [_half_a_degree_off, _not_a_number, _wrong_angle, _other_branch])
def test_a_broken_method_shows_up_as_failed(tabletop: Robot, broken: object) -> None:
    problem = data_set_3(tabletop)
    variant = Variant("broken", "test", comparable(problem), broken)  # type: ignore[arg-type]
    found = accounts(contest_of(problem, variant))
    assert len(found) == 5
    for account in found.values():
        assert not account.solved
        assert account.status in REASON_CODES
        assert account.detail
        assert account.index is None


def test_rows_that_were_answered_are_judged(tabletop: Robot) -> None:
    contest = contest_of(data_set_3(tabletop))
    answer = contest.entrants[-1].solve(0)
    assert contest.account("ncos", 0, answer).solved
    bent = np.array(answer.rows)
    bent[7, 1] += 1e-3
    account = contest.account("ncos", 0, replace(answer, rows=bent))
    assert not account.solved
    assert "path_position_m" in account.detail


def test_cold_starts_are_judged_like_warm_ones(tabletop: Robot) -> None:
    """Some starts lead nowhere; none leads below the optimum."""
    problem = Problem(tabletop, random_targets(43, 12))
    contest = contest_of(problem)
    cold = {entrant.name for entrant in contest.entrants if entrant.solve_cold is not None}
    assert cold == {"ncos"}
    (ncos,) = (entrant for entrant in contest.entrants if entrant.name == "ncos")
    assert ncos.solve_cold is not None
    solved = 0
    for k in range(len(problem.targets)):
        warm = contest.account("ncos", k, ncos.solve(k))
        account = contest.account("ncos", k, ncos.solve_cold(k))
        again = contest.account("ncos", k, ncos.solve_cold(k))
        assert account == again
        if account.solved:
            assert warm.index is not None
            assert account.index is not None
            assert account.index >= warm.index * (1 - AS_CHEAP_RELATIVE)
            solved += 1
        else:
            assert account.status == "solver_failed"
            assert "random starts" in account.detail
    assert solved >= 3


def test_chosen_keeps_the_order_and_refuses_unknown_names(tabletop: Robot) -> None:
    variants = method_variants(data_set_3(tabletop))
    assert [one.name for one in chosen(variants, None)] == list(METHODS)
    assert [one.name for one in chosen(variants, ["ncos", "as"])] == ["as", "ncos"]
    with pytest.raises(UnknownEntrant) as caught:
        chosen(variants, ["as", "newton"])
    assert caught.value.name == "newton"
    assert caught.value.known == tuple(METHODS)


def test_on_a_rail_there_is_no_cold_start() -> None:
    from solver import Target, load_robot

    target = Target("1", (0.5, 0.1, 0.4), (0.0, 1.0, 0.0))
    contest = contest_of(Problem(load_robot("puma560_rail"), [target]))
    assert all(entrant.solve_cold is None for entrant in contest.entrants)
    found = accounts(contest)
    assert found["1", "ncos"].solved
